#include "client/cli/publish/sphere_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace collided::cli {

MeshShape sphere_mesh(double radius_m, std::size_t latitudes, std::size_t longitudes) {
  MeshShape mesh;
  mesh.vertices.emplace_back(0, 0, radius_m);
  for (std::size_t band = 1; band < latitudes; ++band) {
    const double polar = std::numbers::pi * static_cast<double>(band) / static_cast<double>(latitudes);
    for (std::size_t slice = 0; slice < longitudes; ++slice) {
      const double around = 2 * std::numbers::pi * static_cast<double>(slice) / static_cast<double>(longitudes);
      mesh.vertices.emplace_back(radius_m * std::sin(polar) * std::cos(around),
                                 radius_m * std::sin(polar) * std::sin(around), radius_m * std::cos(polar));
    }
  }
  mesh.vertices.emplace_back(0, 0, -radius_m);
  const auto ring = [&](std::size_t band, std::size_t slice) {
    return static_cast<std::uint32_t>(1 + (band - 1) * longitudes + slice % longitudes);
  };
  const auto south = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (std::size_t slice = 0; slice < longitudes; ++slice) {
    mesh.triangles.push_back({0, ring(1, slice), ring(1, slice + 1)});
    for (std::size_t band = 1; band + 1 < latitudes; ++band) {
      mesh.triangles.push_back({ring(band, slice), ring(band + 1, slice), ring(band + 1, slice + 1)});
      mesh.triangles.push_back({ring(band, slice), ring(band + 1, slice + 1), ring(band, slice + 1)});
    }
    mesh.triangles.push_back({south, ring(latitudes - 1, slice + 1), ring(latitudes - 1, slice)});
  }
  return mesh;
}

LatitudeLongitude bands_for(std::size_t triangle_count) {
  // With m bands between the polar caps and 2m slices there are 2 * 2m * m triangles.
  const double bands = std::sqrt(static_cast<double>(triangle_count) / 4);
  const auto inner = static_cast<std::size_t>(std::max(1.0, std::round(bands)));
  const auto slices = static_cast<std::size_t>(
      std::max(3.0, std::round(static_cast<double>(triangle_count) / (2.0 * static_cast<double>(inner)))));
  return {inner + 1, slices};
}

MeshShape cube_walls(double half_m) {
  MeshShape mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices.emplace_back((corner & 1) != 0 ? half_m : -half_m, (corner & 2) != 0 ? half_m : -half_m,
                               (corner & 4) != 0 ? half_m : -half_m);
  }
  // Each face: four corners, counter-clockwise as seen from inside.
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
      {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
  for (const auto& face : kFaces) {
    mesh.triangles.push_back({face[0], face[1], face[2]});
    mesh.triangles.push_back({face[0], face[2], face[3]});
  }
  return mesh;
}

}  // namespace collided::cli
