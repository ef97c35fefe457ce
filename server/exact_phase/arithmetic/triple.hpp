#pragma once

#include <algorithm>
#include <cmath>

#include "server/geometry/vector.hpp"

namespace collided::engine::kernel {

/// Three doubles in registers, for the filters: Eigen's vectors of three go through memory here, and these are the
/// innermost loops. The error bounds in tolerance.hpp assume this order of operations.
struct Triple {
  double x;
  double y;
  double z;

  Triple operator-(const Triple& o) const { return {x - o.x, y - o.y, z - o.z}; }
  /// The largest absolute coordinate.
  double largest() const { return std::max({std::abs(x), std::abs(y), std::abs(z)}); }
};

inline Triple triple(const Vec3& v) { return {v[0], v[1], v[2]}; }
inline double dot(const Triple& a, const Triple& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
inline Triple cross(const Triple& a, const Triple& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace collided::engine::kernel
