#include "server/world/groups/clearance.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "idl/clocks.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/groups/bounds_tree.hpp"
#include "server/world/groups/uncovered.hpp"
#include "server/world/query/unknown_space.hpp"

namespace collided::engine {
namespace {

ObjectClearance turned_round(ObjectClearance found) {
  std::swap(found.on_a, found.on_b);
  std::swap(found.a_triangle, found.b_triangle);
  found.normal = -found.normal;
  if (found.contained != Contained::none)
    found.contained = found.contained == Contained::a_in_b ? Contained::b_in_a : Contained::a_in_b;
  return found;
}

/// A group: numbers of members, and their possible bounds.
struct MemberGroup {
  std::vector<std::uint32_t> members;
  std::vector<Aabb> reaches;

  BoundsTree tree() const { return BoundsTree(reaches); }
};

/// The nearest pairs so far, and the distance below which another pair joins them.
class NearestPairs {
 public:
  NearestPairs(double within_m, std::size_t most) : within_m_(within_m), most_(most) {}

  double limit_m() const {
    return pairs_.size() < most_ ? within_m_ : std::min(within_m_, pairs_.back().clearance.high_m());
  }
  void keep(const MemberPair& pair) {
    const auto place = std::upper_bound(pairs_.begin(), pairs_.end(), pair, &NearestPairs::nearer);
    if (pairs_.size() == most_) {
      if (place == pairs_.end()) return;
    }
    pairs_.insert(place, pair);
    if (pairs_.size() > most_) pairs_.pop_back();
  }
  void take_into(GroupClearance& found) { found.pairs = std::move(pairs_); }

 private:
  static bool nearer(const MemberPair& x, const MemberPair& y) {
    return std::tie(x.clearance.clearance_m, x.a, x.b) < std::tie(y.clearance.clearance_m, y.a, y.b);
  }

  double within_m_;
  std::size_t most_;
  std::vector<MemberPair> pairs_;  // nearest first
};

/// One question's search over the pairs of its groups.
class GroupSearch {
 public:
  GroupSearch(const Snapshot& snapshot, const ClearanceAsk& ask, PartMeshes& part_meshes)
      : ask_(ask),
        snapshot_(snapshot),
        members_(snapshot, part_meshes),
        deadline_(ask.deadline_ns, ask.called_off),
        nearest_(ask.within_m, ask.most + 1) {  // one more shows whether further pairs exist
    collect(ask.from, from_, is_from_);
    collect(ask.to, to_, is_to_);
  }

  GroupClearance run() {
    const BoundsTree from = from_.tree();
    const BoundsTree to = to_.tree();
    if (ask_.progress) pair_count_ = count_of_pairs(from, to);
    const auto visit = [&](std::uint32_t i, std::uint32_t k, double) {
      say_progress();
      return look_at(from_.members[i], to_.members[k]);
    };
    walk_nearest_pairs(
        from, to, [&] { return nearest_.limit_m(); }, visit);
    nearest_.take_into(found_);
    found_.is_cut = found_.pairs.size() > ask_.most;
    if (found_.is_cut) found_.pairs.pop_back();
    if (ask_.is_all_else) look_at_covers();
    if (ask_.certificates) prove_all();
    found_.is_late = deadline_.was_over();
    if (found_.is_late && found_.touches == Decision::no) found_.touches = Decision::undecided;
    return std::move(found_);
  }

 private:
  void collect(const std::vector<ObjectId>& ids, MemberGroup& group, std::vector<bool>& is_in) {
    for (const ObjectId id : ids) {
      const auto [known, is_new] = number_of_.try_emplace(id, 0);
      if (is_new) known->second = members_.add(id);
      const std::uint32_t number = known->second;
      is_in.resize(std::max<std::size_t>(is_in.size(), number + 1), false);
      if (is_in[number]) continue;
      is_in[number] = true;
      group.members.push_back(number);
      group.reaches.push_back(members_.reach(number));
    }
  }
  static bool holds(const std::vector<bool>& is_in, std::uint32_t number) {
    return number < is_in.size() && is_in[number];
  }
  /// True for the second order of two objects that are in both groups.
  bool comes_again(std::uint32_t a, std::uint32_t b) const {
    return a == b || (a > b && holds(is_to_, a) && holds(is_from_, b));
  }

