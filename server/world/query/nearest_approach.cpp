#include "server/world/query/nearest_approach.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "server/geometry/float_environment.hpp"
#include "server/world/objects/object_placing.hpp"
#include "server/world/objects/sweep.hpp"
#include "server/world/query/pair_object.hpp"
#include "server/world/query/pair_report.hpp"

namespace collided::engine {
namespace {

using PathPiece = PoseMemory::RememberedPath::PathPiece;

constexpr std::uint32_t kMostLooks = 20'000;
constexpr double kGoodEnough = 1e-3;  // relative to the distance
constexpr double kFineEnough_m = 1e-6;
constexpr double kRounding = 1e-12;  // relative; lengths and times here lose far less in a few operations

/// One of the two objects, on its path through an interval in which no motion begins or ends.
class PathWalker {
 public:
  PathWalker(const Snapshot& snapshot, ObjectId id, const PoseMemory::RememberedPath& path, Deadline& deadline)
      : object_(snapshot, id, deadline),
        path_(path),
        can_move_(snapshot.objects[slot_of(id)]->scene_part == kNoScenePart),
        reach_m_(can_move_ ? reach_of(*object_.placed.info) : 0) {}

  double reach_m() const { return reach_m_; }
  bool can_move() const { return can_move_; }
  PairObject& object() { return object_; }

  /// The piece that covers the interval; null if it rests.
  const PathPiece* piece(std::int64_t from_ns, std::int64_t to_ns) const {
    const auto next =
        std::upper_bound(path_.pieces.begin(), path_.pieces.end(), from_ns,
                         [](std::int64_t time_ns, const PathPiece& piece) { return time_ns < piece.to_ns; });
    return next != path_.pieces.end() && next->from_ns <= from_ns && next->to_ns >= to_ns ? &*next : nullptr;
  }
  /// Its frame at a time of an interval that begins at from_ns.
  Frame frame(std::int64_t from_ns, std::int64_t to_ns, double time_ns) const {
    if (const PathPiece* const moving = piece(from_ns, to_ns))
      return moving->motion.at((time_ns - static_cast<double>(moving->from_ns)) / duration_ns(*moving));
    const auto next = std::upper_bound(path_.pieces.begin(), path_.pieces.end(), from_ns,
                                       [](std::int64_t time, const PathPiece& piece) { return time < piece.to_ns; });
    return next == path_.pieces.begin() ? path_.first : std::prev(next)->motion.to;
  }
  static double duration_ns(const PathPiece& piece) { return static_cast<double>(piece.to_ns - piece.from_ns); }

 private:
  PairObject object_;
  const PoseMemory::RememberedPath& path_;
  bool can_move_;
  double reach_m_;
};

/// An interval of time in which no motion of either begins or ends.
struct ApproachInterval {
  std::int64_t from_ns = 0;  // of the whole interval between two begins or ends
  std::int64_t to_ns = 0;
  double part_from_ns = 0;  // of this part of it
  double part_to_ns = 0;
  double at_least_m = 0;  // lower bound on the distance throughout
  bool is_looked_at = false;

  double middle_ns() const { return 0.5 * (part_from_ns + part_to_ns); }
  /// The middle as an instant; in a double, present-day nanoseconds are off by up to 128.
  std::int64_t instant_ns() const { return std::clamp<std::int64_t>(std::llround(middle_ns()), from_ns, to_ns); }
  bool operator<(const ApproachInterval& other) const { return at_least_m > other.at_least_m; }  // least bound first
};

class ApproachSearch {
 public:
  ApproachSearch(const Snapshot& snapshot, ObjectId a, const PoseMemory::RememberedPath& path_of_a, ObjectId b,
                 const PoseMemory::RememberedPath& path_of_b, Deadline& deadline)
      : a_(snapshot, a, path_of_a, deadline), b_(snapshot, b, path_of_b, deadline), deadline_(deadline) {}

  NearestApproach between(std::vector<std::int64_t> times) {
    best_ = {.from_ns = times.front(), .to_ns = times.back(), .time_ns = times.front()};
    best_.distance_m = std::numeric_limits<double>::infinity();
    if (times.size() == 1) times.push_back(times.front());
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
      push({.from_ns = times[i],
            .to_ns = times[i + 1],
            .part_from_ns = static_cast<double>(times[i]),
            .part_to_ns = static_cast<double>(times[i + 1])});
    }
    while (step()) {}
    return best_;
  }

