#include "idl/etcd/etcd_client.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "idl/base64.hpp"
#include "idl/http/http_post.hpp"

namespace collided::etcd {
namespace {

using nlohmann::json;

/// Why a request came to nothing, in a few words.
struct NoAnswer : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The part of an answer under this name; throws where there is none of that kind.
const json& part(const json& answer, const char* name, json::value_t kind) {
  const auto found = answer.is_object() ? answer.find(name) : answer.end();
  if (!answer.is_object() || found == answer.end() || found->type() != kind)
    throw NoAnswer(std::string("an answer without '") + name + '\'');
  return *found;
}

/// Numbers of 64 bits are texts in the gateway's JSON; what is 0 is left out.
std::int64_t number_in(const json& answer, const char* name) {
  if (!answer.is_object() || !answer.contains(name)) return 0;
  const std::string& text = part(answer, name, json::value_t::string).get_ref<const std::string&>();
  std::int64_t number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc() || end != text.data() + text.size())
    throw NoAnswer('\'' + std::string(name) + "' that is not a number");
  return number;
}

/// As much of a foreign text as a log line bears.
std::string shortened(const std::string& text) {
  constexpr std::size_t kMost = 120;
  std::string line = text.substr(0, kMost);
  std::ranges::replace_if(
      line, [](unsigned char c) { return c < ' ' || c > '~'; }, '.');
  return line;
}

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
  const json& range = part(response, "response_range", json::value_t::object);
  if (!range.contains("kvs")) return;
  const json& found = part(range, "kvs", json::value_t::array);
  if (found.size() != 1) throw NoAnswer("other keys than were asked for");
  result.revisions.back() = number_in(found[0], "mod_revision");
  // An empty value is left out.
  const bool is_empty = found[0].is_object() && !found[0].contains("value");
  result.values.back() =
      is_empty ? std::string()
               : decode_base64(part(found[0], "value", json::value_t::string).get_ref<const std::string&>());
  if (!result.values.back()) throw NoAnswer("a value that is not base64");
}

StoreResult result_in(const json& answer, const StoreTransaction& transaction) {
  StoreResult result;
  result.is_done = answer.value("succeeded", json(false)) == json(true);
  if (!transaction.reads.empty() || result.is_done) {
    const json& responses = part(answer, "responses", json::value_t::array);
    const std::size_t first = result.is_done ? transaction.writes.size() : 0;
    if (responses.size() != first + transaction.reads.size())
      throw NoAnswer("an answer with other parts than asked for");
    for (std::size_t i = first; i < responses.size(); ++i) take_value(responses[i], result);
  }
  return result;
}

std::string url_of(const EtcdEndpoint& to, const char* target) {
  const bool is_address_6 = to.host.find(':') != std::string::npos;
  return "http://" + (is_address_6 ? "[" + to.host + "]" : to.host) + ":" + to.port + target;
}

}  // namespace

EtcdClient::EtcdClient(EtcdAddress address, std::int64_t patience_ns)
    : address_(std::move(address)), patience_ns_(patience_ns), http_(http::http_module("etcd")) {}

json EtcdClient::ask(const EtcdEndpoint& endpoint, const char* target, const std::string& question) {
  http::HttpAnswer answer;
  http_.post({.url = url_of(endpoint, target), .body = question, .patience_ns = patience_ns_}, answer);
  if (!answer.problem.empty()) throw NoAnswer(answer.problem);
  json read = json::parse(answer.body, nullptr, false);
  constexpr long kOk = 200;
  if (answer.status != kOk) throw NoAnswer("status " + std::to_string(answer.status) + ": " + shortened(answer.body));
  if (!read.is_object()) throw NoAnswer("an answer that is not of etcd: " + shortened(answer.body));
  return read;
}

template <class Read>
auto EtcdClient::call(const char* target, const json& question, Read&& read) {
  const std::string text = question.dump();
  std::string problems;
  for (std::size_t i = 0; i < address_.endpoints.size(); ++i) {
    const std::size_t at = (newest_ + i) % address_.endpoints.size();
    const EtcdEndpoint& endpoint = address_.endpoints[at];
    try {
      auto result = read(ask(endpoint, target, text));
      newest_ = at;
      return result;
    } catch (const NoAnswer& failed) {
      if (!problems.empty()) problems += "; ";
      problems += endpoint.host + ':' + endpoint.port + ": " + failed.what();
    }
  }
  throw StoreError(problems);
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
    const json& result = part(answer, "result", json::value_t::object);
    if (number_in(result, "ID") != lease) throw NoAnswer("an answer about another lease");
    return number_in(result, "TTL") > 0;
  });
}

void EtcdClient::revoke(std::int64_t lease) {
  call("/v3/lease/revoke", {{"ID", std::to_string(lease)}},
       [](const json& answer) { return part(answer, "header", json::value_t::object).size(); });
}

StoreResult EtcdClient::transact(const StoreTransaction& transaction) {
  return call("/v3/kv/txn", transaction_in(transaction),
              [&](const json& answer) { return result_in(answer, transaction); });
}

}  // namespace collided::etcd
