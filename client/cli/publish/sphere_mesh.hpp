#pragma once

#include <array>
#include <cstddef>

#include <collided/client.hpp>

namespace collided::cli {

/// A sphere of `latitudes` bands between its poles and `longitudes` slices: 2 * longitudes * (latitudes - 1) triangles, closed,
/// normals outward, vertices on the sphere. latitudes >= 2, longitudes >= 3.
MeshShape sphere_mesh(double radius_m, std::size_t latitudes, std::size_t longitudes);

struct LatitudeLongitude {
  std::size_t latitudes = 2;
  std::size_t longitudes = 3;
};

/// Bands and slices whose sphere has about so many triangles, cells nearly square: 256 is 9 and 16. At least 8.
LatitudeLongitude bands_for(std::size_t triangle_count);

/// The walls of a cube about the origin: 8 vertices, 12 triangles, normals inward.
MeshShape cube_walls(double half_m);

}  // namespace collided::cli
