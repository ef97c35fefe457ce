#include "tests/scenes/meshes.hpp"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace collided::scenes {
using namespace engine;
namespace {

using Random = std::mt19937_64;

Vec3 in_cube(Random& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  const double z = coordinate(random);
  return {x, y, z};
}

void add(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

struct Wave {
  double along_x, along_y, phase, height;
};

std::vector<Wave> waves(Random& random) {
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  std::vector<Wave> all;
  for (int octave = 0; octave < 5; ++octave) {
    const double frequency = 2 * std::numbers::pi * std::pow(2.1, octave);
    for (int i = 0; i < 3; ++i) {
      const double heading = angle(random);
      all.push_back(
          {frequency * std::cos(heading), frequency * std::sin(heading), angle(random), 0.03 * std::pow(0.5, octave)});
    }
  }
  return all;
}

}  // namespace

TriangleMesh terrain(std::uint32_t cells, double size_m, std::uint64_t seed) {
  Random random(seed);
  const std::vector<Wave> all = waves(random);
  std::uniform_real_distribution<double> roughness(-0.2, 0.2);
  TriangleMesh mesh;
  mesh.vertices.reserve(static_cast<std::size_t>(cells + 1) * (cells + 1));
  for (std::uint32_t row = 0; row <= cells; ++row) {
    for (std::uint32_t column = 0; column <= cells; ++column) {
      const double x = static_cast<double>(column) / cells - 0.5;
      const double y = static_cast<double>(row) / cells - 0.5;
      double z = roughness(random) / cells;
      for (const Wave& wave : all) z += wave.height * std::sin(wave.along_x * x + wave.along_y * y + wave.phase);
      mesh.vertices.push_back(size_m * Vec3(x, y, z));
    }
  }
  for (std::uint32_t row = 0; row < cells; ++row) {
    for (std::uint32_t column = 0; column < cells; ++column) {
      const std::uint32_t corner = row * (cells + 1) + column;
      mesh.triangles.push_back({corner, corner + 1, corner + cells + 1});
      mesh.triangles.push_back({corner + 1, corner + cells + 2, corner + cells + 1});
    }
  }
  return mesh;
}

TriangleMesh icosphere(int levels, double radius_m, const Vec3& center) {
  const double g = std::numbers::phi;
  TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)}, mesh.vertices.size());
      if (is_new) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]) / 2);
      return found->second;
    };
    std::vector<TriangleCorners> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  for (Vec3& vertex : mesh.vertices) vertex = center + radius_m * vertex.normalized();
  return mesh;
}

TriangleMesh box(const Vec3& half_m, const Vec3& center) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    mesh.vertices.push_back(center + half_m.cwiseProduct(sign));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh scattered(std::uint32_t count, double size_m, std::uint64_t seed) {
  Random random(seed);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 center = in_cube(random);
    const Vec3 a = center + size_m * in_cube(random);
    const Vec3 b = center + size_m * in_cube(random);
    add(mesh, a, b, center + size_m * in_cube(random));
  }
  return mesh;
}

TriangleMesh slanted(std::uint32_t count, double size_m, std::uint64_t seed) {
  TriangleMesh mesh = scattered(count, size_m, seed);
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 3) {
    mesh.vertices[i + 2] = mesh.vertices[i] + Vec3(0.01 * size_m, 0, 0);
  }
  return mesh;
}

TriangleMesh degenerate(std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  std::uniform_int_distribution<int> kind(0, 5);
  std::uniform_real_distribution<double> decade(-6, 0);
  TriangleMesh mesh;
  while (mesh.triangles.size() < count) {
    const Vec3 a = in_cube(random);
    const double size = std::pow(10.0, decade(random));
    const Vec3 along = size * in_cube(random);
    switch (kind(random)) {
      case 0: add(mesh, a, a + along, a + size * in_cube(random)); break;
      case 1: add(mesh, a, a + along, a + along + 1e-7 * size * in_cube(random)); break;  // needle
      case 2: add(mesh, a, a + along, a + 0.5 * along + 1e-9 * in_cube(random)); break;   // sliver
      case 3: add(mesh, a, a, a); break;
      case 4: add(mesh, a, a + along, a); break;
      default: mesh.triangles.push_back(mesh.triangles.empty() ? TriangleCorners{} : mesh.triangles.back());
    }
    if (mesh.vertices.empty()) mesh.triangles.clear();
  }
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& [a, b, c] : more.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}

}  // namespace collided::scenes
