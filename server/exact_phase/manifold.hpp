#pragma once

#include <cstdint>
#include <vector>

#include "server/exact_phase/part.hpp"

namespace collided::engine {

/// A point that carries a contact, halfway between the two surfaces.
/// depth_m: how far the surfaces overlap there along the contact's normal, |truth - depth_m| <= depth_error_m. The
/// surface of a part is the flat or straight feature that faces the other part: a face, an edge, a rim's disc, a line
/// on the side, a tip. For two triangles: the shortest translation that separates them.
struct ManifoldPoint {
  Vec3 point = Vec3::Zero();
  double depth_m = 0;
  double depth_error_m = 0;
  std::uint32_t a_triangle = 0xffffffff;
  std::uint32_t b_triangle = 0xffffffff;
};

/// Appends the points at which two overlapping parts touch along the normal (unit, from a to b): the corners of what
/// their facing features share, seen along the normal, that lie within both; only `contact` if the features share at
/// most a point. Typical counts: face on face up to eight and more, edge on face 2, corner on face 1, edge across edge
/// 1.
///
/// threads  pure
/// source   clipping of the facing polygons: Sutherland, Hodgman, "Reentrant Polygon Clipping", 1974
void append_manifold(const ConvexPart& a, const ConvexPart& b, const Contact& contact, const Vec3& normal,
                     std::vector<ManifoldPoint>& points);

/// Keeps at most four points, in this order: the deepest, the farthest from it, the farthest from the line through
/// both, and the farthest from that line on its other side; ties go to the smaller coordinates. Points that differ only
/// by rounding count once.
void keep_extremes(const Vec3& normal, std::vector<ManifoldPoint>& points);

}  // namespace collided::engine
