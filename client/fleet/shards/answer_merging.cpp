#include "client/fleet/shards/answer_merging.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "client/fleet/shards/question_reach.hpp"

namespace collided::client {
namespace {

using shards::ShardBox;
using shards::ShardMap;

/// A hit and the shard that tells it.
struct TaggedHit {
  const Hit* hit;
  std::size_t place;

  double low() const { return hit->distance_m - hit->error_m; }
  double high() const { return hit->distance_m + hit->error_m; }
};

/// What one or several shards tell of one object.
struct ToldHits {
  std::vector<TaggedHit> hits;
  shards::ShardSet shards = 0;
  double limit_m = std::numeric_limits<double>::infinity();  // more hits than were told may lie from here on
};

bool precedes_on_object(const TaggedHit& a, const TaggedHit& b) {
  return std::tie(a.hit->distance_m, a.hit->triangle) < std::tie(b.hit->distance_m, b.hit->triangle);
}

bool precedes(const Hit& a, const Hit& b) { return std::tie(a.object, a.triangle) < std::tie(b.object, b.triangle); }

bool contains(const ShardBox& box, const Vec3& point, double slack_m) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = point[static_cast<Eigen::Index>(axis)];
    if (x + slack_m < box.low[axis] || x - slack_m > box.high[axis]) return false;
  }
  return true;
}

/// In what order the server says why an answer is undecided: the first of several counts.
int rank(UndecidedReason reason) {
  switch (reason) {
    case UndecidedReason::deadline: return 0;
    case UndecidedReason::numeric: return 1;
    case UndecidedReason::truncated: return 2;
    case UndecidedReason::not_covered: return 3;
    case UndecidedReason::stale_object: return 4;
    default: return 5;
  }
}

/// Where one answers for another: what a kind of question claims, and from where on.
template <class Q>
constexpr bool kIsRay = std::is_same_v<Q, RayQuestion>;
template <class Q>
constexpr bool kIsNear = std::is_same_v<Q, NearQuestion>;
/// All that it touches is told, deepest first.
template <class Q>
constexpr bool kIsRegion = !kIsRay<Q> && !kIsNear<Q>;

const Vec3& beginning_of(const RayQuestion& ray) { return ray.origin; }
const Vec3& beginning_of(const SphereQuestion& sphere) { return sphere.center; }
const Vec3& beginning_of(const BoxQuestion& box) { return box.center; }
const Vec3& beginning_of(const NearQuestion& near) { return near.point; }
const Vec3& beginning_of(const InsideQuestion& inside) { return inside.point; }

