#include "server/world/objects/contact_times.hpp"

#include <algorithm>
#include <limits>

#include "server/exact_phase/motion/lasting_contact.hpp"
#include "server/geometry/common_origin.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// If a span is this many times too long, halving it does not lead to a proof: at both ends the two touch by no more
/// than the arithmetic resolves, such as an object exactly on the floor. They count as touching unless some time
/// between shows otherwise.
constexpr double kHopeless = 0x1p14;
/// Halvings of such a span, in search of a time at which the two are apart.
constexpr int kHopelessHalvings = 3;

/// Calls test(part) for the triangle, or for each primitive of the body, until it returns true.
template <class Test>
bool any_part(const SweptBody& body, std::uint32_t first_triangle, std::uint32_t triangle, Test&& test) {
  if (triangle != kNoTriangle) return test(as_part(body.mesh->triangle(first_triangle + triangle)));
  return std::any_of(body.primitives.begin(), body.primitives.end(),
                     [&](const Primitive& primitive) { return test(as_part(primitive)); });
}

TimeBracket from_reversed(const TimeBracket& bracket) { return {1 - bracket.high, 1 - bracket.low}; }

/// A time at which the two touch, with the touching parts.
struct TouchAtTime {
  double t = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Contact contact;

  TouchAtTime(double at_t, const TouchAtEnd& at)
      : t(at_t), a_triangle(at.a_triangle), b_triangle(at.b_triangle), contact(at.contact) {}
  TouchAtTime(double at_t, const SweptContact& at)
      : t(at_t), a_triangle(at.a_triangle), b_triangle(at.b_triangle), contact(at.contact) {}
  TouchAtTime(double at_t, const ContactSearch& at)
      : t(at_t), a_triangle(at.a_triangle), b_triangle(at.b_triangle), contact(at.contact) {}
  TouchAtTime(double at_t, const TouchAtTime& at) : TouchAtTime(at) { t = at_t; }

  bool is_known() const { return !contact.normal.isZero(0); }
  bool is_by_same_parts(const TouchAtTime& other) const {
    return a_triangle == other.a_triangle && b_triangle == other.b_triangle;
  }
};

class IntervalSearch {
 public:
  IntervalSearch(const BodiesInMotion& bodies, const ContactTimesLimits& limits, ContactTimes& times)
      : bodies_(bodies),
        limits_(limits),
        times_(times),
        is_straight_(bodies.a.body().motion.turn_rad == 0 && bodies.b.body().motion.turn_rad == 0) {}

  double shortfall(const TouchAtTime& low, const TouchAtTime& high) const;
  void run(const TouchAtEnd& begin, const TouchAtEnd& end, const SweptContact* first);

 private:
  void settle(const TouchAtTime& low, const TouchAtTime& high, int halvings);
  void part_at(const TouchAtTime& low, double middle, const TouchAtTime& high, int halvings);
  double shortfall_by(const TouchAtTime& parts, const TimeSpan& span, const KnownContacts& known) const;

  const BodiesInMotion& bodies_;
  const ContactTimesLimits& limits_;
  ContactTimes& times_;
  bool is_straight_;
  std::uint32_t looks_ = 0;
};

double IntervalSearch::shortfall_by(const TouchAtTime& parts, const TimeSpan& span, const KnownContacts& known) const {
  double least = std::numeric_limits<double>::infinity();
  const SweptBody& body_a = bodies_.a.body();
  const SweptBody& body_b = bodies_.b.body();
  any_part(body_a, bodies_.a_first_triangle, parts.a_triangle, [&](const ConvexPart& a) {
    return any_part(body_b, bodies_.b_first_triangle, parts.b_triangle, [&](const ConvexPart& b) {
      const double of_these = shortfall_between({a, body_a.motion}, {b, body_b.motion}, span, bodies_.off_m, known);
      least = std::min(least, of_these);
      return least == 0;
    });
  });
  return least;
}

/// How far the parts that touch at either end are from being known to touch throughout, as in lasting_contact.hpp.
double IntervalSearch::shortfall(const TouchAtTime& low, const TouchAtTime& high) const {
  const auto is_one = [](const SweptBody& body, std::uint32_t triangle) {
    return triangle != kNoTriangle || body.primitives.size() == 1;
  };
  const bool are_same = low.is_by_same_parts(high) && is_one(bodies_.a.body(), low.a_triangle) &&
                        is_one(bodies_.b.body(), low.b_triangle);
  if (is_straight_ && are_same) return 0;
  const TimeSpan span{low.t, high.t};
  if (are_same && low.is_known() && high.is_known()) {
    const Vec3 at_low = seen_from(bodies_.origin, low.contact.point);
    const Vec3 at_high = seen_from(bodies_.origin, high.contact.point);
    const double of_both = shortfall_by(high, span, {&at_low, &at_high, bodies_.contact_off_m});
    if (of_both == 0) return 0;
  }
  const double of_high = shortfall_by(high, span, {});
  if (of_high == 0 || low.is_by_same_parts(high)) return of_high;
  return std::min(of_high, shortfall_by(low, span, {}));
}

