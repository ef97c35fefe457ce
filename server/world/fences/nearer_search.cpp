#include "server/world/fences/nearer_search.hpp"

#include <algorithm>
#include <limits>

#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

Placed placed_at(const GapBody& body, const Frame& frame) {
  return {.info = body.info, .frame = &frame, .bounds = bounds_of(*body.info, frame), .pose = nullptr};
}

/// A search along the motions, from look to look.
class NearerWalk {
 public:
  NearerWalk(const GapBody& from, const GapSide& nearer, const GapSide& bar, const GapOptions& options, WalkCost& cost)
      : from_(from),
        nearer_(nearer),
        bar_(bar),
        options_(options),
        cost_(cost),
        change_m_((speed_of(nearer) + speed_of(bar)) * (1 + kBoundSlack)) {}

  NearerTime run(double until) {
    double step = options_.width;
    for (std::uint32_t looks = 0; looks < options_.most_looks; ++looks) {
      if (options_.looks != nullptr) ++*options_.looks;
      const double above_m = look();
      if (found_.yes) return found_;
      if (time_ >= 1 || time_ > until) return found_;
      if (above_m > 0) {
        note_sure(above_m);
        if (sure_until_ >= 1) return found_;
        step = options_.width;
        time_ = std::min(1.0, std::max(sure_until_, time_ + step));
      } else {
        time_ = std::min(1.0, time_ + step);
        step *= 2;
      }
    }
    found_.is_cut_short = true;
    found_.bracket = {std::min(sure_from_start(), 1.0), 1};
    return found_;
  }

 private:
  /// Up to when it is sure without a gap.
  double sure_from_start() const { return unclear_ >= 0 ? unclear_ : sure_until_; }
  /// An upper bound on how much the side changes in all of the motion, metres.
  double speed_of(const GapSide& side) const {
    if (side.body == nullptr) return 0;
    const BodyMotion& motion = side.body->motion;
    return (motion.travel - from_.motion.travel).norm() + motion.turn_rad * side.body->reach_m +
           from_.motion.turn_rad * from_.reach_m;
  }
  static double off_of(const GapBody& body) { return body.motion.error_m(body.reach_m) + body.off_m; }
  GapBounds bounds_of_side(const GapSide& side, const Placed& from, double limit_m) {
    GapBounds bounds{.low_m = side.more_m, .high_m = side.more_m};
    if (side.body == nullptr) return bounds;
    const Frame frame = side.body->motion.at(time_);
    bounds = gap_bounds(from, placed_at(*side.body, frame), limit_m - side.more_m, cost_);
    const double off_m = off_of(*side.body) + off_of(from_);
    bounds.low_m = std::max(0.0, bounds.low_m - off_m) + side.more_m;
    bounds.high_m = bounds.high_m + off_m + side.more_m;
    return bounds;
  }
  /// By how much the side is surely above the other at time_, metres; not above 0: that is not sure.
  double look() {
    const Frame frame = from_.motion.at(time_);
    const Placed from = placed_at(from_, frame);
    const double left_m = change_m_ * (1 - time_) * (1 + kBoundSlack);
    // What is farther than either may come until the end need not be measured.
    const double bar_limit_m = nearer_.body == nullptr ? 2 * nearer_.more_m + left_m : kEndless;
    const GapBounds bar = bounds_of_side(bar_, from, bar_limit_m);
    const GapBounds nearer = bounds_of_side(nearer_, from, bar.high_m + left_m);
    if (bar_.body == nullptr ? nearer.high_m <= bar.low_m : nearer.high_m < bar.low_m) {
      found_.yes = true;
      found_.bracket = {std::min(sure_from_start(), time_), time_};
      return 0;
    }
    return nearer.low_m - bar.high_m;
  }
  /// The side is so much above the other at time_, and stays above it as long as the two cannot have come together.
  void note_sure(double above_m) {
    const double safe = change_m_ > 0 ? above_m * (1 - kBoundSlack) / change_m_ : 1;
    // What lies between the last time that was sure and this one is so, too, where the two cannot have met in between.
    if (time_ - safe > sure_until_ && unclear_ < 0) unclear_ = sure_until_;
    sure_until_ = std::max(sure_until_, std::min(1.0, time_ + safe));
  }

  const GapBody& from_;
  const GapSide& nearer_;
  const GapSide& bar_;
  const GapOptions& options_;
  WalkCost& cost_;
  double change_m_ = 0;  // an upper bound on how much the two sides come together in all of the motion
  double time_ = 0;
  double sure_until_ = 0;
  double unclear_ = -1;  // from when on it is not sure; negative: it is
  NearerTime found_;
};

}  // namespace

GapBounds gap_bounds(const Placed& a, const Placed& b, double limit_m, WalkCost& cost) {
  Deadline never;
  const std::optional<ObjectClearance> clearance =
      clearance_between(a, b, {.limit_m = std::max(0.0, limit_m), .depth = false}, cost, never);
  if (!clearance) return {.low_m = std::max(0.0, limit_m), .high_m = kEndless};
  if (clearance->touches == Decision::yes) return {};
  return {.low_m = clearance->touches == Decision::no ? std::max(0.0, clearance->low_m()) : 0,
          .high_m = std::max(0.0, clearance->high_m()),
          .at = *clearance};
}

NearerTime first_nearer(const GapBody& from, const GapSide& nearer, const GapSide& bar, double until,
                        const GapOptions& options, WalkCost& cost) {
  return NearerWalk(from, nearer, bar, options, cost).run(until);
}

}  // namespace collided::engine
