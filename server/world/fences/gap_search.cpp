#include "server/world/fences/gap_search.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/query/part_pairs.hpp"

namespace collided::engine {
namespace {

/// True for a single convex body: a plane between two of these bounds their distance throughout a translation.
bool is_one_convex(const ObjectInfo& info) { return info.primitives.size() == 1 && !info.mesh; }

/// A search along the two motions, from evaluation to evaluation.
class GapWalk {
 public:
  GapWalk(const GapBody& a, const GapBody& b, const GapLimit& limit, const GapOptions& options, WalkCost& cost,
          bool seeks_beyond)
      : a_(a),
        b_(b),
        limit_(limit),
        options_(options),
        cost_(cost),
        seeks_beyond_(seeks_beyond),
        relative_(b.motion.travel - a.motion.travel),
        time_(options.from),
        sure_until_(options.from) {
    const double turned_m = a.motion.turn_rad * a.reach_m + b.motion.turn_rad * b.reach_m;
    is_planar_ = turned_m == 0 && is_one_convex(*a.info) && is_one_convex(*b.info);
    fastest_m_ = (relative_.norm() + turned_m) * (1 + kBoundSlack);
    off_m_ = a.motion.error_m(a.reach_m) + b.motion.error_m(b.reach_m);
  }

  GapTime run() {
    double step = options_.width;
    for (std::uint32_t looks = 0; looks < options_.most_looks; ++looks) {
      if (options_.looks != nullptr) ++*options_.looks;
      const bool is_sure = seeks_beyond_ ? look_beyond() : look();
      if (found_.yes) return found_;
      if (time_ >= 1 || sure_until_ >= 1) return finish();
      if (is_sure && sure_until_ - time_ >= options_.width) {
        step = options_.width;
        time_ = sure_until_;
      } else {
        time_ = std::min(1.0, time_ + step);
        step *= 2;
      }
    }
    found_.is_cut_short = true;
    note_unclear();
    return finish();
  }

 private:
  /// The distance of the two at time_; nothing if more than left_m beyond the limit.
  std::optional<ObjectClearance> clearance_now(double left_m) {
    const Frame frame_a = a_.motion.at(time_);
    const Frame frame_b = b_.motion.at(time_);
    const Placed a{.info = a_.info, .frame = frame_a, .bounds = bounds_of(*a_.info, frame_a)};
    const Placed b{.info = b_.info, .frame = frame_b, .bounds = bounds_of(*b_.info, frame_b)};
    Deadline never;
    return clearance_between(a, b, {.limit_m = limit_.high_m() + left_m, .depth = false}, cost_, never);
  }

  /// Evaluates the two at time_ for the first time beyond the limit. True: they are certainly within it.
  bool look_beyond() {
    const std::optional<ObjectClearance> clearance = clearance_now(off_m_ + kBoundSlack * limit_.high_m());
    const bool is_apart = !clearance || clearance->touches == Decision::no;
    if (!clearance || (is_apart && clearance->low_m() - off_m_ > limit_.high_m())) {
      found_.yes = true;
      if (clearance) found_.at = *clearance;
      found_.bracket = {std::min(unclear_ >= 0 ? unclear_ : sure_until_, time_), time_};
      return false;
    }
    const double far_m = clearance->touches == Decision::yes ? 0 : is_apart ? clearance->high_m() : limit_.high_m();
    const double spare_m = limit_.low_m() - off_m_ - far_m;
    if (!(spare_m > 0)) {
      note_unclear();
      return false;
    }
    if (is_apart) found_.at = *clearance;
    return surely_so(fastest_m_ > 0 ? std::min(1.0, time_ + spare_m * (1 - kBoundSlack) / fastest_m_) : 1, spare_m);
  }

