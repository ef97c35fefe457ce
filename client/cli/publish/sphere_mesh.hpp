#pragma once

#include <array>
#include <cstddef>

#include <collided/client.hpp>

namespace collided::cli {

/// A closed mesh of a sphere with vertices on it and normals outward: 2 * longitudes * (latitudes - 1) triangles.
///
/// latitudes   bands from pole to pole, at least 2
/// longitudes  slices round the axis, at least 3
MeshShape sphere_mesh(double radius_m, std::size_t latitudes, std::size_t longitudes);

/// The bands and slices of a sphere's mesh.
struct LatitudeLongitude {
  std::size_t latitudes = 2;
  std::size_t longitudes = 3;
};

/// The bands and slices of a sphere with about that many triangles, at least 8, and nearly square cells: for 256, 9 and
/// 16.
LatitudeLongitude bands_for(std::size_t triangle_count);

/// The walls of a cube about the origin: 8 vertices, 12 triangles, normals inward.
MeshShape cube_walls(double half_m);

}  // namespace collided::cli
