#include "idl/etcd/etcd_watch.hpp"

#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "idl/base64.hpp"
#include "idl/etcd/etcd_json.hpp"
#include "idl/etcd/etcd_members.hpp"

namespace collided::etcd {
namespace {

/// The first key behind all those that begin so; a byte 0 is the end of all keys.
std::string end_of_prefix(std::string prefix) {
  while (!prefix.empty() && prefix.back() == '\xff') prefix.pop_back();
  if (prefix.empty()) return std::string(1, '\0');
  ++prefix.back();
  return prefix;
}

StoreChange change_in(const json& event) {
  const json& pair = object_in(event, "kv");
  StoreChange change{.key = bytes_in(pair, "key"), .value = {}, .revision = number_in(pair, "mod_revision")};
  if (event.value("type", json("PUT")) != json("DELETE")) change.value = bytes_in(pair, "value");
  return change;
}

/// Reads streams, one after the other, and remembers how far.
class WatchReader {
 public:
  explicit WatchReader(StoreWatch asked) : asked_(std::move(asked)), next_(asked_.from) {}

  json question() const {
    json create{{"key", encode_base64(asked_.key)}, {"start_revision", std::to_string(next_)}, {"fragment", true}};
    if (asked_.is_prefix) create["range_end"] = encode_base64(end_of_prefix(asked_.key));
    return {{"create_request", create}};
  }

  /// The next stream repeats a revision that was cut off.
  void begin() { held_.clear(); }

  void take(const json& line) {
    const json& result = object_in(line, "result");
    note_problem({});
    is_compacted_ = number_in(result, "compact_revision") > 0;
    if (is_compacted_) return;
    if (result.contains("cancel_reason")) throw NoAnswer(text_in(result, "cancel_reason"));
    if (is_set_in(result, "canceled")) throw NoAnswer("its stream was cancelled");
    if (!result.contains("events")) return;
    // A long answer comes in fragments, which may part a revision.
    for (const json& event : array_in(result, "events")) {
      StoreChange change = change_in(event);
      if (!held_.empty() && change.revision > held_.back().revision) tell();
      held_.push_back(std::move(change));
    }
    if (!is_set_in(result, "fragment")) tell();
  }

  void note_problem(const std::string& problem) {
    if (problem == problem_) return;
    problem_ = problem;
    if (asked_.problem) asked_.problem(problem);
  }

  bool is_over() const { return is_compacted_ || asked_.is_over(); }
  bool is_compacted() const { return is_compacted_; }

 private:
  void tell() {
    for (const StoreChange& change : std::exchange(held_, {})) {
      if (change.revision < next_) continue;
      asked_.changed(change);
      last_ = change.revision;
    }
    next_ = std::max(next_, last_ + 1);
  }

  const StoreWatch asked_;
  std::int64_t next_;
  std::int64_t last_ = 0;
  bool is_compacted_ = false;
  std::vector<StoreChange> held_;
  std::string problem_;
};

}  // namespace

WatchEnd watch(const EtcdAddress& address, std::int64_t patience_ns, StoreWatch asked) {
  constexpr std::chrono::milliseconds kTryAgain{100};
  EtcdMembers members(address, patience_ns);
  WatchReader reader(std::move(asked));
  const auto is_over = [&] { return reader.is_over(); };
  while (!is_over()) {
    reader.begin();
    try {
      members.read("/v3/watch", reader.question(),
                   {.take = [&](const json& line) { reader.take(line); }, .is_over = is_over, .life_ns = kWatchLifeNs});
    } catch (const StoreError& failed) {
      if (is_over()) break;
      reader.note_problem(failed.what());
      std::this_thread::sleep_for(kTryAgain);
    }
  }
  return reader.is_compacted() ? WatchEnd::read_again : WatchEnd::over;
}

}  // namespace collided::etcd
