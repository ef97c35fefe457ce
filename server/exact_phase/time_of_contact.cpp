#include "server/exact_phase/time_of_contact.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <variant>

#include "server/exact_phase/box_kernel.hpp"
#include "server/exact_phase/closest.hpp"

namespace collided {
namespace {

using namespace kernel;

/// What the sphere has covered by time t. The end point start + t (end - start) is not rounded.
template <class N>
Segment<N> path_until(const MovingSphere& mover, double t) {
  const Vector<N> start(mover.start);
  return Segment<N>::along(start, N(t) * (Vector<N>(mover.end) - start));
}

template <class N>
N squared(double a, double b) {
  const N sum = N(a) + N(b);
  return sum * sum;
}

template <class N>
Decision touched(const MovingSphere& mover, double t, const Sphere& other) {
  return point_near_segment(Vector<N>(other.center), path_until<N>(mover, t), squared<N>(mover.radius_m, other.radius_m));
}

template <class N>
Decision touched(const MovingSphere& mover, double t, const Box& other) {
  return segment_near_solid(path_until<N>(mover, t), Solid<N>(other), squared<N>(mover.radius_m, 0));
}

template <class N>
Decision touched(const MovingSphere& mover, double t, const Capsule& other) {
  return segments_near(path_until<N>(mover, t), Segment<N>{Vector<N>(other.a), Vector<N>(other.b)},
                       squared<N>(mover.radius_m, other.radius_m));
}

template <class N>
Decision touched(const MovingSphere& mover, double t, const Triangle& other) {
  return segment_near_facet(path_until<N>(mover, t), Facet<N>(other), squared<N>(mover.radius_m, 0));
}

/// A time strictly between, if there is one: by value when the two are close, by exponent when they are far apart, so
/// that a contact at 1e-300 is as few steps away as one at a half.
double time_between(double low, double high) {
  if (high <= 2 * low) return low + (high - low) / 2;
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  return std::bit_cast<double>(bits(low) + (bits(high) - bits(low)) / 2);
}

template <class Shape>
double gap_at(const MovingSphere& mover, double t, const Shape& other, double& slope) {
  const Vec3 step = mover.end - mover.start;
  const Closest nearest = closest(mover.start + t * step, other);
  slope = nearest.normal.dot(step);
  return nearest.distance_m - mover.radius_m;
}

/// About the first time, by Newton's method: along a line the distance to a convex set is convex, so the steps come
/// from before the contact and never pass it but for rounding. Nothing is decided here.
template <class Shape>
double guessed_time(const MovingSphere& mover, const Shape& other) {
  double t = 0;
  for (int step = 0; step < 12; ++step) {
    double slope = 0;
    const double gap = gap_at(mover, t, other, slope);
    if (!(gap > 0) || !(slope < 0)) break;
    const double next = t - gap / slope;
    if (!(next < 1) || next - t < kRoundoff * next) break;
    t = next;
  }
  return t;
}

/// "Has it touched by t" is false, then true for ever: bisection with exact answers keeps a proved bracket.
template <class Shape>
Verdict bracket_first_contact(const MovingSphere& mover, const Shape& other, double width, TimeBracket& bracket) {
  Level level = Level::filter;
  const auto touched_by = [&](double t) {
    const Verdict v = climb([&]<class N>() { return touched<N>(mover, t, other); });
    level = std::max(level, v.level);
    return v.decision;
  };
  const Decision ever = touched_by(1);
  if (ever != Decision::yes) return {ever, level};
  bracket = {0, 1};
  if (touched_by(0) == Decision::yes) {
    bracket.high = 0;
    return {Decision::yes, level};
  }
  // False where the thread's precision leaves a time open: the bracket stays as wide as it is known.
  const auto narrow = [&](double t) {
    if (!(t > bracket.low && t < bracket.high)) return true;
    const Decision touched_then = touched_by(t);
    if (touched_then == Decision::undecided) return false;
    (touched_then == Decision::yes ? bracket.high : bracket.low) = t;
    return true;
  };
  // Close in around the guess from both sides, in steps that grow until they hold it.
  const double guess = guessed_time(mover, other);
  double reach = std::max(width * 0.4375, 4 * kRoundoff * guess);
  for (int step = 0; step < 4 && bracket.high - bracket.low > width; ++step, reach *= 64) {
    narrow(guess - reach);
    narrow(guess + reach);
  }
  // 64 halvings of the exponent and 53 of the mantissa end at neighbours.
  for (int step = 0; step < 128 && bracket.high - bracket.low > width; ++step) {
    const double t = time_between(bracket.low, bracket.high);
    if (!(t > bracket.low && t < bracket.high) || !narrow(t)) break;
  }
  return {Decision::yes, level};
}

}  // namespace

Verdict first_contact(const MovingSphere& mover, const Sphere& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

Verdict first_contact(const MovingSphere& mover, const Box& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

Verdict first_contact(const MovingSphere& mover, const Capsule& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

Verdict first_contact(const MovingSphere& mover, const Triangle& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

Verdict first_contact(const MovingSphere& mover, const Primitive& other, double width, TimeBracket& bracket) {
  return std::visit([&](const auto& shape) { return first_contact(mover, shape, width, bracket); }, other);
}

}  // namespace collided
