#include "server/exact_phase/motion/time_of_contact.hpp"

#include <cmath>
#include <variant>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/kernels/box_kernel.hpp"
#include "server/exact_phase/motion/monotone_bracket.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

/// The path of the centre up to time t. The end point start + t (end - start) is not rounded.
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
  return point_near_segment(Vector<N>(other.center), path_until<N>(mover, t),
                            squared<N>(mover.radius_m, other.radius_m));
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

/// The lower end of the motion decides.
template <class N>
Decision touched(const MovingSphere& mover, double t, const HalfSpace& other) {
  const Vector<N> n(other.normal);
  const Vector<N> start(mover.start);
  const N ahead = dot(n, start - Vector<N>(other.point));
  const N least = min(ahead, ahead + N(t) * dot(n, Vector<N>(mover.end) - start));
  return either(at_most(least, N(0.0)), at_most(least * least, squared<N>(mover.radius_m, 0) * square(n)));
}

template <class Shape>
ExactResult touched_until(const MovingSphere& mover, double t, const Shape& other) {
  return climb([&]<class N>() { return touched<N>(mover, t, other); });
}

/// Here the end of the path is rounded, by at most 4 u of its coordinates; so a "no" is tested with a radius larger by
/// that, a "yes" with one smaller.
template <General Shape>
ExactResult touched_until(const MovingSphere& mover, double t, const Shape& other) {
  Capsule motion{mover.start, t == 1 ? mover.end : Vec3(mover.start + t * (mover.end - mover.start)), mover.radius_m};
  if (t == 0 || t == 1) return overlaps(motion, other);
  const double slack = 8 * kRoundoff * (mover.start.cwiseAbs().maxCoeff() + mover.end.cwiseAbs().maxCoeff());
  motion.radius_m = (mover.radius_m + slack) * (1 + 2 * kRoundoff);
  const ExactResult wide = overlaps(motion, other);
  if (!wide.yes()) return wide;
  motion.radius_m = (mover.radius_m - slack) * (1 - 2 * kRoundoff);
  const ExactResult narrow = motion.radius_m >= 0 ? overlaps(motion, other) : ExactResult{Decision::no, wide.level};
  return narrow.yes() ? narrow : ExactResult{Decision::undecided, narrow.level};
}

/// The gap at time t in metres, and its slope, in plain double.
template <class Shape>
double gap_at(const MovingSphere& mover, double t, const Shape& other, double& slope) {
  const Vec3 step = mover.end - mover.start;
  const Closest nearest = closest(mover.start + t * step, other);
  slope = nearest.normal.dot(step);
  return nearest.distance_m - mover.radius_m;
}

/// An approximation of the first time, by Newton's method: along a line the distance to a convex set is convex, so the
/// steps approach the contact from before and pass it only by rounding. No decision depends on it.
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

/// For two spheres the first root of a quadratic, in the form that loses no digits.
double guessed_time(const MovingSphere& mover, const Sphere& other) {
  const Vec3 step = mover.end - mover.start;
  const Vec3 away = mover.start - other.center;
  const double reach_m = mover.radius_m + other.radius_m;
  const double closing = -away.dot(step);
  const double over = away.squaredNorm() - reach_m * reach_m;
  const double under = closing * closing - step.squaredNorm() * over;
  const double t = over / (closing + std::sqrt(under > 0 ? under : 0));
  return t > 0 && t < 1 ? t : 0;
}

template <class Shape>
ExactResult bracket_first_contact(const MovingSphere& mover, const Shape& other, double width, TimeBracket& bracket) {
  return bracket_monotone([&](double t) { return touched_until(mover, t, other); },
                          [&] { return guessed_time(mover, other); }, width, bracket);
}

}  // namespace

ExactResult first_contact(const MovingSphere& mover, const Sphere& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const MovingSphere& mover, const Box& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const MovingSphere& mover, const Capsule& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const MovingSphere& mover, const Cylinder& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const MovingSphere& mover, const Cone& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const MovingSphere& mover, const Ellipsoid& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const MovingSphere& mover, const Hull& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const MovingSphere& mover, const HalfSpace& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const MovingSphere& mover, const Triangle& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const MovingSphere& mover, const Primitive& other, double width, TimeBracket& bracket) {
  return std::visit([&](const auto& shape) { return first_contact(mover, shape, width, bracket); }, other);
}

}  // namespace collided::engine
