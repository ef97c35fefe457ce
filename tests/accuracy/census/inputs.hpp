#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"
#include "tests/accuracy/census/grid_truth.hpp"

namespace collided::census {
using namespace engine;

/// How a family's whole numbers become the doubles that are asked about: (n + offset) * 2^power. Both steps are exact.
struct Placing {
  GridPoint offset{0, 0, 0};
  int power = 0;

  double length(std::int64_t n) const { return std::ldexp(static_cast<double>(n), power); }
  Vec3 point(const GridPoint& p) const {
    return {length(p[0] + offset[0]), length(p[1] + offset[1]), length(p[2] + offset[2])};
  }
};

struct BallInput {
  GridPoint center;
  std::int64_t radius;
};
struct PillInput {
  GridPoint a;
  GridPoint b;
  std::int64_t radius;
};
struct TriangleInput {
  GridPoint a, b, c;
};
/// Axis i is axes[i] * 2^-shift, so in units of 2^-shift everything stays whole.
struct BoxInput {
  GridPoint center;
  GridPoint half;
  std::array<GridPoint, 3> axes;
  int shift;
};
/// length < 0: without end. Else the ray ends at origin + direction * length / |direction|, whose |direction| is whole.
struct RayInput {
  GridPoint origin;
  GridPoint direction;
  std::int64_t length = -1;
};

/// In units of the box's grid, 2^-shift of the others' one.
template <class T>
Vec<T> finer(const GridPoint& p, int shift) {
  return T(std::int64_t{1} << shift) * Vec<T>(p);
}

template <class T>
GridBox<T> grid_box(const BoxInput& b) {
  GridBox<T> box{finer<T>(b.center, b.shift), {}};
  for (int i = 0; i < 3; ++i) box.reach[i] = T(b.half[i]) * Vec<T>(b.axes[i]);
  return box;
}

inline Sphere placed(const BallInput& s, const Placing& at) { return {at.point(s.center), at.length(s.radius)}; }
inline Capsule placed(const PillInput& s, const Placing& at) {
  return {at.point(s.a), at.point(s.b), at.length(s.radius)};
}
inline Triangle placed(const TriangleInput& t, const Placing& at) {
  return {at.point(t.a), at.point(t.b), at.point(t.c)};
}
inline Box placed(const BoxInput& b, const Placing& at) {
  Box box{at.point(b.center), Mat3::Identity(), {}};
  for (int i = 0; i < 3; ++i) {
    box.half_m[i] = at.length(b.half[i]);
    for (int k = 0; k < 3; ++k) box.axes(k, i) = std::ldexp(static_cast<double>(b.axes[i][k]), -b.shift);
  }
  return box;
}
inline Ray placed(const RayInput& r, const Placing& at) {
  Ray ray{at.point(r.origin), {}};
  for (int k = 0; k < 3; ++k) ray.direction[k] = static_cast<double>(r.direction[k]);
  if (r.length >= 0) ray.length_m = at.length(r.length);
  return ray;
}

inline GridPoint operator+(const GridPoint& a, const GridPoint& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline GridPoint operator-(const GridPoint& a, const GridPoint& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline GridPoint operator*(std::int64_t s, const GridPoint& a) { return {s * a[0], s * a[1], s * a[2]}; }

/// What inputs look like.
/// random    anywhere, never touching
/// lattice   0 to 4: coplanar, collinear, equal, without area
/// touching  aimed at an edge, vertex or surface, and beside it by one step of the grid
/// needle    aspect up to 2^bits
/// far       touching, 2^30 to 2^49 steps from the origin, and scaled by 2^-1074 to 2^970
/// fine      touching, with mantissas of up to 50 bits
enum class Family { random, lattice, touching, needle, far, fine };
inline constexpr Family kAllFamilies[] = {Family::random, Family::lattice, Family::touching,
                                          Family::needle, Family::far,     Family::fine};
inline const char* name(Family f) {
  static constexpr const char* kNames[] = {"random", "lattice", "touching", "needle", "far", "fine"};
  return kNames[static_cast<int>(f)];
}

/// Makes the whole numbers of one family.
class Maker {
 public:
  Maker(std::mt19937_64& generator, Family family) : generator_(generator), family_(family) {
    bits_ = family == Family::fine ? 47 : 21;
  }

  Family family() const { return family_; }
  bool aims() const { return family_ != Family::random && family_ != Family::lattice; }

  /// Uniform in [low, high].
  std::int64_t whole(std::int64_t low, std::int64_t high) {
    const auto range = static_cast<std::uint64_t>(high - low) + 1;
    const Unsigned128 wide = static_cast<Unsigned128>(generator_()) * range;
    return low + static_cast<std::int64_t>(static_cast<std::uint64_t>(wide >> 64));
  }
  std::int64_t coordinate() {
    if (family_ == Family::lattice) return whole(0, 4);
    const std::int64_t reach = std::int64_t{1} << bits_;
    return whole(-reach, reach);
  }
  GridPoint point() { return {coordinate(), coordinate(), coordinate()}; }
  /// One step of the grid aside, or none.
  std::int64_t nudge() { return whole(-1, 1); }
  GridPoint nudged() { return {nudge(), nudge(), nudge()}; }
  GridPoint summand(const GridPoint& p) { return {p[0] + nudge(), p[1] + nudge(), p[2] + nudge()}; }
  /// The difference of two points, the first made first: compilers choose the order within an expression.
  GridPoint step() {
    const GridPoint to = point();
    const GridPoint from = point();
    return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
  }
  std::int64_t size() {
    if (family_ == Family::lattice) return whole(0, 3);
    return whole(0, std::int64_t{1} << (bits_ - (whole(0, 3) == 0 ? 4 : 0)));
  }

  TriangleInput triangle() {
    if (family_ == Family::lattice || family_ == Family::random) return {point(), point(), point()};
    const GridPoint a = point();
    // Edges are multiples of 8, so that points of the triangle are on the grid too.
    const GridPoint u = eighth(point());
    const GridPoint v = family_ == Family::needle ? u + nudged() : eighth(point());
    return {a, a + 8 * u, a + 8 * v};
  }
  /// On the triangle: a corner, on an edge, or inside.
  GridPoint on(const TriangleInput& t) {
    const std::int64_t i = whole(0, 8);
    const std::int64_t j = whole(0, 2) == 0 ? 0 : whole(0, 8 - i);
    const GridPoint u = t.b - t.a;
    const GridPoint v = t.c - t.a;
    GridPoint p = t.a;
    for (int k = 0; k < 3; ++k) p[k] += (i * u[k] + j * v[k]) / 8;
    return p;
  }

  BallInput ball() { return {point(), size()}; }
  PillInput pill() {
    const GridPoint a = point();
    if (family_ != Family::needle) return {a, point(), size()};
    return {a, a + 8 * eighth(point()), whole(0, 3)};
  }

  BoxInput box() {
    BoxInput b{point(), {size(), size(), size()}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 0};
    const std::int64_t kind = whole(0, 3);
    if (family_ == Family::needle) b.half[static_cast<std::size_t>(whole(0, 2))] = whole(0, 2);
    if (kind == 1) return b;
    if (kind == 2) {
      b.axes = {{{3, 4, 0}, {-4, 3, 0}, {0, 0, 5}}};  // a turn and a size of 5/4
      b.shift = 2;
      return b;
    }
    // A random turn, rounded to the grid: nearly but not quite perpendicular, as after any rotation in double.
    b.shift = family_ == Family::lattice ? 3 : family_ == Family::fine ? 20 : 8;
    const std::array<double, 4> q{normal(), normal(), normal(), normal()};
    const Mat3 turn = Quat(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) b.axes[i][k] = std::llround(std::ldexp(turn(k, i), b.shift));
    }
    return b;
  }
  /// In a box: mostly a corner, else the middle of an edge or face; rounded to the grid for a turned box.
  GridPoint on(const BoxInput& b) {
    GridPoint p = b.center;
    for (int i = 0; i < 3; ++i) {
      const std::int64_t side = whole(0, 3) == 0 ? whole(-1, 1) : 2 * whole(0, 1) - 1;
      for (int k = 0; k < 3; ++k) {
        p[k] +=
            static_cast<std::int64_t>(static_cast<Int128>(side * b.half[i]) * b.axes[i][k] / (Int128{1} << b.shift));
      }
    }
    return p;
  }
  GridPoint on(const PillInput& c) {
    const std::int64_t i = whole(0, 8);
    GridPoint p = c.a;
    for (int k = 0; k < 3; ++k) p[k] += i * (c.b[k] - c.a[k]) / 8;
    return p;
  }

  Placing placing() {
    Placing at;
    if (family_ != Family::far) return at;
    for (std::int64_t& x : at.offset) x = whole(0, 4) == 0 ? 0 : std::int64_t{1} << whole(30, 49);
    if (whole(0, 1) == 0) at.power = static_cast<int>(whole(-300, 300));
    if (whole(0, 9) == 0) at.power = whole(0, 1) == 0 ? -1074 : 970;  // denormals; products beyond the range
    return at;
  }

  std::mt19937_64& generator() { return generator_; }

 private:
  GridPoint eighth(const GridPoint& p) const { return {p[0] / 8, p[1] / 8, p[2] / 8}; }
  double normal() { return std::normal_distribution<double>()(generator_); }

  std::mt19937_64& generator_;
  Family family_;
  int bits_;
};

/// A radius that the squared distance makes touch, miss or overlap by at most one step of the grid.
inline std::int64_t touching_radius(Maker& make, double squared_distance) {
  const auto near = static_cast<std::int64_t>(std::sqrt(squared_distance));
  return std::max<std::int64_t>(0, near + make.nudge());
}

}  // namespace collided::census