/// The two touch at both times: finds where they separate and meet again in between.
void IntervalSearch::settle(const TouchAtTime& low, const TouchAtTime& high, int halvings) {
  if (times_.are_too_many || high.t - low.t <= limits_.width) return;
  const double missing = shortfall(low, high);
  if (missing == 0) return;
  const bool is_hopeless = missing > kHopeless && missing < std::numeric_limits<double>::infinity();
  const double middle = low.t + (high.t - low.t) / 2;
  if ((is_hopeless && halvings >= kHopelessHalvings) || !(low.t < middle && middle < high.t)) return;
  if (looks_ >= limits_.most_looks) {
    times_.is_open = true;
    return;
  }
  ++looks_;
  const ContactSearch touch = bodies_.touch_at(middle);
  if (!touch.yes) return part_at(low, middle, high, halvings + 1);
  const TouchAtTime between(middle, touch);
  settle(low, between, halvings + 1);
  settle(between, high, halvings + 1);
}

/// The two are apart in the middle, or so near that the searches starting there do not advance.
void IntervalSearch::part_at(const TouchAtTime& low, double middle, const TouchAtTime& high, int halvings) {
  const SweptContact last = bodies_.first({1 - middle, 1 - low.t}, true);
  const SweptContact next = bodies_.first({middle, high.t}, false);
  const TimeBracket ended = last.yes ? from_reversed(last.bracket) : TimeBracket{low.t, middle};
  const double parting_at = std::max(ended.low, low.t);
  const TouchAtTime parting = last.yes ? TouchAtTime(parting_at, last) : TouchAtTime(parting_at, low);
  const TouchAtTime meeting = next.yes ? TouchAtTime(next.bracket.high, next) : high;
  times_.is_open = times_.is_open || last.undecided || next.undecided;
  const double next_low = next.yes ? next.bracket.low : middle;
  const bool are_apart = ended.high < next_low;
  if (are_apart && times_.intervals.size() >= limits_.most) {
    times_.are_too_many = true;
    return;
  }
  settle(low, parting, halvings);
  if (times_.are_too_many) return;
  if (are_apart) {
    ContactInterval& here = times_.intervals.back();
    const ContactInterval rest{.begin = {}, .end = here.end, .last = here.last};
    here.end = ended;
    here.last = last.contact;
    times_.intervals.push_back(rest);
    SweptContact met = next;
    if (!next.yes) met.bracket = {middle, high.t};
    times_.intervals.back().begin = met;
  }
  settle(meeting, high, halvings);
}

void IntervalSearch::run(const TouchAtEnd& begin, const TouchAtEnd& end, const SweptContact* first) {
  TouchAtTime low(0, begin);
  TouchAtTime high(1, end);
  ContactInterval all;
  if (!begin.yes) {
    const SweptContact met = first != nullptr ? *first : bodies_.first({0, 1}, false);
    times_.is_open = times_.is_open || met.undecided;
    if (!met.yes && !end.yes) return;
    all.begin = met;
    // At the end of the motion, placed bodies may touch by rounding alone.
    if (!met.yes) all.begin->bracket = {0, 1};
    low = TouchAtTime(all.begin->bracket.high, met);
  }
  if (!end.yes) {
    const SweptContact last = bodies_.first({0, 1}, true);
    times_.is_open = times_.is_open || last.undecided;
    times_.is_end_open = last.is_cut_short;
    if (last.yes) all.end = from_reversed(last.bracket);
    else if (times_.is_end_open) all.end = TimeBracket{low.t, 1};
    else all.end = all.begin ? all.begin->bracket : TimeBracket{0, limits_.width};  // they touch by a rounding
    all.last = last.contact;
    high = last.yes ? TouchAtTime(all.end->low, last) : low;
    // A graze: both brackets hold its time.
    if (all.begin) all.end->low = std::max(all.end->low, all.begin->bracket.low);
    all.end->high = std::max(all.end->high, all.end->low);
  }
  times_.intervals.push_back(all);
  settle(low, high, 0);
}

}  // namespace

BodiesInMotion::BodiesInMotion(const Side& of_a, const Side& of_b, First find_first, TouchAt find_touch)
    : origin(common_origin(of_a.body, of_b.body)),
      a(origin, of_a.body),
      b(origin, of_b.body),
      a_first_triangle(of_a.first_triangle),
      b_first_triangle(of_b.first_triangle),
      first(find_first),
      touch_at(find_touch),
      off_m(2 * (a.body().motion.error_m(of_a.reach_m) + b.body().motion.error_m(of_b.reach_m))),
      // Moving a point back rounds each coordinate, which is at most twice the origin's.
      contact_off_m(4 * kRoundoff * origin.norm() * (1 + kBoundSlack)) {}

void find_contact_times(const BodiesInMotion& bodies, const TouchAtEnd& begin, const TouchAtEnd& end,
                        const SweptContact* first, const ContactTimesLimits& limits, ContactTimes& times) {
  times.clear();
  IntervalSearch(bodies, limits, times).run(begin, end, first);
}

bool surely_touch_throughout(const BodiesInMotion& bodies, const TouchAtEnd& begin, const TouchAtEnd& end) {
  ContactTimes none;
  const IntervalSearch search(bodies, {}, none);
  return search.shortfall(TouchAtTime(0, begin), TouchAtTime(1, end)) == 0;
}

bool touch_at_most_once(const ObjectInfo& a, const BodyMotion& on_a, const ObjectInfo& b, const BodyMotion& on_b) {
  return on_a.turn_rad == 0 && on_b.turn_rad == 0 && is_lone_convex(a) && is_lone_convex(b);
}

}  // namespace collided::engine
