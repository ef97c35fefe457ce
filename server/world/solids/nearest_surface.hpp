#pragma once

#include <optional>

#include "server/world/solids/solid.hpp"

namespace collided::engine {

/// The nearest point of a solid's surface.
struct NearestSurface {
  double distance_m = 0;
  double error_m = 0;  // infinite if the mesh is more than the border of the solid
  std::uint32_t triangle = kNoTriangle;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // unit, from the given point towards the surface; zero on it
};

/// Nothing if the deadline ends the search.
///
/// tests  grows by the triangles tested
std::optional<NearestSurface> nearest_surface(const SolidMesh& solid, const Placed& object, const Vec3& point,
                                              Deadline& deadline, WalkCost& cost, std::uint32_t& tests);

/// Finds the nearest point of any mesh, taken as a surface.
std::optional<NearestSurface> nearest_surface(const IndexedMesh& surface, const Placed& object, const Vec3& point,
                                              Deadline& deadline, WalkCost& cost, std::uint32_t& tests);

/// How far an object that lies in a solid without meeting its surface must be moved to leave it: no motion shorter than
/// `least` separates the two, and some motion of `most` does. Metres.
struct WayOut {
  double least_m = 0;
  double most_m = 0;
};

/// The way out of an object in a solid, from the surface nearest to one of its points. `most` is along an axis of the
/// world, an axis of the solid or the direction to the surface, whichever separates the bounds soonest: exact for balls
/// and boxes in boxes, more for other shapes.
///
/// inscribed_m  the ball of this radius around the point is part of the object
/// inner        bounds of the object
WayOut way_out(const SolidMesh& solid, const Placed& object, const NearestSurface& nearest, double inscribed_m,
               const Aabb& inner);

/// The contact of an object in a solid, as deep as the shortest way out; normal from the object to the solid.
Contact contact_inside(const NearestSurface& nearest, const WayOut& way);

}  // namespace collided::engine