 private:
  /// The most that the distance may change from the middle to an end.
  double change_m(const ApproachInterval& part) const {
    Vec3 travel = Vec3::Zero();
    double length_m = 0;
    for (const auto& [walker, sign] : {std::pair(&a_, 1.0), std::pair(&b_, -1.0)}) {
      const PathPiece* const piece = walker->piece(part.from_ns, part.to_ns);
      if (piece == nullptr) continue;
      const double share = (part.part_to_ns - part.part_from_ns) / PathWalker::duration_ns(*piece);
      travel += sign * share * piece->motion.travel;
      // The reach of a half-space is infinite.
      if (piece->motion.turn_rad > 0)
        length_m += share * piece->motion.turn_rad * piece->motion.lever_m(walker->reach_m());
    }
    length_m += 2 * motion_error_m(part);
    return 0.5 * (travel.norm() + length_m) * (1 + kRounding);
  }
  /// How far the two together may be from their motions at a time within a piece.
  double motion_error_m(const ApproachInterval& part) const {
    double error_m = 0;
    for (const PathWalker* walker : {&a_, &b_}) {
      const PathPiece* const piece = walker->piece(part.from_ns, part.to_ns);
      if (piece != nullptr && std::isfinite(walker->reach_m())) error_m += piece->motion.error_m(walker->reach_m());
    }
    return error_m;
  }
  void place(const ApproachInterval& part) {
    for (PathWalker* walker : {&a_, &b_}) {
      if (walker->can_move()) walker->object().place_at(walker->frame(part.from_ns, part.to_ns, part.middle_ns()));
    }
  }
  void push(ApproachInterval part) {
    if (!part.is_looked_at) part.at_least_m = std::max(part.at_least_m, by_bounds(part));
    waiting_.push(part);
  }
  /// A cheap lower bound, from the bounds of the two in the middle.
  double by_bounds(const ApproachInterval& part) {
    if (deadline_.is_over()) return 0;
    place(part);
    const Aabb& a = a_.object().placed.bounds;
    const Aabb& b = b_.object().placed.bounds;
    const Vec3 gap = (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0);
    return std::max(0.0, gap.norm() * (1 - kRounding) - change_m(part));
  }
  /// Evaluates or halves the waiting interval with the least bound. False: done.
  bool step() {
    const ApproachInterval part = waiting_.top();
    const double enough_m = std::max(kGoodEnough * best_.distance_m, kFineEnough_m);
    best_.at_least_m = std::max(0.0, std::min(part.at_least_m, best_.distance_m - best_.error_m));
    if (part.at_least_m >= best_.distance_m - best_.error_m - enough_m) return false;
    if (deadline_.is_over() || best_.looks >= kMostLooks) {
      best_.end = ApproachEnd::cut_short;
      return false;
    }
    waiting_.pop();
    if (!part.is_looked_at) return look(part);
    for (const auto& [from_ns, to_ns] :
         {std::pair(part.part_from_ns, part.middle_ns()), std::pair(part.middle_ns(), part.part_to_ns)}) {
      ApproachInterval half = part;
      half.part_from_ns = from_ns;
      half.part_to_ns = to_ns;
      half.is_looked_at = false;
      push(half);
    }
    return true;
  }
  /// Measures in the middle; false if that ends the search.
  bool look(ApproachInterval part) {
    ++best_.looks;
    place(part);
    const Placed& a = a_.object().placed;
    const Placed& b = b_.object().placed;
    WalkCost cost;
    ContactSearch touch;
    touch.wanted = false;
    touch.deadline = &deadline_;
    search_objects(a, b, touch, cost);
    const auto ends = [&](ApproachEnd how) {
      best_.end = how;
      best_.time_ns = part.instant_ns();
      best_.distance_m = best_.error_m = best_.at_least_m = 0;
      return false;
    };
    if (touch.yes) return ends(ApproachEnd::touched);
    if (touch.undecided && !deadline_.was_over()) return ends(ApproachEnd::undecided);
    Separation apart;
    if (!deadline_.was_over()) apart = distance_between(a, b, cost, deadline_);
    if (deadline_.was_over()) {
      waiting_.push(part);
      return true;
    }
    const double error_m = apart.error_m + placing_error_m(a, kNoTriangle, b, kNoTriangle) + motion_error_m(part);
    part.at_least_m = std::max(part.at_least_m, apart.distance_m - error_m - change_m(part));
    part.is_looked_at = true;
    if (apart.distance_m < best_.distance_m) {
      best_.distance_m = apart.distance_m;
      best_.error_m = error_m;
      best_.time_ns = part.instant_ns();
    }
    waiting_.push(part);
    return true;
  }

  PathWalker a_;
  PathWalker b_;
  Deadline& deadline_;
  NearestApproach best_;
  std::priority_queue<ApproachInterval> waiting_;
};

}  // namespace

NearestApproach nearest_approach(const Snapshot& snapshot, ObjectId a, const PoseMemory::RememberedPath& path_of_a,
                                 ObjectId b, const PoseMemory::RememberedPath& path_of_b, std::int64_t since_ns,
                                 Deadline& deadline) {
  const OwnFloatEnvironment own_floats;
  const std::int64_t to_ns = std::min(path_of_a.to_ns, path_of_b.to_ns);
  const std::int64_t from_ns = std::min(to_ns, std::max({path_of_a.from_ns, path_of_b.from_ns, since_ns}));
  std::vector<std::int64_t> times{from_ns, to_ns};
  for (const PoseMemory::RememberedPath* path : {&path_of_a, &path_of_b}) {
    for (const PathPiece& piece : path->pieces) {
      for (const std::int64_t time_ns : {piece.from_ns, piece.to_ns}) {
        if (time_ns > from_ns && time_ns < to_ns) times.push_back(time_ns);
      }
    }
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return ApproachSearch(snapshot, a, path_of_a, b, path_of_b, deadline).between(std::move(times));
}

}  // namespace collided::engine
