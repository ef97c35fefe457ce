#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

// Bounding volumes of points. Each contains every point exactly, because all results are rounded outward. Points must
// be finite.

/// In one pass; empty for no points.
Aabb bounding_aabb(std::span<const Vec3> points);

/// A discrete oriented polytope {x : low[i] <= normals[i] . x <= high[i]}. The normals have any length but 0. Empty if
/// some low > high.
struct Kdop {
  std::vector<Vec3> normals;
  std::vector<double> low;
  std::vector<double> high;
};

/// The normals of the k-DOP with 6, 14 (also corners), 18 (also edges) or 26 (both) sides; components are 0, 1 and -1.
/// throws  std::invalid_argument for another k
std::vector<Vec3> kdop_normals(int sides);

/// The smallest k-DOP with those normals, in one pass. Exactly the smallest if the products are exact, as for 6 sides,
/// where it equals the box bit for bit; else wider by a few roundings.
Kdop bounding_kdop(std::span<const Vec3> points, const std::vector<Vec3>& normals);

/// Whether the point is in all slabs: exact, or nothing if exact arithmetic in double runs out of room.
std::optional<bool> contains(const Kdop& kdop, const Vec3& point);

/// The volume of a k-DOP whose first three normals bound it; relative error about 1e-12. For tables, not for decisions.
double volume(const Kdop& kdop);
double volume(const Aabb& box);
double volume(const Box& box);
double volume(const Sphere& sphere);

/// A box along the points' axes of inertia, or along the coordinate axes if that one is smaller. Its axes have length 1
/// and are perpendicular within 1e-14; the half lengths make up for the difference, so that each point is center +
/// sum_i u_i half_i axis_i with |u_i| <= 1.
/// source  Gottschalk, Lin, Manocha, "OBBTree", 1996
Box bounding_obb(std::span<const Vec3> points);

/// Three bounding spheres, each no larger than the one before: around the middle of the box with half its diagonal;
/// around the same centre through the farthest point; the smallest one, up to roundings.
/// source  smallest: Gaertner, "Fast and robust smallest enclosing balls", 1999 (farthest point first)
Sphere diagonal_sphere(std::span<const Vec3> points);
Sphere farthest_point_sphere(std::span<const Vec3> points);
Sphere smallest_sphere(std::span<const Vec3> points);
/// The smallest sphere with that centre.
Sphere sphere_about(std::span<const Vec3> points, const Vec3& center);

}  // namespace collided::engine
