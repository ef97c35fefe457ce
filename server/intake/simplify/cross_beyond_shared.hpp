#pragma once

#include <array>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/orientation.hpp"

namespace collided::engine {

/// Whether two triangles of one mesh have a point in common besides the corners and edges that they share by number.
/// Triangles that share an edge do if they fold onto each other; triangles with the same three corners always do.
///
/// returns  exact, except: true if the exact arithmetic exceeds the range of double, and for most triangles without
///          area
/// threads  pure; no allocation
bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleCorners& one, const TriangleCorners& other);

/// One triangle of a mesh, prepared for comparison with many others: its plane and, projected along the axis in which
/// it appears largest, its sides. Most other triangles lie beyond the plane or one of the three sides, which is a quick
/// test.
class TriangleSides {
 public:
  TriangleSides(const std::vector<Vec3>& vertices, const TriangleCorners& corners);

  /// True if the two have only their shared part in common, since the unshared corners of the other lie strictly on one
  /// side of the plane, or beyond a side of this triangle that contains all shared corners. False: unknown.
  bool keep_apart(const std::vector<Vec3>& vertices, const TriangleCorners& other) const;

  const TriangleCorners& corners() const { return corners_; }

 private:
  /// The unshared corners of the other triangle, and a bit for each shared corner of this one.
  struct Rest {
    std::array<const Vec3*, 3> points;
    std::size_t count = 0;
    unsigned shared = 0;
  };
  Rest rest_of(const std::vector<Vec3>& vertices, const TriangleCorners& other) const;
  bool is_beyond(std::size_t side, const Rest& rest) const;

  TriangleCorners corners_;
  OrientedPlane plane_;
  int u_ = 0;  // the two coordinates left by the projection
  int v_ = 1;
  bool has_sides_ = false;                      // its projection certainly has an area
  std::array<std::array<double, 2>, 3> from_;   // start of each side
  std::array<std::array<double, 2>, 3> along_;  // its direction; the triangle is to the left
};

/// Compares one triangle with many others.
bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleSides& one, const TriangleCorners& other);

}  // namespace collided::engine
