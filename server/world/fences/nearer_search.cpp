#include "server/world/fences/nearer_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

Placed placed_at(const GapBody& body, const Frame& frame) {
  return {.info = body.info, .frame = frame, .bounds = bounds_of(*body.info, frame), .pose = nullptr};
}

/// Both sides at one time.
struct NearerLook {
  double time = 0;
  GapBounds nearer = {};
  GapBounds bar = {};
  // Least gain of `nearer` over the whole motion if it continues as here: forward, and backward in time.
  double gain_m = -kEndless;
  double back_gain_m = -kEndless;
  bool yes = false;

  double above_m() const { return nearer.low_m - bar.high_m; }
  /// A lower bound on `nearer` at another time.
  double nearer_low_m(double at) const {
    return nearer.low_m + (at >= time ? gain_m * (at - time) : back_gain_m * (time - at));
  }
};

/// Evaluation at one time, shared by both searches.
class NearerSides {
 public:
  NearerSides(const GapBody& from, const GapSide& nearer, const GapSide& bar, const GapOptions& options, WalkCost& cost)
      : from_(from),
        nearer_(nearer),
        bar_(bar),
        options_(options),
        cost_(cost),
        nearer_change_m_(change_of(nearer)),
        change_m_((nearer_change_m_ + change_of(bar)) * (1 + kBoundSlack)) {}

  /// True if distances are convex over time: for single convex bodies that only translate.
  bool are_convex() const { return is_convex(from_) && is_convex(nearer_) && is_convex(bar_); }
  bool is_over() const { return looks_ >= options_.most_looks; }
  double width() const { return options_.width; }
  /// An upper bound on how much the two sides approach each other over the whole motion.
  double change_m() const { return change_m_; }

  NearerLook look(double time) {
    ++looks_;
    if (options_.looks != nullptr) ++*options_.looks;
    NearerLook look{.time = time};
    const Frame frame = from_.motion.at(time);
    const Placed from = placed_at(from_, frame);
    // Distances beyond what either side can change until the end need not be measured.
    const double left_m = change_m_ * (1 + kBoundSlack);
    look.bar = bounds_of_side(bar_, from, time, nearer_.body == nullptr ? 2 * nearer_.more_m + left_m : kEndless);
    look.nearer = bounds_of_side(nearer_, from, time, look.bar.high_m + left_m);
    look.yes = bar_.body == nullptr ? look.nearer.high_m <= look.bar.low_m : look.nearer.high_m < look.bar.low_m;
    note_gain(look);
    return look;
  }

 private:
  static bool is_convex(const GapBody& body) {
    return body.motion.turn_rad == 0 && body.info->primitives.size() == 1 && !body.info->mesh;
  }
  static bool is_convex(const GapSide& side) { return side.body == nullptr || is_convex(*side.body); }
  static double off_of(const GapBody& body) { return body.motion.error_m(body.reach_m) + body.off_m; }
  Vec3 travel_of(const GapSide& side) const { return side.body->motion.travel - from_.motion.travel; }

  /// An upper bound on the change of the side over the whole motion, metres.
  double change_of(const GapSide& side) const {
    if (side.body == nullptr) return 0;
    const double turned_m = side.body->motion.turn_rad * side.body->reach_m + from_.motion.turn_rad * from_.reach_m;
    return (travel_of(side).norm() + turned_m) * (1 + kBoundSlack);
  }
  GapBounds bounds_of_side(const GapSide& side, const Placed& from, double time, double limit_m) {
    GapBounds bounds{.low_m = side.more_m, .high_m = side.more_m};
    if (side.body == nullptr) return bounds;
    const Frame frame = side.body->motion.at(time);
    bounds = gap_bounds(from, placed_at(*side.body, frame), limit_m - side.more_m, cost_);
    const double off_m = off_of(*side.body) + off_of(from_);
    bounds.low_m = std::max(0.0, bounds.low_m - off_m) + side.more_m;
    bounds.high_m = bounds.high_m + off_m + side.more_m;
    return bounds;
  }
  /// A plane between two convex bodies bounds their distance throughout a translation.
  void note_gain(NearerLook& look) const {
    if (nearer_.body == nullptr) {
      look.gain_m = look.back_gain_m = 0;
      return;
    }
    look.gain_m = look.back_gain_m = -nearer_change_m_;
    const bool is_measured = look.nearer.high_m < kEndless && !look.nearer.at.normal.isZero(0);
    if (!is_measured) return;
    const double along_m = look.nearer.at.normal.dot(travel_of(nearer_));
    look.gain_m = along_m - kBoundSlack * nearer_change_m_;
    look.back_gain_m = -along_m - kBoundSlack * nearer_change_m_;
  }

