#include "server/exact_phase/motion/moving_solids.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/kernels/box_kernel.hpp"
#include "server/exact_phase/motion/monotone_bracket.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

/// The mover's translation by time t.
template <class N, class Shape>
Vector<N> travel_until(const Translated<Shape>& mover, double t) {
  return N(t) * (Vector<N>(mover.to) - Vector<N>(mover.from));
}

/// A box with the volume that it sweeps: the same box with a fourth axis, half the translation to either side of the
/// middle.
template <class N>
struct SweptBox {
  Solid<N> box;
  Vector<N> displacement;
  Vector<N> middle;

  SweptBox(const Translated<Box>& mover, double t)
      : box(mover.start), displacement(travel_until<N>(mover, t)), middle(box.center + N(0.5) * displacement) {}
};

/// Whether a plane perpendicular to n lies strictly between the two.
template <class N>
Decision separates(const Vector<N>& n, const SweptBox<N>& swept, const Facet<N>& f) {
  N reach = N(0.5) * abs(dot(n, swept.displacement));
  for (int i = 0; i < 3; ++i) reach = reach + swept.box.half[i] * abs(dot(n, swept.box.axis[i]));
  N nearest = dot(n, f.corner[0] - swept.middle);
  N farthest = nearest;
  for (int i = 1; i < 3; ++i) {
    const N along = dot(n, f.corner[i] - swept.middle);
    nearest = min(nearest, along);
    farthest = max(farthest, along);
  }
  return either(less(reach, nearest), less(reach, -farthest));
}

/// Tests as axes all normals that a face of the difference of the two can have.
template <class N>
Decision touched(const Translated<Box>& mover, double t, const Triangle& other) {
  const SweptBox<N> swept(mover, t);
  const Facet<N> f(other);
  if (!swept.box.spans()) return Decision::undecided;
  AllOf together;
  const auto parted = [&](const Vector<N>& n) { return together.add(opposite(separates(n, swept, f))); };
  const auto parted_across = [&](const Vector<N>& u, const Vector<N>& v) {
    return !same_line(u, v) && parted(cross(u, v));
  };
  for (int i = 0; i < 3; ++i) {
    if (parted(swept.box.normal[i])) return Decision::no;
  }
  if (parted(f.normal)) return Decision::no;
  for (int i = 0; i < 3; ++i) {
    if (parted_across(swept.displacement, f.edge[i]) || parted_across(swept.displacement, swept.box.axis[i]))
      return Decision::no;
    for (int j = 0; j < 3; ++j) {
      if (parted_across(swept.box.axis[i], f.edge[j])) return Decision::no;
    }
  }
  return together.result();
}

/// Two flat sets are within R exactly where an edge of one is near the other.
template <class N>
Decision touched(const Translated<Capsule>& mover, double t, const Triangle& other) {
  const Capsule& capsule = mover.start;
  const Vector<N> displacement = travel_until<N>(mover, t);
  const Vector<N> a(capsule.a);
  const Vector<N> b(capsule.b);
  const Vector<N> a_end = a + displacement;
  const Vector<N> b_end = b + displacement;
  const N R2 = N(capsule.radius_m) * N(capsule.radius_m);
  const Facet<N> f(other);
  AnyOf any;
  const Segment<N> sides[4] = {
      {a, b}, {a_end, b_end, b - a}, Segment<N>::along(a, displacement), Segment<N>::along(b, displacement)};
  for (const Segment<N>& side : sides) {
    if (any.add(segment_near_facet(side, f, R2))) return Decision::yes;
  }
  const Facet<N> halves[2] = {{a, b, b_end}, {a, b_end, a_end}};
  for (const Facet<N>& half : halves) {
    for (int i = 0; i < 3; ++i) {
      if (any.add(segment_near_facet(f.side(i), half, R2))) return Decision::yes;
    }
  }
  return any.result();
}

/// The last time at which some axis stops separating the two, in plain double.
double guessed_time(const Translated<Box>& mover, const Triangle& other) {
  const Box& box = mover.start;
  const Vec3 displacement = mover.to - mover.from;
  const std::array<Vec3, 3> corner{other.a - box.center, other.b - box.center, other.c - box.center};
  double latest = 0;
  const auto consider = [&](const Vec3& n) {
    double reach = 0;
    for (int i = 0; i < 3; ++i) reach += box.half_m[i] * std::abs(n.dot(box.axes.col(i)));
    const auto [low, high] = std::minmax({n.dot(corner[0]), n.dot(corner[1]), n.dot(corner[2])});
    const double speed = n.dot(displacement);
    const double gap = speed > 0 ? low - reach : -high - reach;
    if (gap > 0 && speed != 0) latest = std::max(latest, gap / std::abs(speed));
  };
  const std::array<Vec3, 3> edge{corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
  consider(edge[0].cross(edge[1]));
  for (int i = 0; i < 3; ++i) {
    consider(box.axes.col((i + 1) % 3).cross(box.axes.col((i + 2) % 3)));
    for (int j = 0; j < 3; ++j) consider(box.axes.col(i).cross(edge[j]));
  }
  return latest < 1 ? latest : 1;
}

/// Approximate time at which the segment's nearer end meets the triangle's plane; good enough as a guess.
double guessed_time(const Translated<Capsule>& mover, const Triangle& other) {
  const Capsule& capsule = mover.start;
  const Vec3 n = (other.b - other.a).cross(other.c - other.a);
  const double a = n.dot(capsule.a - other.a);
  const double b = n.dot(capsule.b - other.a);
  const double speed = std::abs(n.dot(mover.to - mover.from));
  const double gap = std::min(std::abs(a), std::abs(b)) - capsule.radius_m * n.norm();
  return gap > 0 && gap < speed ? gap / speed : 0;
}

template <class Shape>
ExactResult bracket_first_contact(const Translated<Shape>& mover, const Triangle& other, double width,
                                  TimeBracket& bracket) {
  return bracket_monotone([&](double t) { return climb([&]<class N>() { return touched<N>(mover, t, other); }); },
                          [&] { return guessed_time(mover, other); }, width, bracket);
}

}  // namespace

ExactResult first_contact(const Translated<Box>& mover, const Triangle& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

ExactResult first_contact(const Translated<Capsule>& mover, const Triangle& other, double width, TimeBracket& bracket) {
  return bracket_first_contact(mover, other, width, bracket);
}

}  // namespace collided::engine
