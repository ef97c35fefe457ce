#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "client/library/connection/errors.hpp"
#include "client/fleet/shards/every_shard.hpp"
#include "client/fleet/shards/shard_pairs.hpp"

namespace collided::client {
namespace {

using shards::ShardMap;
using SaidOfGroups = ShardSaid<ClearanceAnswer>;

int urgency_of(UndecidedReason reason) {
  switch (reason) {
    case UndecidedReason::deadline: return 0;
    case UndecidedReason::not_covered: return 1;
    case UndecidedReason::stale_object: return 2;
    default: return 3;
  }
}

/// One answer of those of several shards.
class ClearanceMerge {
 public:
  ClearanceMerge(const ShardMap& map, const ClearanceOptions& options) : map_(map), options_(options) {}

  void take(const SaidOfGroups& one) {
    if (!one.said) return doubt(UndecidedReason::not_covered);
    const ClearanceAnswer& said = *one.said;
    merged_.cut = merged_.cut || said.cut;
    merged_.late = merged_.late || said.late;
    merged_.stale = merged_.stale || said.stale;
    merged_.filtered += said.filtered;
    merged_.tested += said.tested;
    if (said.verdict == Verdict::undecided) doubt(said.reason);
    for (const ClearancePair& pair : said.pairs) take_pair(pair, one.place);
  }

  ShardedClearanceAnswer answer() {
    for (auto& [names, told] : pairs_) merged_.pairs.push_back(std::move(told.pair));
    std::ranges::sort(merged_.pairs, [](const ClearancePair& x, const ClearancePair& y) {
      return std::tie(x.clearance_m, x.a, x.b) < std::tie(y.clearance_m, y.a, y.b);
    });
    const bool are_more = merged_.pairs.size() > options_.most;
    merged_.cut = merged_.cut || are_more;
    // Beyond the margin a pair that no shard holds may be nearer than one that a shard tells.
    if (merged_.pairs.size() < options_.most && options_.nearer_m > map_.margin_m()) {
      merged_.complete_to_m = map_.margin_m();
      doubt(UndecidedReason::not_covered);
    }
    if (are_more) merged_.pairs.resize(options_.most);
    const bool is_hit =
        std::ranges::any_of(merged_.pairs, [](const ClearancePair& pair) { return pair.verdict == Verdict::hit; });
    merged_.verdict = is_hit ? Verdict::hit : is_undecided_ ? Verdict::undecided : Verdict::miss;
    if (merged_.verdict != Verdict::undecided) merged_.reason = UndecidedReason::none;
    return std::move(merged_);
  }

 private:
  struct ToldPair {
    ClearancePair pair;
    bool is_own = false;  // told by the shard to whom its point belongs
  };

  void take_pair(const ClearancePair& pair, std::size_t place) {
    // Which of two objects that are in both groups comes first, each shard says by its own numbers.
    const auto names = std::minmax(pair.a, pair.b);
    const bool is_own = map_.owner_of({pair.on_a.x(), pair.on_a.y(), pair.on_a.z()}) == place;
    const auto [there, is_new] =
        pairs_.try_emplace({names.first, names.second}, ToldPair{.pair = pair, .is_own = is_own});
    if (!is_new && is_own && !there->second.is_own) there->second = {.pair = pair, .is_own = true};
    there->second.pair.a_id = there->second.pair.b_id = 0;
  }

  void doubt(UndecidedReason reason) {
    if (!is_undecided_ || urgency_of(reason) < urgency_of(merged_.reason)) merged_.reason = reason;
    is_undecided_ = true;
  }

  const ShardMap& map_;
  const ClearanceOptions& options_;
  std::map<std::pair<std::string, std::string>, ToldPair> pairs_;
  ShardedClearanceAnswer merged_;
  bool is_undecided_ = false;
};

/// Whether a shard may have objects of both groups; nothing: it does not say.
std::optional<bool> has_pairs_of(Client& shard, const std::string& from, const std::string& to) {
  const std::optional<std::uint64_t> of_from = count_of_group(shard, from);
  const std::optional<std::uint64_t> of_to = count_of_group(shard, to);
  if (!of_from || !of_to) return std::nullopt;
  return *of_from > 0 && *of_to > 0 && (from != to || *of_from > 1);
}

Error in_shard(const ShardMap& map, const SaidOfGroups& one) {
  Error error = one.said.error();
  error.message = "shard '" + map.at(one.place).name + "': " + error.message;
  return error;
}

}  // namespace

Result<ShardedClearanceAnswer> clearance_of_shards(ShardLinks& links, const std::string& from,
                                                   const ClearanceOptions& options) {
  if (options.to.empty())
    return bad_input(
        "clearance: of a world on several shards the other group must be named: what is beside a group, no "
        "shard knows alone");
  const std::shared_ptr<const ShardView> view = links.view();
  const ShardMap& map = view->asked;
  ClearanceOptions asked = options;
  asked.progress = nullptr;
  asked.nearer_m = std::min(options.nearer_m, map.margin_m());
  Result<std::vector<SaidOfGroups>> all = ask_every_shard<ClearanceAnswer>(
      links, map, {.timeout = options.timeout, .as_of = options.as_of}, [&](Client& client, const Instant& instant) {
        ClearanceOptions of_shard = asked;
        of_shard.as_of = instant;
        return client.clearance(from, of_shard);
      });
  if (!all) return all.error();
  ClearanceMerge merge(map, options);
  bool is_any_said = false;
  for (const SaidOfGroups& one : *all) {
    if (!one.said && !is_silence(one.said.error())) {
      if (one.said.error().code == ErrorCode::bad_input) return one.said.error();
      const std::shared_ptr<Client> shard = links.shard(one.place);
      const std::optional<bool> has_pairs = shard ? has_pairs_of(*shard, from, options.to) : std::nullopt;
      if (has_pairs && *has_pairs) return in_shard(map, one);
      if (has_pairs) continue;
    }
    is_any_said = true;
    merge.take(one);
  }
  if (is_any_said) return merge.answer();
  Error error = in_shard(map, all->front());
  error.message = "no shard has objects of both groups; " + error.message;
  error.hint = "groups that no shard has together are farther apart than the margin of the map";
  return error;
}

}  // namespace collided::client