  const GapBody& from_;
  const GapSide& nearer_;
  const GapSide& bar_;
  const GapOptions& options_;
  WalkCost& cost_;
  double nearer_change_m_ = 0;
  double change_m_ = 0;
  std::uint32_t looks_ = 0;
};

/// A search that halves time until each part is decided.
class NearerSearch {
 public:
  explicit NearerSearch(NearerSides& sides) : sides_(sides) {}

  NearerTime run() {
    const NearerLook first = sides_.look(0);
    if (first.yes) return {.yes = true, .bracket = {0, 0}};
    search(first, sides_.look(1));
    return found_;
  }

 private:
  /// True: found, or the evaluations are used up.
  bool search(const NearerLook& from, const NearerLook& to) {
    if (is_surely_above(from, to)) {
      if (!is_unclear_) sure_until_ = to.time;
      return false;
    }
    if (to.time - from.time <= sides_.width()) {
      is_unclear_ = true;
      found_ = {.yes = to.yes, .bracket = {sure_until_, to.time}};
      return to.yes;
    }
    if (sides_.is_over()) {
      found_ = {.is_cut_short = true, .bracket = {sure_until_, 1}};
      return true;
    }
    const NearerLook middle = sides_.look((from.time + to.time) / 2);
    if (middle.yes) return search(from, middle);
    return search(from, middle) || search(middle, to);
  }

  bool is_surely_above(const NearerLook& from, const NearerLook& to) const {
    if (!(from.above_m() > 0) || !(to.above_m() > 0)) return false;
    return sides_.are_convex() ? is_above_planes(from, to) : is_above_paths(from, to);
  }
  /// Decides by path lengths: neither side changes by more.
  bool is_above_paths(const NearerLook& from, const NearerLook& to) const {
    return from.above_m() + to.above_m() > sides_.change_m() * (to.time - from.time) * (1 + kBoundSlack);
  }
  /// Decides by planes: one side is above two planes' distances, linear in time, the other below a chord.
  static bool is_above_planes(const NearerLook& from, const NearerLook& to) {
    // The maximum of the two lower bounds is least where they intersect.
    const double length = to.time - from.time;
    const double rise_m = to.nearer.low_m + to.back_gain_m * length - from.nearer.low_m;
    const double rates_m = from.gain_m + to.back_gain_m;
    const double after = rates_m < 0 ? std::clamp(rise_m / rates_m, 0.0, length) : 0;
    const double nearer_m = std::max(from.nearer_low_m(from.time + after), to.nearer_low_m(from.time + after));
    const double chord_m = from.bar.high_m + after / length * (to.bar.high_m - from.bar.high_m);
    return nearer_m - chord_m > kBoundSlack * (std::abs(nearer_m) + std::abs(chord_m));
  }

  NearerSides& sides_;
  double sure_until_ = 0;
  bool is_unclear_ = false;  // some part after sure_until_ is undecided
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

NearerTime first_nearer(const GapBody& from, const GapSide& nearer, const GapSide& bar, const GapOptions& options,
                        WalkCost& cost) {
  NearerSides sides(from, nearer, bar, options, cost);
  return NearerSearch(sides).run();
}

}  // namespace collided::engine
