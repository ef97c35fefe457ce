#include "server/intake/simplify/cross_beyond_shared.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "server/geometry/orientation.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/intake/polygons/planar.hpp"

namespace collided::engine {
namespace {

using Points = std::array<Vec3, 3>;
using Sides = std::array<std::optional<int>, 3>;

/// The same triangle, beginning with another corner.
TriangleCorners turned(const TriangleCorners& corners, std::size_t first) {
  return {corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]};
}

Points points_of(const std::vector<Vec3>& vertices, const TriangleCorners& corners) {
  return {vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]};
}

/// The axis along which the plane's normal is largest: without it, points in the plane stay distinct.
int axis_to_drop(const Points& plane) {
  int axis = 0;
  const Vec3 normal = (plane[1] - plane[0]).cross(plane[2] - plane[0]);
  normal.cwiseAbs().maxCoeff(&axis);
  return axis;
}

PlanePoint seen_along(const Vec3& point, int axis) { return {point[(axis + 1) % 3], point[(axis + 2) % 3]}; }

/// Whether all of the others lie strictly on the far side of the line ab from c. False if c is on the line.
template <std::size_t count>
bool parts(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const std::array<PlanePoint, count>& others) {
  const int inside = turn(a, b, c);
  if (inside == 0) return false;
  for (const PlanePoint& p : others) {
    if (turn(a, b, p) != -inside) return false;
  }
  return true;
}

/// Whether two triangles in one plane, whose first `shared` corners (0 or 1) are the same, have nothing else in common.
/// That is so exactly if the line of some edge separates them; with a shared corner, the line goes through it.
template <std::size_t shared>
bool are_apart_in_plane(const Points& one, const Points& other) {
  const int axis = axis_to_drop(one);
  const auto flat = [axis](const Points& points) {
    return std::array{seen_along(points[0], axis), seen_along(points[1], axis), seen_along(points[2], axis)};
  };
  const auto split_by = [](const std::array<PlanePoint, 3>& edges_of, const std::array<PlanePoint, 3>& rest) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (shared == 1 && i == 1) continue;  // the edge that the corner is not on
      std::array<PlanePoint, 3 - shared> others;
      for (std::size_t k = shared; k < 3; ++k) others[k - shared] = rest[k];
      if (parts(edges_of[i], edges_of[(i + 1) % 3], edges_of[(i + 2) % 3], others)) return true;
    }
    return false;
  };
  const auto a = flat(one);
  const auto b = flat(other);
  return split_by(a, b) || split_by(b, a);
}

Sides sides_of(const OrientedPlane& plane, const Points& points) {
  return {plane.side(points[0]), plane.side(points[1]), plane.side(points[2])};
}

bool is_known(const Sides& sides) { return sides[0] && sides[1] && sides[2]; }

/// Whether the line through p and q, which is not parallel to the triangle, meets it; touching counts.
bool line_goes_through(const Vec3& p, const Vec3& q, const Points& triangle) {
  bool left = false;
  bool right = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<int> side = orientation(p, q, triangle[i], triangle[(i + 1) % 3]);
    if (!side) return true;
    left = left || *side > 0;
    right = right || *side < 0;
  }
  return !(left && right);
}

/// Whether the segment pq, whose ends have these sides of the triangle's plane (not both 0), meets the triangle.
bool meets(const Vec3& p, const Vec3& q, int side_p, int side_q, const Points& triangle) {
  return side_p * side_q <= 0 && line_goes_through(p, q, triangle);
}

bool share_nothing_and_meet(const Points& one, const Points& other) {
  const Sides of_other = sides_of(OrientedPlane(one[0], one[1], one[2]), other);
  if (!is_known(of_other)) return true;
  if (*of_other[0] == *of_other[1] && *of_other[1] == *of_other[2]) {
    return *of_other[0] == 0 && !are_apart_in_plane<0>(one, other);
  }
  const Sides of_one = sides_of(OrientedPlane(other[0], other[1], other[2]), one);
  if (!is_known(of_one)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    // Edges that lie in the other triangle's plane are left out: if one of them meets the other triangle, so does
    // another edge of the two that crosses the plane, and that one is tested.
    if ((*of_one[i] != 0 || *of_one[j] != 0) && meets(one[i], one[j], *of_one[i], *of_one[j], other)) return true;
    if ((*of_other[i] != 0 || *of_other[j] != 0) && meets(other[i], other[j], *of_other[i], *of_other[j], one))
      return true;
  }
  return false;
}

/// For triangles that share corner 0. Their common part is convex, so if it exceeds the corner, the edge opposite the
/// corner in one triangle meets the other.
bool share_corner_and_meet(const Points& one, const Points& other) {
  const OrientedPlane plane(one[0], one[1], one[2]);
  const std::optional<int> side_1 = plane.side(other[1]);
  const std::optional<int> side_2 = plane.side(other[2]);
  if (!side_1 || !side_2) return true;
  if (*side_1 == 0 && *side_2 == 0) return !are_apart_in_plane<1>(one, other);
  if (meets(other[1], other[2], *side_1, *side_2, one)) return true;
  const OrientedPlane other_plane(other[0], other[1], other[2]);
  const std::optional<int> one_1 = other_plane.side(one[1]);
  const std::optional<int> one_2 = other_plane.side(one[2]);
  if (!one_1 || !one_2) return true;
  return (*one_1 != 0 || *one_2 != 0) && meets(one[1], one[2], *one_1, *one_2, other);
}

