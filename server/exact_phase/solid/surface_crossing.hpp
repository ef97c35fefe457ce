#pragma once

#include <algorithm>
#include <cstdint>

#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// The side of a point relative to a solid: outside, on its surface, or in its interior.
enum class SolidSide : std::uint8_t { out, on, in };

/// How the ray from a point along a coordinate axis passes a triangle.
struct SurfaceCrossing {
  int step = 0;     // 1 out through its front, -1 in through its back, 0 not at all
  bool on = false;  // the point lies in the closed triangle
};

/// One of the six directions along the coordinate axes.
struct AxisDirection {
  int axis = 0;
  int sign = 1;
};

/// Returns how the ray passes the triangle, as if the point were shifted infinitesimally along the axis that follows
/// the ray's, and by an infinitesimally smaller amount along the third. So it never meets an edge, and of the triangles
/// at an edge or a corner of a closed surface it passes exactly as many as a ray beside it. Every sign is that of the
/// unshifted point, or if that is 0, of the shift.
///
/// point   PlainPoint or QuotientPoint
/// source  Edelsbrunner, Muecke, "Simulation of simplicity", ACM Transactions on Graphics 9, 1990
template <class Point>
SurfaceCrossing crossing_of(Point& point, const Triangle& triangle, const AxisDirection& ray) {
  const Vec3* corners[3] = {&triangle.a, &triangle.b, &triangle.c};
  const int third = (ray.axis + 2) % 3;
  bool is_beyond[3];
  for (int k = 0; k < 3; ++k) is_beyond[k] = point.beyond((*corners[k])[third], third) > 0;
  // Seen against the axis: 1 if the corners run left around the shifted point, -1 right, 0 if it is beside them.
  int turns = 0;
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    if (is_beyond[k] == is_beyond[next]) continue;
    const int upward = is_beyond[next] ? 1 : -1;
    if (point.turn(*corners[k], *corners[next], ray.axis) == upward) turns += upward;
  }
  if (turns == 0) return {};
  const int height = point.height(triangle);
  if (height == 0) return {.step = 0, .on = true};
  return {.step = height * turns * ray.sign < 0 ? turns * ray.sign : 0, .on = false};
}

/// Whether the closed triangle contains the point; triangles without area are segments and points.
template <class Point>
bool lies_on(Point& point, const Triangle& triangle) {
  const Vec3* corners[3] = {&triangle.a, &triangle.b, &triangle.c};
  for (int axis = 0; axis < 3; ++axis) {
    bool some_behind = false;
    bool some_beyond = false;
    for (const Vec3* corner : corners) {
      const int side = point.beyond((*corner)[axis], axis);
      some_behind = some_behind || side <= 0;
      some_beyond = some_beyond || side >= 0;
    }
    if (!some_behind || !some_beyond) return false;
  }
  if (point.height(triangle) != 0) return false;
  // A point in the triangle's plane is in the triangle if it is in all three projections.
  for (int axis = 0; axis < 3; ++axis) {
    int least = 0;
    int most = 0;
    for (int k = 0; k < 3; ++k) {
      const int turn = point.turn(*corners[k], *corners[k == 2 ? 0 : k + 1], axis);
      least = std::min(least, turn);
      most = std::max(most, turn);
    }
    if (least < 0 && most > 0) return false;
  }
  return true;
}

}  // namespace collided::engine
