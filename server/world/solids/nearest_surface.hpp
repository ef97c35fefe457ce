#pragma once

#include <optional>

#include "server/world/solids/solid.hpp"

namespace collided::engine {

/// The nearest point of a solid's surface.
struct NearestSurface {
  double distance_m = 0;
  double error_m = 0;  // infinite where the mesh is more than the border of the solid
  std::uint32_t triangle = kNoTriangle;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // unit, from the point asked about towards the surface; zero on it
};

/// Nothing where the deadline ends the search.
///
/// tests  grows by the triangles looked at
std::optional<NearestSurface> nearest_surface(const SolidMesh& solid, const Placed& object, const Vec3& point,
                                              Deadline& deadline, WalkCost& cost, std::uint32_t& tests);

/// The same for any mesh, as it is.
std::optional<NearestSurface> nearest_surface(const IndexedMesh& surface, const Placed& object, const Vec3& point,
                                              Deadline& deadline, WalkCost& cost, std::uint32_t& tests);

/// How far a thing that lies in a solid without meeting its surface must be moved to leave it: no motion shorter than
/// `least` parts the two, and some motion of `most` does. Metres.
struct WayOut {
  double least_m = 0;
  double most_m = 0;
};

/// Of an object in a solid, by the nearest surface from a point of it. The most is that along an axis of the world, an
/// axis of the solid or the way to the surface, whichever parts the bounds of the two soonest: the truth for balls and
/// boxes in boxes, more for other shapes.
///
/// inscribed_m  the ball of this radius about the point is part of the object
/// inner        bounds of the object
WayOut way_out(const SolidMesh& solid, const Placed& object, const NearestSurface& nearest, double inscribed_m,
               const Aabb& inner);

/// The contact of something in a solid, as deep as the least way out; normal from the thing to the solid.
Contact contact_inside(const NearestSurface& nearest, const WayOut& way);

}  // namespace collided::engine
