#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/accuracy/census/inputs.hpp"
#include "tests/accuracy/census/pair_inputs.hpp"
#include "tests/accuracy/quad.hpp"

namespace collided::census {
using namespace engine;

// True numbers for shapes on the grid, in steps of the grid, to 110 bits: whole numbers up to the last root.

inline Quad length_quad(const GridPoint& d) { return root(quad(square(Vec<Wide>(d)))); }

// ---- first parameter s along a ray (the point is origin + s direction)

inline std::optional<Quad> first_parameter(const RayInput& ray, const TriangleInput& t) {
  Fraction<Wide> s;
  if (!first_on_triangle<Wide>(ray.origin, ray.direction, corners<Wide>(t), s)) return std::nullopt;
  return quad(s);
}

inline std::optional<Quad> first_parameter(const RayInput& ray, const BoxInput& b) {
  const GridBox<Wide> box = grid_box<Wide>(b);
  const Vec<Wide> o = finer<Wide>(ray.origin, b.shift);
  if (box.holds(o)) return Quad(0);
  std::optional<Quad> first;
  for (int i = 0; i < 12; ++i) {
    Fraction<Wide> s;
    if (!first_on_triangle<Wide>(o, ray.direction, box.face(i), s)) continue;
    const Quad here = quad(s) / static_cast<Quad>(std::int64_t{1} << b.shift);
    if (!first || here < *first) first = here;
  }
  return first;
}

/// c / (-b + sqrt(b^2 - a c)), every coefficient whole.
inline std::optional<Quad> first_root(const Wide& a, const Wide& b, const Wide& c) {
  if (c <= Wide(0)) return Quad(0);
  const Wide discriminant = b * b - a * c;
  if (b >= Wide(0) || discriminant < Wide(0)) return std::nullopt;
  return quad(c) / (quad(-b) + root(quad(discriminant)));
}

inline std::optional<Quad> first_on_ball(const RayInput& ray, const GridPoint& center, std::int64_t radius) {
  const Vec<Wide> m = Vec<Wide>(ray.origin - center);
  const Vec<Wide> d(ray.direction);
  return first_root(square(d), dot(m, d), square(m) - Wide(radius) * Wide(radius));
}

inline std::optional<Quad> first_parameter(const RayInput& ray, const BallInput& ball) {
  return first_on_ball(ray, ball.center, ball.radius);
}

inline std::optional<Quad> first_parameter(const RayInput& ray, const PillInput& pill) {
  const Wide reach2 = Wide(pill.radius) * Wide(pill.radius);
  if (at_most(squared_distance<Wide>(ray.origin, pill.a, pill.b), reach2)) return Quad(0);
  std::optional<Quad> first = first_on_ball(ray, pill.a, pill.radius);
  const auto consider = [&](const std::optional<Quad>& s) {
    if (s && (!first || *s < *first)) first = s;
  };
  consider(first_on_ball(ray, pill.b, pill.radius));
  const Vec<Wide> axis(pill.b - pill.a);
  const Vec<Wide> m(ray.origin - pill.a);
  const Vec<Wide> d(ray.direction);
  const Vec<Wide> m_across = cross(m, axis);
  const Vec<Wide> d_across = cross(d, axis);
  const std::optional<Quad> wall =
      first_root(square(d_across), dot(m_across, d_across), square(m_across) - reach2 * square(axis));
  if (wall) {
    // Beside the ends the wall is met where a ball is met earlier; at the seam both are the same.
    const Quad along = quad(dot(m, axis)) + *wall * quad(dot(d, axis));
    if (along >= 0 && along <= quad(square(axis)) && square(m_across) > reach2 * square(axis)) consider(wall);
  }
  return first;
}

// ---- distances of cores, squared

inline Quad core_distance2(const Vec<Wide>& a, const Vec<Wide>& b, const Corners<Wide>& t) {
  const Vec<Wide> d = b - a;
  if (!d.zero() && line_meets_triangle(a, d, LineEnd<Wide>{LineEnd<Wide>::at_one, Wide(0)}, t)) return 0;
  Quad least = std::min(quad(squared_distance(a, t)), quad(squared_distance(b, t)));
  for (int i = 0; i < 3; ++i) least = std::min(least, quad(squared_distance(a, b, t[i], t[(i + 1) % 3])));
  return least;
}

/// Radius less distance without losing digits to the subtraction: both are differences of roots of whole numbers, in
/// 113 bits, of which at most 60 cancel.
inline Quad excess(Quad distance2, std::int64_t radius) { return static_cast<Quad>(radius) - root(distance2); }

inline Quad core_distance2(const GridPoint& p, const BallInput& ball) {
  return quad(square(Vec<Wide>(p - ball.center)));
}
inline Quad core_distance2(const GridPoint& p, const PillInput& pill) {
  return quad(squared_distance<Wide>(p, pill.a, pill.b));
}
inline Quad core_distance2(const GridPoint& p, const TriangleInput& t) {
  return quad(squared_distance<Wide>(p, corners<Wide>(t)));
}
inline Quad core_distance2(const GridPoint& p, const BoxInput& b) {
  const GridBox<Wide> box = grid_box<Wide>(b);
  const Vec<Wide> w = finer<Wide>(p, b.shift);
  if (box.holds(w)) return 0;
  Quad least = quad(squared_distance(w, box.face(0)));
  for (int i = 1; i < 12; ++i) least = std::min(least, quad(squared_distance(w, box.face(i))));
  return least / static_cast<Quad>(std::ldexp(1.0, 2 * b.shift));
}
inline Quad core_distance2(const PillInput& a, const PillInput& b) {
  return quad(squared_distance<Wide>(a.a, a.b, b.a, b.b));
}
inline Quad core_distance2(const PillInput& a, const TriangleInput& b) {
  return core_distance2(Vec<Wide>(a.a), Vec<Wide>(a.b), corners<Wide>(b));
}

// ---- least push of two polytopes that share a point

struct Polytope {
  std::vector<Vec<Wide>> points;
  std::vector<Vec<Wide>> reaches;  // of a box
  std::vector<Vec<Wide>> edges;
};

inline Polytope polytope(const TriangleInput& t, int shift) {
  const Corners<Wide> c = corners<Wide>(t, shift);
  return {{c[0], c[1], c[2]}, {}, {c[1] - c[0], c[2] - c[1], c[0] - c[2]}};
}
inline Polytope polytope(const BoxInput& b, int shift) {
  const GridBox<Wide> box = grid_box<Wide>(b);
  const Wide factor(std::int64_t{1} << (shift - b.shift));
  Polytope p{{factor * box.center}, {}, {}};
  for (int i = 0; i < 3; ++i) {
    p.reaches.push_back(factor * box.reach[i]);
    p.edges.push_back(Vec<Wide>(b.axes[i]));
  }
  return p;
}

/// Over the facet normals of the Minkowski difference: cross products of two edges.
inline Quad least_push(const Polytope& a, const Polytope& b) {
  std::vector<Vec<Wide>> edges = a.edges;
  edges.insert(edges.end(), b.edges.begin(), b.edges.end());
  std::optional<Quad> least;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      const Vec<Wide> n = cross(edges[i], edges[j]);
      if (n.zero()) continue;
      Wide reach(0);
      for (const Polytope* body : {&a, &b}) {
        for (const Vec<Wide>& r : body->reaches) {
          const Wide along = dot(n, r);
          reach = along < Wide(0) ? reach - along : reach + along;
        }
      }
      std::optional<Wide> low, high;
      for (const Vec<Wide>& p : a.points) {
        for (const Vec<Wide>& q : b.points) {
          const Wide along = dot(n, p - q);
          if (!low || along < *low) low = along;
          if (!high || along > *high) high = along;
        }
      }
      const Quad push = std::min(quad(*high + reach), quad(reach - *low)) / root(quad(square(n)));
      if (!least || push < *least) least = push;
    }
  }
  return least.value_or(0);
}

template <class A, class B>
Quad least_push_of(const A& a, const B& b, int shift) {
  return least_push(polytope(a, shift), polytope(b, shift)) / static_cast<Quad>(std::int64_t{1} << shift);
}

}  // namespace collided::census
