#pragma once

#include <utility>

#include "tests/accuracy/census/inputs.hpp"

namespace collided::census {
using namespace engine;

// What pairs are asked about: two shapes of one family.

using Wide = WideInt<8>;

template <class T>
Corners<T> corners(const TriangleInput& t, int shift = 0) {
  return {finer<T>(t.a, shift), finer<T>(t.b, shift), finer<T>(t.c, shift)};
}

inline double approximate(const Fraction<Wide>& f) { return approximate(f.numerator) / approximate(f.denominator); }

/// Moves a shape so that its point `from` comes to `to`, or one step beside it.
inline void move(Maker& make, TriangleInput& t, const GridPoint& from, const GridPoint& to) {
  const GridPoint step = to + make.nudged() - from;
  t = {t.a + step, t.b + step, t.c + step};
}
inline void move(Maker& make, BoxInput& b, const GridPoint& from, const GridPoint& to) {
  b.center = b.center + (to + make.nudged() - from);
}

/// A point of b comes to a point of a, or one step beside it.
template <class A, class B>
void move_together(Maker& make, const A& a, B& b) {
  const GridPoint from = make.on(b);
  const GridPoint to = make.on(a);
  move(make, b, from, to);
}

/// The first shape's radius, so that the pair touches when the squared distance is that of their cores.
inline std::int64_t rest_of(Maker& make, double squared_distance, std::int64_t other_radius) {
  return std::max<std::int64_t>(0, touching_radius(make, squared_distance) - other_radius);
}

inline auto ball_ball(Maker& make) {
  BallInput a = make.ball();
  const BallInput b = make.ball();
  if (make.aims()) a.radius = rest_of(make, approximate(square(Vec<Wide>(a.center - b.center))), b.radius);
  return std::pair{a, b};
}

inline auto ball_box(Maker& make) {
  BallInput a = make.ball();
  const BoxInput b = make.box();
  if (make.aims()) {
    const GridBox<Wide> box = grid_box<Wide>(b);
    const Vec<Wide> center = finer<Wide>(a.center, b.shift);
    double least = approximate(squared_distance(center, box.face(0)));
    for (int k = 1; k < 12; ++k) least = std::min(least, approximate(squared_distance(center, box.face(k))));
    a.radius = touching_radius(make, std::ldexp(least, -2 * b.shift));
  }
  return std::pair{a, b};
}

inline auto ball_pill(Maker& make) {
  BallInput a = make.ball();
  const PillInput b = make.pill();
  if (make.aims()) a.radius = rest_of(make, approximate(squared_distance<Wide>(a.center, b.a, b.b)), b.radius);
  return std::pair{a, b};
}

inline auto ball_triangle(Maker& make) {
  BallInput a = make.ball();
  const TriangleInput b = make.triangle();
  if (make.aims()) a.radius = touching_radius(make, approximate(squared_distance<Wide>(a.center, corners<Wide>(b))));
  return std::pair{a, b};
}

inline auto box_box(Maker& make) {
  const BoxInput a = make.box();
  BoxInput b = make.box();
  if (make.aims()) move_together(make, a, b);
  return std::pair{a, b};
}

inline auto box_pill(Maker& make) {
  const BoxInput a = make.box();
  PillInput b = make.pill();
  if (make.aims()) {
    // An end or the middle of the pill stands off the box by about its radius.
    const GridPoint axis = b.b - b.a;
    const GridPoint surface = make.on(a);
    const GridPoint off{make.whole(-3, 3), make.whole(-3, 3), make.whole(-3, 3)};
    const std::int64_t far = make.size() / 8;
    b.a = surface + far * off + make.nudged();
    b.b = b.a + axis;
    const double length =
        static_cast<double>(far) * std::sqrt(static_cast<double>(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]));
    b.radius = touching_radius(make, length * length);
  }
  return std::pair{a, b};
}

inline auto box_triangle(Maker& make) {
  const BoxInput a = make.box();
  TriangleInput b = make.triangle();
  if (make.aims()) move_together(make, a, b);
  return std::pair{a, b};
}

inline auto pill_pill(Maker& make) {
  PillInput a = make.pill();
  const PillInput b = make.pill();
  if (make.aims()) a.radius = rest_of(make, approximate(squared_distance<Wide>(a.a, a.b, b.a, b.b)), b.radius);
  return std::pair{a, b};
}

inline auto pill_triangle(Maker& make) {
  PillInput a = make.pill();
  const TriangleInput b = make.triangle();
  if (make.aims()) {
    const Corners<Wide> t = corners<Wide>(b);
    double least = std::min(approximate(squared_distance<Wide>(a.a, t)), approximate(squared_distance<Wide>(a.b, t)));
    for (int i = 0; i < 3; ++i) {
      least = std::min(least, approximate(squared_distance<Wide>(a.a, a.b, t[i], t[(i + 1) % 3])));
    }
    a.radius = touching_radius(make, least);
  }
  return std::pair{a, b};
}

inline auto triangle_triangle(Maker& make) {
  TriangleInput a = make.triangle();
  TriangleInput b = make.triangle();
  if (!make.aims()) return std::pair{a, b};
  const std::int64_t kind = make.whole(0, 5);
  if (kind == 0) b = {a.a, a.b, make.point()};                // a shared edge
  if (kind == 1) b = {a.c, make.point(), make.point()};       // a shared vertex
  if (kind == 2) b = {make.on(a), make.on(a), make.point()};  // an edge in the other's plane
  if (kind == 3)
    b = {make.summand(make.on(a)), make.on(a) + 2 * (a.b - a.a), make.on(a) - (a.c - a.a)};  // nearly coplanar
  if (kind >= 4) move_together(make, a, b);  // edges cross, a vertex on a face, and beside it
  return std::pair{a, b};
}

}  // namespace collided::census
