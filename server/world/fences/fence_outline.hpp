#pragma once

#include <vector>

#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Points connected by lines in order.
using Polyline = std::vector<Vec3>;

/// Lines that show a fence in pictures: the edges of boxes and meshes, circles of round shapes, a square of 20 m for a
/// half-space. In the fence's frame, metres.
///
/// beyond_m  distance of a band; its lines are on the surface of the grown body if that is one ball, box, capsule,
///           cylinder or half-space, else on a box with round edges that contains the band
/// threads   pure
std::vector<Polyline> outline_of(const ObjectInfo& body, double beyond_m);

}  // namespace collided::engine
