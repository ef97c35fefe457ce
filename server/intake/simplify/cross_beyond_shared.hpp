#pragma once

#include <array>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/orientation.hpp"

namespace collided::engine {

/// Whether two triangles of one mesh have a point in common besides the corners and edges that they share by number.
/// For triangles that share an edge that is so when they fold onto each other; for triangles with the same three
/// corners always.
///
/// returns  exact, except: true where the exact arithmetic exceeds the range of double, and for most triangles without
///          area
/// threads  pure; no allocation
bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleCorners& one, const TriangleCorners& other);

/// One triangle of a mesh, prepared for comparison with many others: its plane and, projected along the axis in which
/// it appears largest, its sides. Most other triangles lie beyond the plane or one of the three sides, which is quick
/// to see.
class TriangleSides {
 public:
  TriangleSides(const std::vector<Vec3>& vertices, const TriangleCorners& corners);

  /// True: the two have in common only what they share, since the corners of the other that are not shared lie strictly
  /// on one side of the plane, or beyond a side of this triangle that all shared corners lie on. False: not known.
  bool keep_apart(const std::vector<Vec3>& vertices, const TriangleCorners& other) const;

  const TriangleCorners& corners() const { return corners_; }

 private:
  /// The corners of the other triangle that are not shared, and a bit for each of this one's that is.
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
  std::array<std::array<double, 2>, 3> from_;   // where each side begins
  std::array<std::array<double, 2>, 3> along_;  // its direction; the triangle is to the left
};

/// The same for one triangle compared with many others.
bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleSides& one, const TriangleCorners& other);

}  // namespace collided::engine