  /// Evaluates the two at time_. True: they are certainly farther apart than the limit.
  bool look() {
    const double left_m = fastest_m_ * (1 - time_) * (1 + kBoundSlack) + off_m_;
    const std::optional<ObjectClearance> clearance = clearance_now(left_m);
    if (!clearance) return surely_so(1, left_m);
    if (clearance->touches == Decision::no) found_.at = *clearance;
    if (clearance->touches == Decision::yes ||
        (clearance->touches == Decision::no && clearance->high_m() <= limit_.low_m())) {
      found_.yes = true;
      if (clearance->touches == Decision::yes) found_.at.clearance_m = found_.at.error_m = 0;
      found_.bracket = {std::min(unclear_ >= 0 ? unclear_ : sure_until_, time_), time_};
      return false;
    }
    const double excess_m = clearance->touches == Decision::no ? clearance->low_m() - off_m_ - limit_.high_m() : -1;
    if (!(excess_m > 0)) {
      note_unclear();
      return false;
    }
    double fastest_m = fastest_m_;
    if (is_planar_) fastest_m = std::max(0.0, -clearance->normal.dot(relative_)) + kBoundSlack * fastest_m_;
    const double safe = fastest_m > 0 ? excess_m * (1 - kBoundSlack) / fastest_m : 1;
    return surely_so(std::min(1.0, time_ + safe), excess_m);
  }

  /// The two are excess_m away from the limit, on the side where they began, and stay on that side until `until`.
  bool surely_so(double until, double excess_m) {
    // The time between the last sure time and this one is sure as well, unless they can have been near in between.
    const double back = fastest_m_ > 0 ? excess_m * (1 - kBoundSlack) / fastest_m_ : 1;
    if (time_ - back > sure_until_) note_unclear();
    sure_until_ = std::max(sure_until_, until);
    return true;
  }

  void note_unclear() {
    if (unclear_ < 0) unclear_ = sure_until_;
  }

  GapTime finish() {
    found_.undecided = unclear_ >= 0;
    found_.bracket = {found_.undecided ? unclear_ : std::min(sure_until_, 1.0), 1};
    return found_;
  }

  const GapBody& a_;
  const GapBody& b_;
  const GapLimit& limit_;
  const GapOptions& options_;
  WalkCost& cost_;
  bool seeks_beyond_;
  Vec3 relative_;
  bool is_planar_ = false;
  double fastest_m_ = 0;  // an upper bound on the change of the distance over the whole motion
  double off_m_ = 0;      // how far the two together may be from their motions
  double time_;
  double sure_until_;
  double unclear_ = -1;  // start of the time that is not sure; negative: all is sure
  GapTime found_;
};

/// Finds the part as given: the only primitive, or a triangle. False: it is unknown which of several primitives.
bool find_given(const Placed& object, std::uint32_t triangle, GivenPart& given) {
  if (object.pose == nullptr) return true;
  if (triangle == kNoTriangle && object.info->primitives.size() != 1) return false;
  given = triangle == kNoTriangle ? object.given(object.info->primitives.front()) : object.given(triangle);
  return true;
}

/// Decides over all pairs of parts that may be within the limit, in exact arithmetic.
Decision exactly_within(const Placed& a, const Placed& b, const GapLimit& limit, WalkCost& cost) {
  kernel::AnyOf any;
  const auto visit = [&](const PlacedPart& of_a, const PlacedPart& of_b) {
    GivenPart given_a;
    GivenPart given_b;
    if (!find_given(a, of_a.triangle, given_a) || !find_given(b, of_b.triangle, given_b)) {
      return !any.add(Decision::undecided);
    }
    return !any.add(within_as_given(of_a.part, of_b.part, {given_a, given_b}, limit));
  };
  visit_part_pairs(a, b, limit.high_m(), visit, cost);
  return any.result();
}

}  // namespace

GapTime first_within(const GapBody& a, const GapBody& b, const GapLimit& limit, const GapOptions& options,
                     WalkCost& cost) {
  return GapWalk(a, b, limit, options, cost, false).run();
}

GapTime first_beyond(const GapBody& a, const GapBody& b, const GapLimit& limit, const GapOptions& options,
                     WalkCost& cost) {
  return GapWalk(a, b, limit, options, cost, true).run();
}

Decision within(const Placed& a, const Placed& b, const GapLimit& limit, WalkCost& cost) {
  if (!overlaps(grown(a.bounds, limit.high_m()), b.bounds)) return Decision::no;
  Deadline never;
  const std::optional<ObjectClearance> clearance =
      clearance_between(a, b, {.limit_m = limit.high_m(), .depth = false}, cost, never);
  if (!clearance) return Decision::no;
  if (clearance->touches == Decision::yes) return Decision::yes;
  if (clearance->touches == Decision::no && clearance->high_m() <= limit.low_m()) return Decision::yes;
  if (clearance->low_m() > limit.high_m()) return Decision::no;
  if (limit.high_m() == 0) return clearance->touches;
  return exactly_within(a, b, limit, cost);
}

}  // namespace collided::engine
