#pragma once

#include <cstdint>
#include <vector>

#include "server/exact_phase/part.hpp"

namespace collided::engine {

/// A point that carries a contact, in the middle between the two surfaces.
/// depth_m: how far they overlap there along the contact's normal, |truth - depth_m| <= depth_error_m, where each surface
/// is the flat or straight feature that the part turns towards the other: a face, an edge, a rim's disc, a side's line, a
/// tip. Of two triangles: the shortest way that parts the two.
struct ManifoldPoint {
  Vec3 point = Vec3::Zero();
  double depth_m = 0;
  double depth_error_m = 0;
  std::uint32_t a_triangle = 0xffffffff;
  std::uint32_t b_triangle = 0xffffffff;
};

/// Appends the points in which two overlapping parts bear on each other along the normal (unit, from a to b): the corners
/// of what their features share, seen along it, that lie within both; `contact` where the features share no more than a
/// point. Kinds: face on face up to eight and more, edge on face 2, corner on face 1, edge across edge 1.
///
/// threads  pure
/// source   clipping of the facing polygons: Sutherland, Hodgman, "Reentrant Polygon Clipping", 1974
void append_manifold(const ConvexPart& a, const ConvexPart& b, const Contact& contact, const Vec3& normal,
                     std::vector<ManifoldPoint>& points);

/// At most four of them, in this order: the deepest, the farthest from it, the farthest from their line, and the farthest
/// from that on the line's other side; ties go to the lesser coordinates. Points that are one but for rounding count
/// once.
void keep_extremes(const Vec3& normal, std::vector<ManifoldPoint>& points);

}  // namespace collided::engine