/// For triangles that share the edge of corners 0 and 1: whether they lie on each other.
bool share_edge_and_fold(const Points& one, const Vec3& other_tip) {
  const std::optional<int> side = orientation(one[0], one[1], one[2], other_tip);
  if (!side) return true;
  if (*side != 0) return false;
  const int axis = axis_to_drop(one);
  const PlanePoint a = seen_along(one[0], axis);
  const PlanePoint b = seen_along(one[1], axis);
  return !parts(a, b, seen_along(one[2], axis), std::array<PlanePoint, 1>{seen_along(other_tip, axis)});
}

}  // namespace

TriangleSides::TriangleSides(const std::vector<Vec3>& vertices, const TriangleCorners& corners)
    : corners_(corners), plane_(vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]) {
  const Points points = points_of(vertices, corners);
  const int axis = axis_to_drop(points);
  u_ = (axis + 1) % 3;
  v_ = (axis + 2) % 3;
  for (std::size_t i = 0; i < 3; ++i) from_[i] = seen_along(points[i], axis);
  const int inside = turn(from_[0], from_[1], from_[2]);
  has_sides_ = inside != 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const PlanePoint& to = from_[(i + 1) % 3];
    along_[i] = {inside * (to[0] - from_[i][0]), inside * (to[1] - from_[i][1])};
  }
}

TriangleSides::Rest TriangleSides::rest_of(const std::vector<Vec3>& vertices, const TriangleCorners& other) const {
  Rest rest;
  for (const std::uint32_t corner : other) {
    const unsigned equal =
        (corner == corners_[0] ? 1u : 0u) | (corner == corners_[1] ? 2u : 0u) | (corner == corners_[2] ? 4u : 0u);
    rest.shared |= equal;
    rest.points[rest.count] = &vertices[corner];
    rest.count += equal == 0 ? 1 : 0;
  }
  return rest;
}

/// The filter of turn() with the same error bound, on differences from the beginning of the side.
bool TriangleSides::is_beyond(std::size_t side, const Rest& rest) const {
  for (std::size_t i = 0; i < rest.count; ++i) {
    const double left = along_[side][0] * ((*rest.points[i])[v_] - from_[side][1]);
    const double right = along_[side][1] * ((*rest.points[i])[u_] - from_[side][0]);
    const double bound = kTurnError * (std::abs(left) + std::abs(right)) + std::numeric_limits<double>::min();
    if (!(left - right < -bound)) return false;
  }
  return true;
}

bool TriangleSides::keep_apart(const std::vector<Vec3>& vertices, const TriangleCorners& other) const {
  const Rest rest = rest_of(vertices, other);
  if (rest.count == 0) return false;
  int side_sum = 0;
  for (std::size_t i = 0; i < rest.count; ++i) side_sum += plane_.quick_side(*rest.points[i]);
  if (side_sum == static_cast<int>(rest.count) || side_sum == -static_cast<int>(rest.count)) return true;
  if (!has_sides_) return false;
  // A side runs from corner i to the next.
  constexpr std::array<unsigned, 3> kCornersOfSide{1u | 2u, 2u | 4u, 4u | 1u};
  for (std::size_t i = 0; i < 3; ++i) {
    if ((rest.shared & ~kCornersOfSide[i]) == 0 && is_beyond(i, rest)) return true;
  }
  return false;
}

bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleSides& one, const TriangleCorners& other) {
  return !one.keep_apart(vertices, other) && !TriangleSides(vertices, other).keep_apart(vertices, one.corners()) &&
         cross_beyond_shared(vertices, one.corners(), other);
}

bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleCorners& one, const TriangleCorners& other) {
  std::array<std::pair<std::size_t, std::size_t>, 3> shared;
  std::size_t shared_count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (one[i] == other[k] && shared_count < 3) shared[shared_count++] = {i, k};
    }
  }
  if (shared_count == 3) return true;
  if (shared_count == 0) return share_nothing_and_meet(points_of(vertices, one), points_of(vertices, other));
  if (shared_count == 1) {
    return share_corner_and_meet(points_of(vertices, turned(one, shared[0].first)),
                                 points_of(vertices, turned(other, shared[0].second)));
  }
  const std::size_t tip_of_one = 3 - shared[0].first - shared[1].first;
  const std::size_t tip_of_other = 3 - shared[0].second - shared[1].second;
  return share_edge_and_fold(points_of(vertices, turned(one, (tip_of_one + 1) % 3)), vertices[other[tip_of_other]]);
}

}  // namespace collided::engine
