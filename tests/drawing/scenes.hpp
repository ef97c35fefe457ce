#pragma once

#include <string>
#include <vector>

#include <collided/client.hpp>

namespace collided::drawing_test {

/// Twelve triangles, outward, about the origin.
MeshShape cube(double half_m);
/// Without its lid.
MeshShape open_box(double half_m);
/// Quads in two triangles each, about the z axis; smooth but for its count of sides.
MeshShape torus(double ring_m, double tube_m, int around, int along);
MeshShape sphere(double radius_m, int latitudes, int longitudes);

}  // namespace collided::drawing_test
