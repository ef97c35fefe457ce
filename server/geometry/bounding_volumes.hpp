#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

// Volumes about points. Each contains every point exactly: what is computed is rounded outward. Points must be finite.

/// One pass.
Aabb bounding_aabb(std::span<const Vec3> points);

/// {x : low[i] <= normals[i] . x <= high[i]}. The normals have any length but 0. Empty while some low > high.
struct Kdop {
  std::vector<Vec3> normals;
  std::vector<double> low;
  std::vector<double> high;
};

/// The axes of the k-DOP of 6, 14 (and corners), 18 (and edges) or 26 (and both) sides; components 0, 1 and -1.
/// throws  std::invalid_argument for another k
std::vector<Vec3> kdop_normals(int sides);

/// The least k-DOP with those normals, in one pass: exactly the least where the products are exact, as for 6 sides, which is
/// the box bit for bit; else wider by a few roundings.
Kdop bounding_kdop(std::span<const Vec3> points, const std::vector<Vec3>& normals);

/// Whether the point is in all the slabs: exact, or nothing where exact arithmetic in double has no room.
std::optional<bool> contains(const Kdop& kdop, const Vec3& point);

/// The volume of a k-DOP that its first three normals bound; relative error about 1e-12. For tables, not for decisions.
double volume(const Kdop& kdop);
double volume(const Aabb& box);
double volume(const Box& box);
double volume(const Sphere& sphere);

/// A box along the axes of inertia of the points, or along the coordinate axes where that one is smaller. Its axes are of
/// length 1 and at right angles within 1e-14; the half lengths make up for what is missing, so that each point is
/// center + sum_i u_i half_i axis_i with |u_i| <= 1.
/// source  Gottschalk, Lin, Manocha, "OBBTree", 1996
Box bounding_obb(std::span<const Vec3> points);

/// The three spheres of the course: about the middle of the box with half its diagonal; about the same middle through the
/// farthest point; the smallest one, up to roundings. Each is no larger than the one before.
/// source  smallest: Gaertner, "Fast and robust smallest enclosing balls", 1999 (farthest point first)
Sphere diagonal_sphere(std::span<const Vec3> points);
Sphere farthest_point_sphere(std::span<const Vec3> points);
Sphere smallest_sphere(std::span<const Vec3> points);
/// The smallest one about that centre.
Sphere sphere_about(std::span<const Vec3> points, const Vec3& center);

}  // namespace collided::engine
