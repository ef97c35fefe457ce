#pragma once

#include <gmpxx.h>

#include <array>
#include <random>
#include <vector>

#include "server/exact_phase/solid/surface_crossing.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"

namespace collided::oracle {
using namespace engine;

/// A point of rational coordinates.
using RationalPoint = std::array<mpq_class, 3>;
RationalPoint rational(const Vec3& point);
/// Seen from a pose: q* (point - position) q / |q|^2.
RationalPoint seen_from(const Pose& pose, const Vec3& point);

/// Where a point is relative to a closed mesh, in rationals and without an index: rays in random directions, each of
/// which is dropped where it meets an edge. So it shares neither arithmetic nor rules for ties with side_by_ray.
///
/// cost  some microseconds a triangle
class SolidOracle {
 public:
  explicit SolidOracle(const TriangleMesh& mesh);
  SolidSide side(const RationalPoint& point, std::mt19937_64& random) const;

 private:
  using Integers = std::array<mpz_class, 3>;

  std::vector<TriangleCorners> triangles_;
  std::vector<Integers> vertices_;  // times 2^shift_
  unsigned long shift_ = 0;
};

}  // namespace collided::oracle
