#pragma once

#include <array>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/orientation.hpp"

namespace collided::engine {

/// Whether two triangles of one mesh have a point in common that is none of the corners or edges they share by number.
/// Triangles that share an edge do when they fold onto each other, those with the same three corners always.
///
/// returns  exact; true as well where exact arithmetic in double has no room, and for most triangles without area
/// threads  pure; no allocation
bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleCorners& one, const TriangleCorners& other);

/// One triangle of a mesh made ready to be asked about against many others: its plane and, seen along the axis that it is
/// widest in, its sides. Most others lie beyond one of the four.
class TriangleSides {
 public:
  TriangleSides(const std::vector<Vec3>& vertices, const TriangleCorners& corners);

  /// All corners of the other that are not shared lie strictly on one side of the plane, or beyond one side of the
  /// triangle that what is shared lies on: they have in common what they share. False: that is not sure.
  bool keep_apart(const std::vector<Vec3>& vertices, const TriangleCorners& other) const;

  const TriangleCorners& corners() const { return corners_; }

 private:
  /// The corners of the other that are not shared, and a bit for each of one's own that is.
  struct Rest {
    std::array<const Vec3*, 3> points;
    std::size_t count = 0;
    unsigned shared = 0;
  };
  Rest rest_of(const std::vector<Vec3>& vertices, const TriangleCorners& other) const;
  bool is_beyond(std::size_t side, const Rest& rest) const;

  TriangleCorners corners_;
  OrientedPlane plane_;
  int u_ = 0;  // the coordinates that are seen
  int v_ = 1;
  bool has_sides_ = false;                      // it is seen with area, for certain
  std::array<std::array<double, 2>, 3> from_;   // each side's begin
  std::array<std::array<double, 2>, 3> along_;  // and its way, turned so that the triangle lies to the left
};

/// The same for a triangle asked about against many others.
bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleSides& one, const TriangleCorners& other);

}  // namespace collided::engine
