#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace collided::oracle {

using Whole = std::int64_t;
using WholeVector = std::array<Whole, 3>;

inline Whole dot(const WholeVector& a, const WholeVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// A convex solid of whole numbers: the points x with normal . x <= reach for each of its planes. A box, a k-DOP and a
/// frustum are such solids; a slab is two planes with opposite normals.
struct WholeSolid {
  struct Plane {
    WholeVector normal;
    Whole reach;
  };
  std::vector<Plane> planes;

  bool holds(const WholeVector& point) const {
    for (const Plane& plane : planes) {
      if (dot(plane.normal, point) > plane.reach) return false;
    }
    return true;
  }

  /// Every whole point in which three planes meet and that the solid holds: its corners, where they are whole.
  std::vector<WholeVector> whole_corners() const {
    std::vector<WholeVector> corners;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t k = 0; k < j; ++k) {
          const auto corner = meeting(planes[i], planes[j], planes[k]);
          if (corner && holds(*corner)) corners.push_back(*corner);
        }
      }
    }
    return corners;
  }

 private:
  static Whole det(const WholeVector& a, const WholeVector& b, const WholeVector& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  /// Cramer's rule; nothing where they meet in no point, or in one that is not whole.
  static std::optional<WholeVector> meeting(const Plane& a, const Plane& b, const Plane& c) {
    const Whole below = det(a.normal, b.normal, c.normal);
    if (below == 0) return std::nullopt;
    WholeVector corner;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<WholeVector, 3> rows{a.normal, b.normal, c.normal};
      rows[0][axis] = a.reach, rows[1][axis] = b.reach, rows[2][axis] = c.reach;
      const Whole above = det(rows[0], rows[1], rows[2]);
      if (above % below != 0) return std::nullopt;
      corner[axis] = above / below;
    }
    return corner;
  }
};

/// The quotient of whole numbers, its denominator positive.
struct WholeQuotient {
  Whole above = 0;
  Whole below = 1;
  friend bool operator<(const WholeQuotient& p, const WholeQuotient& q) {
    return p.above * q.below < q.above * p.below;
  }
};

/// Kay and Kajiya's slabs: of all planes that the ray enters by the last one, before the first by which it leaves. The
/// parameter of the entry, 0 for a start inside, or nothing.
inline std::optional<WholeQuotient> slab_entry(const WholeSolid& solid, const WholeVector& origin,
                                               const WholeVector& direction) {
  WholeQuotient enter;
  std::optional<WholeQuotient> leave;
  for (const WholeSolid::Plane& plane : solid.planes) {
    const Whole ahead = dot(plane.normal, origin) - plane.reach;  // > 0: outside
    const Whole slope = dot(plane.normal, direction);
    if (slope == 0) {
      if (ahead > 0) return std::nullopt;
      continue;
    }
    const WholeQuotient at{slope < 0 ? ahead : -ahead, slope < 0 ? -slope : slope};
    if (slope < 0 && enter < at) enter = at;
    if (slope > 0 && (!leave || at < *leave)) leave = at;
  }
  if (leave && *leave < enter) return std::nullopt;
  return enter;
}

}  // namespace collided::oracle
