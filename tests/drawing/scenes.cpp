#include "tests/drawing/scenes.hpp"

#include <cmath>
#include <numbers>

namespace collided::drawing_test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// The lid, z high, comes last.
constexpr std::uint32_t kCubeSides[6][4] = {{0, 3, 2, 1}, {0, 1, 5, 4}, {1, 2, 6, 5},
                                            {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}};

MeshShape cube_of(double half_m, int side_count) {
  MeshShape mesh;
  for (const double z : {-half_m, half_m}) {
    for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
      mesh.vertices.emplace_back(x * half_m, y * half_m, z);
    }
  }
  for (int i = 0; i < side_count; ++i) {
    const auto& side = kCubeSides[i];
    mesh.triangles.push_back({side[0], side[1], side[2]});
    mesh.triangles.push_back({side[0], side[2], side[3]});
  }
  return mesh;
}

}  // namespace

MeshShape cube(double half_m) { return cube_of(half_m, 6); }
MeshShape open_box(double half_m) { return cube_of(half_m, 5); }

MeshShape torus(double ring_m, double tube_m, int around, int along) {
  MeshShape mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      const double u = kTurn * i / around;
      const double v = kTurn * j / along;
      const double r = ring_m + tube_m * std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), tube_m * std::sin(v));
    }
  }
  const auto number = [&](int i, int j) { return static_cast<std::uint32_t>(i % around * along + j % along); };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      mesh.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      mesh.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  }
  return mesh;
}

MeshShape sphere(double radius_m, int latitudes, int longitudes) {
  MeshShape mesh;
  mesh.vertices.emplace_back(0, 0, radius_m);
  for (int i = 1; i < latitudes; ++i) {
    for (int j = 0; j < longitudes; ++j) {
      const double polar = std::numbers::pi * i / latitudes;
      const double turn = kTurn * j / longitudes;
      mesh.vertices.push_back(
          radius_m * Vec3(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)));
    }
  }
  mesh.vertices.emplace_back(0, 0, -radius_m);
  const auto number = [&](int i, int j) -> std::uint32_t {
    if (i == 0) return 0;
    if (i == latitudes) return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    return static_cast<std::uint32_t>(1 + (i - 1) * longitudes + j % longitudes);
  };
  for (int i = 0; i < latitudes; ++i) {
    for (int j = 0; j < longitudes; ++j) {
      if (i + 1 < latitudes) mesh.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      if (i > 0) mesh.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  }
  return mesh;
}

}  // namespace collided::drawing_test