template <class Q>
class Merging {
 public:
  Merging(const Q& question, const ShardMap& map, const AskOptions& options, std::span<const ShardAnswer> given)
      : question_(question),
        map_(map),
        options_(options),
        given_(given),
        is_first_wanted_(kIsRay<Q> && options.mode == HitMode::closest),
        is_one_enough_(!kIsNear<Q> && (options.mode == HitMode::any || options.mode == HitMode::verdict)),
        most_hits_(options.max_hits.value_or(kIsNear<Q> ? 1 : 1'000)) {}

  Answer run() {
    for (const ShardAnswer& one : given_) {
      if (one.answer == nullptr) continue;
      if (one.answer->verdict == Verdict::invalid) return *one.answer;
      merged_.cost.nodes += one.answer->cost.nodes;
      merged_.cost.exact_tests += one.answer->cost.exact_tests;
      merged_.cost.level = std::max(merged_.cost.level, one.answer->cost.level);
    }
    gather();
    if (is_one_enough_ && settle_by_one()) return std::move(merged_);
    keep_wanted();
    for (const ShardAnswer& one : given_) take_doubt(one);
    merged_.verdict = is_undecided_ ? Verdict::undecided : merged_.hits.empty() ? Verdict::miss : Verdict::hit;
    if (merged_.reason != UndecidedReason::not_covered) merged_.uncovered.reset();
    return std::move(merged_);
  }

 private:
  /// What the shards tell of each object.
  void gather() {
    std::map<std::string_view, ToldHits> of_object;
    for (const ShardAnswer& one : given_) {
      if (one.answer == nullptr) continue;
      std::map<std::string_view, ToldHits> told;
      for (const Hit& hit : one.answer->hits) told[hit.object].hits.push_back({&hit, one.place});
      const bool is_cut = one.answer->hits.size() >= most_hits_;
      for (auto& [object, own] : told) {
        own.shards = shards::set_of(one.place);
        if (is_cut) own.limit_m = one.answer->hits.back().distance_m;
        ToldHits& known = of_object[object];
        known = known.hits.empty() ? std::move(own) : joined(std::move(known), std::move(own));
      }
    }
    for (auto& [object, told] : of_object) hits_.insert(hits_.end(), told.hits.begin(), told.hits.end());
    std::ranges::sort(hits_, [](const TaggedHit& a, const TaggedHit& b) {
      const double nearer =
          kIsRegion<Q> ? b.hit->distance_m - a.hit->distance_m : a.hit->distance_m - b.hit->distance_m;
      return nearer != 0 ? nearer < 0 : precedes(*a.hit, *b.hit);
    });
  }

  bool is_own(const TaggedHit& hit) const {
    return contains(map_.at(hit.place).box, hit.hit->point, std::min(hit.hit->point_error_m, map_.margin_m()));
  }

  /// What two tell of one object. Of a part that is larger than a shard each may hold other triangles: then what they tell
  /// together counts. Where they contradict each other, they have heard of the object at different instants, and that counts
  /// which tells most.
  ToldHits joined(ToldHits a, ToldHits b) const {
    if (!kIsRay<Q> || is_first_wanted_) return comes_first(b.hits[0], a.hits[0]) ? b : a;
    if (!agree(a, b) || !agree(b, a)) return a.hits.size() < b.hits.size() ? b : a;
    ToldHits all{.hits = {}, .shards = a.shards | b.shards, .limit_m = std::min(a.limit_m, b.limit_m)};
    std::ranges::sort(a.hits, precedes_on_object);
    std::ranges::sort(b.hits, precedes_on_object);
    std::ranges::set_union(a.hits, b.hits, std::back_inserter(all.hits), precedes_on_object);
    return all;
  }

  /// Of the one hit that each of two shards tells of an object. The shard in whose box the point lies holds all that is
  /// there, so it tells the very triangle that one server would. Of a region it is a point within what both have in common,
  /// from which the triangle may be far: of triangles that are as deep one server tells the first.
  bool comes_first(const TaggedHit& a, const TaggedHit& b) const {
    if (kIsRegion<Q>)
      return std::tuple(-a.hit->distance_m, a.hit->triangle) < std::tuple(-b.hit->distance_m, b.hit->triangle);
    if (is_own(a) != is_own(b)) return is_own(a);
    return precedes_on_object(a, b);
  }

  /// Whether `other` has each of these hits that it must have: those at points where one of its shards holds everything.
  bool agree(const ToldHits& told, const ToldHits& other) const {
    return std::ranges::all_of(told.hits, [&](const TaggedHit& hit) {
      if (hit.high() >= other.limit_m || !is_held_by(other.shards, *hit.hit)) return true;
      return std::ranges::any_of(other.hits, [&](const TaggedHit& same) {
        return same.hit->triangle == hit.hit->triangle && same.hit->distance_m == hit.hit->distance_m;
      });
    });
  }

  bool is_held_by(shards::ShardSet shards, const Hit& hit) const {
    for (; shards != 0; shards &= shards - 1) {
      const auto place = static_cast<std::size_t>(std::countr_zero(shards));
      if (contains(map_.held_by(place), hit.point, -hit.point_error_m)) return true;
    }
    return false;
  }

  bool settle_by_one() {
    const bool is_hit = std::ranges::any_of(
        given_, [](const ShardAnswer& one) { return one.answer != nullptr && one.answer->verdict == Verdict::hit; });
    if (!is_hit) return false;
    merged_.verdict = Verdict::hit;
    if (options_.mode == HitMode::any && !hits_.empty()) add(hits_.front());
    return true;
  }

  void add(const TaggedHit& hit) {
    merged_.hits.push_back(*hit.hit);
    merged_.hits.back().object_id = 0;
  }

  void keep_wanted() {
    if (is_first_wanted_) {
      if (!hits_.empty()) keep_first();
      return;
    }
    for (const TaggedHit& hit : hits_) {
      if (merged_.hits.size() < most_hits_) add(hit);
      else if (!kIsNear<Q>) doubt(UndecidedReason::truncated);
    }
    if (kIsNear<Q> && hits_.size() >= most_hits_ && !merged_.hits.empty())
      limit_m_ = merged_.hits.back().distance_m + merged_.hits.back().error_m;
    if (kIsNear<Q>) admit_nearer_ones();
  }

  /// The first hit of the ray.
  void keep_first() {
    TaggedHit first = hits_.front();
    if (options_.error_m == 0 && !is_own(first)) {
      const auto is_rival = [&](const TaggedHit& other) { return other.low() <= first.high() && is_own(other); };
      if (const auto rival = std::ranges::find_if(hits_, is_rival); rival != hits_.end()) first = *rival;
    }
    const bool is_open = std::ranges::any_of(hits_, [&](const TaggedHit& other) {
      const bool is_other = other.hit->object != first.hit->object && other.place != first.place;
      return is_other && other.low() <= first.high() && first.low() <= other.high() && is_own(first) && is_own(other);
    });
    add(first);
    if (options_.error_m > 0) admit_nearer_ones();
    else if (is_open) doubt(UndecidedReason::numeric);
    limit_m_ = merged_.hits.front().distance_m + merged_.hits.front().error_m;
  }

  /// With an error that was asked for, what another shard tells with a wider bound may be nearer: the bounds admit it.
  void admit_nearer_ones() {
    if (options_.error_m == 0) return;
    for (Hit& kept : merged_.hits) {
      for (const TaggedHit& other : hits_) {
        if (other.hit->distance_m >= kept.distance_m)
          kept.error_m = std::max(kept.error_m, kept.distance_m - other.low());
      }
    }
  }

  /// How far from its beginning the question enters the shard's box; 0 where that says nothing.
  double entry_of(std::size_t place) const {
    if constexpr (kIsRay<Q>) return entry_m(map_.at(place).box, question_).value_or(0);
    else if constexpr (kIsNear<Q>) return entry_m(map_.at(place).box, question_);
    else return 0;
  }

  void take_doubt(const ShardAnswer& one) {
    const double entry = entry_of(one.place);
    if (one.answer == nullptr) {
      if (entry <= limit_m_) doubt_uncovered({.point = point_of_entry(one.place), .covered_m = kIsRay<Q> ? entry : 0});
      return;
    }
    const Answer& answer = *one.answer;
    if (answer.verdict != Verdict::undecided) return;
    // What an index of all shards would still find is told of a list, whatever else is in it.
    const bool is_listing = !is_first_wanted_ && !kIsNear<Q>;
    switch (answer.reason) {
      case UndecidedReason::not_covered: return take_uncovered(one);
      case UndecidedReason::stale_object:
        if (!is_listing || merged_.hits.empty()) doubt(answer.reason);
        return;
      default:
        if (entry <= limit_m_) doubt(answer.reason);
    }
  }

  /// The point where a question leaves what a shard holds is outside of the shard's box by the margin. Nearer than that, or
  /// without a point, the shard knows of unknown space.
  void take_uncovered(const ShardAnswer& one) {
    const std::optional<Uncovered>& where = one.answer->uncovered;
    if (where && !contains(map_.at(one.place).box, where->point, map_.margin_m() / 2)) return;
    if (kIsRegion<Q> && !merged_.hits.empty()) return;
    if (!where) return doubt(UndecidedReason::not_covered);
    const double at_m = kIsRay<Q> ? where->covered_m : (where->point - beginning_of(question_)).norm();
    if (at_m <= limit_m_) doubt_uncovered(*where);
  }

  Vec3 point_of_entry(std::size_t place) const {
    if constexpr (kIsRay<Q>) return entry_point(map_.at(place).box, question_);
    else return entry_point(map_.at(place).box, beginning_of(question_));
  }

  void doubt(UndecidedReason reason) {
    if (!is_undecided_ || rank(reason) < rank(merged_.reason)) merged_.reason = reason;
    is_undecided_ = true;
  }

  void doubt_uncovered(const Uncovered& where) {
    doubt(UndecidedReason::not_covered);
    if (!merged_.uncovered || where.covered_m < merged_.uncovered->covered_m) merged_.uncovered = where;
  }

  const Q& question_;
  const ShardMap& map_;
  const AskOptions& options_;
  const std::span<const ShardAnswer> given_;
  const bool is_first_wanted_;
  const bool is_one_enough_;
  const std::size_t most_hits_;
  std::vector<TaggedHit> hits_;  // each once, in the order of an answer
  Answer merged_;
  bool is_undecided_ = false;
  double limit_m_ = std::numeric_limits<double>::infinity();  // beyond it nothing changes the answer
};

}  // namespace

#define COLLIDED_MERGED(Q)                                                         \
  Answer merged(const Q& question, const ShardMap& map, const AskOptions& options, \
                std::span<const ShardAnswer> given) {                              \
    return Merging<Q>(question, map, options, given).run();                        \
  }
COLLIDED_MERGED(RayQuestion)
COLLIDED_MERGED(SphereQuestion)
COLLIDED_MERGED(BoxQuestion)
COLLIDED_MERGED(NearQuestion)
COLLIDED_MERGED(InsideQuestion)
#undef COLLIDED_MERGED

shards::ShardSet shards_left(const NearQuestion& near, const ShardMap& map, const AskOptions& options,
                             const Answer& found) {
  NearQuestion left = near;
  if (!found.hits.empty() && found.hits.size() >= options.max_hits.value_or(1)) {
    const Hit& last = found.hits.back();
    left.within_m = std::min(left.within_m, std::max(0.0, last.distance_m + last.error_m));
  }
  return touched_shards(map, left);
}

}  // namespace collided::client
