#pragma once

#include "server/geometry/vector.hpp"

namespace collided::engine {

/// The weighted sum of a point's squared distances to planes, as a quadratic function of the point.
/// source  Garland, Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997
struct Quadric {
  Vec3 squares = Vec3::Zero();  // xx, yy, zz
  Vec3 mixed = Vec3::Zero();    // xy, yz, zx
  Vec3 linear = Vec3::Zero();
  double constant = 0;

  /// The plane {x : normal . x + offset = 0}; the normal is of unit length.
  void add_plane(const Vec3& normal, double offset, double weight) {
    squares += weight * normal.cwiseProduct(normal);
    mixed += weight * normal.cwiseProduct(Vec3(normal[1], normal[2], normal[0]));
    linear += weight * offset * normal;
    constant += weight * offset * offset;
  }
  void add(const Quadric& more) {
    squares += more.squares;
    mixed += more.mixed;
    linear += more.linear;
    constant += more.constant;
  }
  /// The sum for this point.
  double at(const Vec3& p) const {
    const Vec3 next(p[1], p[2], p[0]);
    return p.cwiseProduct(p).dot(squares) + 2 * (p.cwiseProduct(next).dot(mixed) + p.dot(linear)) + constant;
  }
};

}  // namespace collided::engine
