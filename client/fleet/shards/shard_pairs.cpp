#include "client/fleet/shards/shard_pairs.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "client/fleet/shards/every_shard.hpp"

namespace collided::client {
namespace {

using shards::ShardMap;
using SaidOfPair = ShardSaid<PairAnswer>;

const Vec3& point_of(const PairAnswer& pair) { return pair.verdict == Verdict::hit ? pair.point : pair.on_a; }

bool is_own(const ShardMap& map, const SaidOfPair& said) {
  const Vec3& at = point_of(*said.said);
  return said.said->verdict != Verdict::undecided && map.owner_of({at.x(), at.y(), at.z()}) == said.place;
}

/// Of two objects that no shard answers for.
class ApartOrUnknown {
 public:
  ApartOrUnknown(ShardLinks& links, const ShardMap& map, const std::string& a, const std::string& b)
      : links_(links), map_(map), a_(a), b_(b) {}

  Result<ShardedPairAnswer> answer(const std::vector<SaidOfPair>& all) {
    ShardedPairAnswer undecided;
    undecided.verdict = Verdict::undecided;
    undecided.reason = UndecidedReason::not_covered;
    for (const SaidOfPair& one : all) {
      const std::shared_ptr<Client> shard = links_.shard(one.place);
      if (!shard || is_silence(one.said.error())) return undecided;
      const std::optional<bool> has_a = has_object(*shard, a_);
      const std::optional<bool> has_b = has_object(*shard, b_);
      if (!has_a || !has_b) return undecided;
      if (*has_a && *has_b) return refusal(one);
      is_a_known_ = is_a_known_ || *has_a;
      is_b_known_ = is_b_known_ || *has_b;
    }
    if (!is_a_known_ || !is_b_known_)
      return Error{ErrorCode::refused, "no shard has an object '" + (is_a_known_ ? b_ : a_) + "'", ""};
    undecided.farther_than_m = map_.margin_m();
    return undecided;
  }

 private:
  /// It holds both, and has something else against the question.
  Error refusal(const SaidOfPair& one) const {
    Error error = one.said.error();
    error.message = "shard '" + map_.at(one.place).name + "': " + error.message;
    return error;
  }

  ShardLinks& links_;
  const ShardMap& map_;
  const std::string& a_;
  const std::string& b_;
  bool is_a_known_ = false;
  bool is_b_known_ = false;
};

}  // namespace

Result<ShardedPairAnswer> pair_of_shards(ShardLinks& links, const std::string& a, const std::string& b,
                                         const PairOptions& options) {
  const std::shared_ptr<const ShardView> view = links.view();
  const ShardMap& map = view->asked;
  Result<std::vector<SaidOfPair>> all = ask_every_shard<PairAnswer>(
      links, map, {.timeout = options.timeout, .as_of = options.as_of}, [&](Client& client, const Instant& instant) {
        PairOptions asked = options;
        asked.as_of = instant;
        return client.pair(a, b, asked);
      });
  if (!all) return all.error();
  const SaidOfPair* chosen = nullptr;
  for (const SaidOfPair& one : *all) {
    if (!one.said) {
      if (one.said.error().code == ErrorCode::bad_input) return one.said.error();
      continue;
    }
    // Where both have heard of the same poses, they say the same.
    if (chosen == nullptr || (!is_own(map, *chosen) && is_own(map, one))) chosen = &one;
  }
  if (chosen == nullptr) return ApartOrUnknown(links, map, a, b).answer(*all);
  ShardedPairAnswer answer{*chosen->said};
  answer.version = 0;
  return answer;
}

std::optional<bool> has_object(Client& shard, const std::string& name) {
  constexpr std::uint64_t kMostAlike = 100'000;
  // Letters with a meaning in a glob are replaced by one that matches any letter; then the names are compared.
  std::string glob = name;
  std::ranges::replace_if(
      glob, [](char letter) { return letter == '*' || letter == '['; }, '?');
  const Result<ObjectList> list = shard.list({.name = glob, .limit = kMostAlike});
  if (!list) return std::nullopt;
  return std::ranges::any_of(list->objects, [&](const ListedObject& object) { return object.name == name; });
}

std::optional<std::uint64_t> count_of_group(Client& shard, const std::string& group) {
  const Result<ObjectList> named = shard.list({.name = group, .limit = 0});
  const Result<ObjectList> of_scene = shard.list({.name = group + "/*", .limit = 0});
  if (!named || !of_scene) return std::nullopt;
  return named->count + of_scene->count;
}

}  // namespace collided::client
