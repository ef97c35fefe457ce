#pragma once

#include <vector>

#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Points that lines join in order.
using Polyline = std::vector<Vec3>;

/// Lines that show where a fence is, for pictures: the edges of boxes and meshes, circles of what is round, a square of
/// 20 m of a half-space. In the fence's frame, metres.
///
/// beyond_m  of a band: the distance that it has; its lines are then on the surface of the grown body where that is one
///           ball, box, capsule, cylinder or half-space, else on a box with round edges that holds the band
/// threads   pure
std::vector<Polyline> outline_of(const ObjectInfo& body, double beyond_m);

}  // namespace collided::engine
