// A16: two costs of a collapse at equal numbers of triangles. How far a vertex goes says little of how far the surface
// does: on flat parts it may go far for nothing, which the quadric knows.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "server/intake/simplify/simplify.hpp"
#include "server/world/objects/surface_distance.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

/// A bound on how far the level is from the whole, either way.
double error_m(const TriangleMesh& whole, const TriangleMesh& level) {
  const Bvh tree = Bvh::build(whole), level_tree = Bvh::build(level);
  const std::vector<std::uint32_t> part(whole.triangles.size(), 0), level_part(level.triangles.size(), 0);
  return surface_distance({whole, tree, part}, {level, level_tree, level_part});
}

/// Corners hold the rest of a box whose sides are many small triangles.
TriangleMesh fine_box(std::uint32_t cells) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int end : {0, 1}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (std::uint32_t row = 0; row <= cells; ++row) {
        for (std::uint32_t column = 0; column <= cells; ++column) {
          Vec3 p;
          p[axis] = end;
          p[(axis + 1) % 3] = static_cast<double>(row) / cells;
          p[(axis + 2) % 3] = static_cast<double>(column) / cells;
          mesh.vertices.push_back(p);
        }
      }
      for (std::uint32_t row = 0; row < cells; ++row) {
        for (std::uint32_t column = 0; column < cells; ++column) {
          const std::uint32_t a = first + row * (cells + 1) + column, b = a + 1, c = a + cells + 1, d = c + 1;
          if (end == 1) {
            mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {b, c, d}});
          } else {
            mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {b, d, c}});
          }
        }
      }
    }
  }
  return mesh;
}

TEST(IntakeCollapseCosts, TheQuadricIsNoWorseAtEqualCount) {
  struct Scene {
    const char* name;
    TriangleMesh mesh;
  };
  for (const Scene& scene : {Scene{"box of small triangles", fine_box(16)},
                             Scene{"terrain", scenes::terrain(32, 10, 3)}, Scene{"ball", scenes::icosphere(4, 1)}}) {
    for (const std::size_t divisor : {2, 4, 8, 16}) {
      double error[2] = {};
      std::size_t count[2] = {};
      for (const CollapseCost cost : {CollapseCost::quadric, CollapseCost::edge_length}) {
        const auto which = static_cast<std::size_t>(cost == CollapseCost::edge_length);
        SimplifyReport report;
        const std::size_t wanted = scene.mesh.triangles.size() / divisor;
        const CollapseOrder order = simplify(scene.mesh, {.cost = cost, .triangles_at_most = wanted}, report);
        const TriangleMesh level = compact_mesh(scene.mesh, level_with(scene.mesh, order, wanted));
        error[which] = error_m(scene.mesh, level);
        count[which] = level.triangles.size();
      }
      std::printf("%s, %zu triangles: quadric %.3g m, edge length %.3g m\n", scene.name, count[0], error[0], error[1]);
      EXPECT_NEAR(static_cast<double>(count[0]), static_cast<double>(count[1]), 2) << scene.name << " 1/" << divisor;
      EXPECT_LE(error[0], error[1] * 1.001 + 1e-12) << scene.name << " 1/" << divisor;
      // On flat sides the quadric goes far for nothing; a length knows no sides.
      EXPECT_TRUE(scene.name != std::string("box of small triangles") || 10 * error[0] < error[1]) << divisor;
    }
  }
}

}  // namespace
}  // namespace collided::engine
