#include "tests/studies/bench/ray_scenes.hpp"

#include <cmath>
#include <numbers>

#include "tests/scenes/meshes.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr double kRoom_m = 5;
constexpr double kHeight_m = 3;
constexpr double kWall_m = 0.1;

/// Along x from the corner, with a gap for a door in the middle; along y with turned.
void add_wall(TriangleMesh& mesh, const Vec3& corner, bool turned) {
  const double part_m = (kRoom_m - 1) / 4;  // half of one side of a door one metre wide
  for (const double middle_m : {part_m, kRoom_m - part_m}) {
    const Vec3 half = turned ? Vec3(kWall_m / 2, part_m, kHeight_m / 2) : Vec3(part_m, kWall_m / 2, kHeight_m / 2);
    const Vec3 along = turned ? Vec3(0, middle_m, 0) : Vec3(middle_m, 0, 0);
    scenes::append(mesh, scenes::box(half, corner + along + Vec3(0, 0, kHeight_m / 2)));
  }
}

void furnish(TriangleMesh& mesh, const Vec3& corner, std::mt19937_64& random) {
  constexpr int kPieces = 50;
  std::uniform_real_distribution<double> part(0, 1);
  for (int i = 0; i < kPieces; ++i) {
    const double x = 0.5 + (kRoom_m - 1) * part(random);
    const double y = 0.5 + (kRoom_m - 1) * part(random);
    const double width = 0.02 + 0.3 * part(random);
    const double depth = 0.02 + 0.3 * part(random);
    const double height = 0.05 + 0.5 * part(random);
    const double stands_on = part(random) < 0.5 ? 0 : 0.8;
    scenes::append(mesh, scenes::box({width, depth, height}, corner + Vec3(x, y, stands_on + height)));
  }
  scenes::append(mesh, scenes::icosphere(3, 0.2, corner + Vec3(kRoom_m / 2, kRoom_m / 2, kHeight_m - 0.4)));
}

}  // namespace

Vec3 on_sphere(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random);
  const double y = normal(random);
  return Vec3(x, y, normal(random)).normalized();
}

/// Buildings of five faces on a square of streets, heights over a decade, on a ground of two triangles.
TriangleMesh city(std::uint32_t blocks, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(0, 1);
  TriangleMesh mesh;
  const double reach = 10.0 * blocks;
  scenes::append(mesh, scenes::box({reach, reach, 0.5}, {reach, reach, -0.5}));
  for (std::uint32_t x = 0; x < blocks; ++x) {
    for (std::uint32_t y = 0; y < blocks; ++y) {
      const double width = 3 + 5 * part(random);
      const double height = 5 * std::pow(10, part(random));
      scenes::append(mesh, scenes::box({width, width, height}, {20.0 * x + 10, 20.0 * y + 10, height}));
    }
  }
  return mesh;
}

/// Long thin triangles in every direction.
TriangleMesh needles(std::uint32_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(-1, 1);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = place(random);
    const double y = place(random);
    const Vec3 start(x, y, place(random));
    const Vec3 along = on_sphere(random);
    const Vec3 across = along.unitOrthogonal();
    for (const Vec3& vertex : {start, Vec3(start + 0.3 * along), Vec3(start + 0.15 * along + 3e-4 * across)}) {
      mesh.vertices.push_back(vertex);
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TriangleMesh interior(std::uint32_t rooms, std::mt19937_64& random) {
  TriangleMesh mesh;
  const double reach = kRoom_m * rooms / 2;
  scenes::append(mesh, scenes::box({reach, reach, 0.1}, {reach, reach, -0.1}));
  scenes::append(mesh, scenes::box({reach, reach, 0.1}, {reach, reach, kHeight_m + 0.1}));
  for (std::uint32_t x = 0; x <= rooms; ++x) {
    for (std::uint32_t y = 0; y <= rooms; ++y) {
      const Vec3 corner(kRoom_m * x, kRoom_m * y, 0);
      if (x < rooms) add_wall(mesh, corner, false);
      if (y < rooms) add_wall(mesh, corner, true);
      if (x < rooms && y < rooms) furnish(mesh, corner, random);
    }
  }
  return mesh;
}

TriangleMesh scanned_ball(std::uint32_t triangle_count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto cells = static_cast<std::uint32_t>(std::sqrt(triangle_count / 12.0));
  std::uniform_real_distribution<double> noise(-0.1 / cells, 0.1 / cells);
  TriangleMesh mesh;
  for (int face = 0; face < 6; ++face) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i <= cells; ++i) {
      for (std::uint32_t k = 0; k <= cells; ++k) {
        Vec3 at;
        at[face % 3] = face < 3 ? 1 : -1;
        at[(face + 1) % 3] = std::tan((i / static_cast<double>(cells) - 0.5) * std::numbers::pi / 2);
        at[(face + 2) % 3] = std::tan((k / static_cast<double>(cells) - 0.5) * std::numbers::pi / 2);
        at.normalize();
        const double bump = 0.01 * std::sin(9 * at[0]) * std::sin(11 * at[1]) * std::sin(13 * at[2]);
        mesh.vertices.push_back(at * (1 + bump + noise(random)));
      }
    }
    for (std::uint32_t i = 0; i < cells; ++i) {
      for (std::uint32_t k = 0; k < cells; ++k) {
        const std::uint32_t a = first + i * (cells + 1) + k;
        mesh.triangles.push_back({a, a + 1, a + cells + 2});
        mesh.triangles.push_back({a, a + cells + 2, a + cells + 1});
      }
    }
  }
  return mesh;
}

}  // namespace collided::bench