  bool look_at(std::uint32_t a, std::uint32_t b) {
    if (deadline_.is_over()) return false;
    if (comes_again(a, b)) return true;
    if (!ask_.with_filtered && !members_.may_meet(a, b)) {
      ++found_.filtered;
      return true;
    }
    ++found_.tested;
    auto clearance = clearance_in_order(members_, a, b, {.limit_m = nearest_.limit_m()}, deadline_);
    if (deadline_.was_over()) return false;
    const bool is_stale = members_.is_stale(a) || members_.is_stale(b);
    found_.is_stale = found_.is_stale || is_stale;
    const bool may_have_met = is_stale && overlaps(members_.reach(a), members_.reach(b));
    if (clearance && may_have_met && clearance->touches == Decision::no) clearance->touches = Decision::undecided;
    count(clearance ? clearance->touches : may_have_met ? Decision::undecided : Decision::no);
    if (clearance)
      nearest_.keep(
          {.a = members_.info(a).id, .b = members_.info(b).id, .is_stale = is_stale, .clearance = *clearance});
    return true;
  }

  /// Upper bound on the pairs to examine: those whose boxes are within the requested distance.
  double count_of_pairs(const BoundsTree& from, const BoundsTree& to) {
    if (!std::isfinite(ask_.within_m))
      return static_cast<double>(from_.members.size()) * static_cast<double>(to_.members.size());
    double count = 0;
    walk_nearest_pairs(
        from, to, [&] { return ask_.within_m; },
        [&](std::uint32_t, std::uint32_t, double) {
          ++count;
          return !deadline_.is_over();
        });
    return count;
  }
  void say_progress() {
    constexpr std::int64_t kPeriodNs = 100'000'000;
    if (!ask_.progress) return;
    ++seen_count_;
    const std::int64_t now_ns = wire_contract::steady_ns();
    if (now_ns - said_ns_ < kPeriodNs) return;
    said_ns_ = now_ns;
    ask_.progress(std::min(1.0, seen_count_ / std::max(1.0, pair_count_)));
  }

  /// That nothing else is nearer is certain only if the loaded geometry is complete and no space is unknown.
  void look_at_covers() {
    const double claimed_m = found_.is_cut ? std::max(0.0, found_.pairs.back().clearance.high_m()) : ask_.within_m;
    if (snapshot_.covers) found_.uncovered = uncovered_near(from_.reaches, claimed_m, *snapshot_.covers);
    if (!found_.uncovered) found_.uncovered = unknown_near(snapshot_, from_.reaches, claimed_m);
    if (found_.uncovered && found_.touches == Decision::no) found_.touches = Decision::undecided;
  }

  void prove_all() {
    for (MemberPair& pair : found_.pairs) {
      if (deadline_.is_over()) pair.no_proof = "the deadline was over";
      else if (pair.clearance.touches == Decision::undecided) pair.no_proof = "the answer is undecided";
      else if (pair.clearance.contained != Contained::none)
        pair.no_proof = "one lies within the other, a solid: the surfaces do not touch";
      else prove(pair);
    }
  }
  void prove(MemberPair& pair) {
    WalkCost cost;
    const Placed& a = members_.placed(number_of_.at(pair.a), deadline_);
    const Placed& b = members_.placed(number_of_.at(pair.b), deadline_);
    pair.proof = proof_of(a, b, pair.clearance.touches == Decision::yes, pair.no_proof, cost);
  }

  void count(Decision touches) {
    if (touches == Decision::yes) found_.touches = Decision::yes;
    if (touches == Decision::undecided && found_.touches == Decision::no) found_.touches = Decision::undecided;
  }

  const ClearanceAsk& ask_;
  const Snapshot& snapshot_;
  Members members_;
  Deadline deadline_;
  NearestPairs nearest_;
  GroupClearance found_;
  std::unordered_map<ObjectId, std::uint32_t> number_of_;
  MemberGroup from_;
  MemberGroup to_;
  double pair_count_ = 0;
  double seen_count_ = 0;
  std::int64_t said_ns_ = wire_contract::steady_ns();
  std::vector<bool> is_from_;
  std::vector<bool> is_to_;
};

}  // namespace

std::optional<ObjectClearance> clearance_in_order(Members& members, std::uint32_t a, std::uint32_t b,
                                                  const ClearanceWanted& wanted, Deadline& deadline) {
  const ObjectInfo& info_a = members.info(a);
  const ObjectInfo& info_b = members.info(b);
  const bool turned = std::tie(info_b.name, info_b.id) < std::tie(info_a.name, info_a.id);
  WalkCost cost;
  auto found = clearance_between(members.placed(turned ? b : a, deadline), members.placed(turned ? a : b, deadline),
                                 wanted, cost, deadline);
  if (found && turned) return turned_round(*found);
  return found;
}

GroupClearance clearance_of(const Snapshot& snapshot, const ClearanceAsk& ask, PartMeshes& part_meshes) {
  const OwnFloatEnvironment own_floats;
  return GroupSearch(snapshot, ask, part_meshes).run();
}

}  // namespace collided::engine
