#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/arithmetic/dyadic.hpp"
#include "server/exact_phase/arithmetic/number.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

// The signs that compare points with closed surfaces, for two representations of points. All are exact for every finite
// input: double with an error bound first, then expansions, then rationals.

/// A point whose coordinates are doubles, in the frame of the surface.
/// threads  one: it counts the arithmetic that it needed
class PlainPoint {
 public:
  explicit PlainPoint(const Vec3& at) : at_(at) {}

  /// The sign of coordinate - point[axis].
  int beyond(double coordinate, int axis) const { return coordinate > at_[axis] ? 1 : coordinate < at_[axis] ? -1 : 0; }
  /// Seen against the axis: 1 if the point lies left of the line from u to v, 0 on the line.
  int turn(const Vec3& u, const Vec3& v, int axis);
  /// 1 on the side of the triangle's plane from which its corners turn left, 0 in the plane.
  int height(const Triangle& triangle);
  Level level() const { return level_; }

 private:
  Vec3 at_;
  Level level_ = Level::filter;
};

/// A point whose coordinates are quotients: at / weight, weight > 0, such as the result of a pose's exact rotation.
/// cost     some microseconds per sign; allocates
class QuotientPoint {
 public:
  QuotientPoint(kernel::Vector<Dyadic> at, Dyadic weight) : at_(std::move(at)), weight_(std::move(weight)) {}

  int beyond(double coordinate, int axis) const;
  int turn(const Vec3& u, const Vec3& v, int axis) const;
  int height(const Triangle& triangle) const;
  static constexpr Level level() { return Level::rational; }

 private:
  const Dyadic& along(int axis) const { return axis == 0 ? at_.x : axis == 1 ? at_.y : at_.z; }

  kernel::Vector<Dyadic> at_;
  Dyadic weight_;
};

}  // namespace collided::engine
