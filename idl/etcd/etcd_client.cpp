#include "idl/etcd/etcd_client.hpp"

#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "idl/base64.hpp"
#include "idl/etcd/etcd_json.hpp"

namespace collided::etcd {
namespace {

json condition_in(const StoreCondition& condition) {
  json compare{{"key", encode_base64(condition.key)}, {"result", "EQUAL"}};
  if (condition.is == StoreCondition::Is::absent) {
    compare.update({{"target", "CREATE"}, {"create_revision", "0"}});
    return compare;
  }
  if (condition.is == StoreCondition::Is::revision) {
    compare.update({{"target", "MOD"}, {"mod_revision", std::to_string(condition.revision)}});
    return compare;
  }
  compare.update({{"target", "VALUE"}, {"value", encode_base64(condition.value)}});
  if (condition.is == StoreCondition::Is::less) compare["result"] = "LESS";
  return compare;
}

json transaction_in(const StoreTransaction& transaction) {
  json conditions = json::array(), reads = json::array(), success = json::array();
  for (const StoreCondition& condition : transaction.conditions) conditions.push_back(condition_in(condition));
  for (const std::string& key : transaction.reads) reads.push_back({{"request_range", {{"key", encode_base64(key)}}}});
  for (const StoreWrite& write : transaction.writes) {
    success.push_back({{"request_put",
                        {{"key", encode_base64(write.key)},
                         {"value", encode_base64(write.value)},
                         {"lease", std::to_string(write.lease)}}}});
  }
  success.insert(success.end(), reads.begin(), reads.end());
  return {{"compare", conditions}, {"success", success}, {"failure", reads}};
}

/// Takes the value and the revision of the one key that was asked for.
void take_value(const json& response, StoreResult& result) {
  result.values.emplace_back();
  result.revisions.push_back(0);
  const json& range = object_in(response, "response_range");
  if (!range.contains("kvs")) return;
  const json& found = array_in(range, "kvs");
  if (found.size() != 1) throw NoAnswer("other keys than were asked for");
  result.revisions.back() = number_in(found[0], "mod_revision");
  result.values.back() = bytes_in(found[0], "value");
}

StoreResult result_in(const json& answer, const StoreTransaction& transaction) {
  StoreResult result;
  result.is_done = is_set_in(answer, "succeeded");
  if (!transaction.reads.empty() || result.is_done) {
    const json& responses = array_in(answer, "responses");
    const std::size_t first = result.is_done ? transaction.writes.size() : 0;
    if (responses.size() != first + transaction.reads.size())
      throw NoAnswer("an answer with other parts than asked for");
    for (std::size_t i = first; i < responses.size(); ++i) take_value(responses[i], result);
  }
  return result;
}

}  // namespace

EtcdClient::EtcdClient(EtcdAddress address, std::int64_t patience_ns) : members_(std::move(address), patience_ns) {}

template <class Read>
auto EtcdClient::call(const char* target, const json& question, Read&& read) {
  std::optional<decltype(read(question))> result;
  members_.ask(target, question, [&](const json& answer) { result = read(answer); });
  return std::move(*result);
}

std::int64_t EtcdClient::grant(int life_s) {
  return call("/v3/lease/grant", {{"TTL", std::to_string(life_s)}}, [life_s](const json& answer) {
    const std::int64_t lease = number_in(answer, "ID");
    if (lease <= 0) throw NoAnswer("an answer without a lease");
    // etcd gives no shorter one than its members need to elect a leader; a longer one is only given up later.
    if (number_in(answer, "TTL") < life_s) throw NoAnswer("a lease that is shorter than asked for");
    return lease;
  });
}

bool EtcdClient::renew(std::int64_t lease) {
  return call("/v3/lease/keepalive", {{"ID", std::to_string(lease)}}, [lease](const json& answer) {
    const json& result = object_in(answer, "result");
    if (number_in(result, "ID") != lease) throw NoAnswer("an answer about another lease");
    return number_in(result, "TTL") > 0;
  });
}

void EtcdClient::revoke(std::int64_t lease) {
  call("/v3/lease/revoke", {{"ID", std::to_string(lease)}},
       [](const json& answer) { return object_in(answer, "header").size(); });
}

StoreResult EtcdClient::transact(const StoreTransaction& transaction) {
  return call("/v3/kv/txn", transaction_in(transaction),
              [&](const json& answer) { return result_in(answer, transaction); });
}

}  // namespace collided::etcd
