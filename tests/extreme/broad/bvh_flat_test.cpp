// A mesh in one plane or on one line has a root box without volume and a surface area of its own kind: cost functions
// divide by it.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::bvh_flat_test {
namespace {

/// n x n squares of two triangles in the plane `axis` = height; square (u, v) is triangles 2 (v n + u) and the next.
TriangleMesh sheet(int axis, double height, int n) {
  TriangleMesh mesh;
  for (int v = 0; v <= n; ++v) {
    for (int u = 0; u <= n; ++u) {
      Vec3 corner;
      corner[axis] = height;
      corner[(axis + 1) % 3] = u;
      corner[(axis + 2) % 3] = v;
      mesh.vertices.push_back(corner);
    }
  }
  const auto width = static_cast<std::uint32_t>(n + 1);
  for (std::uint32_t v = 0; v + 1 < width; ++v) {
    for (std::uint32_t u = 0; u + 1 < width; ++u) {
      const std::uint32_t i = v * width + u;
      mesh.triangles.push_back({i, i + 1, i + width});
      mesh.triangles.push_back({i + 1, i + width + 1, i + width});
    }
  }
  return mesh;
}

TEST(ExtremeBvhFlat, EveryTriangleOfAFlatSheetIsFound) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double height : {0.0, -0.0, 1e8, -0x1p-1074}) {
      extreme::Stage stage;
      stage.load("sheet", sheet(axis, height, 20));
      stage.step();
      for (std::uint32_t square = 0; square < 400; square += 13) {
        Vec3 from;
        from[axis] = height + 1;
        from[(axis + 1) % 3] = square % 20 + 0.25;
        from[(axis + 2) % 3] = square / 20 + 0.25;
        Vec3 down = Vec3::Zero();
        down[axis] = -1;
        const Answers found = stage.ray(from, down);
        ASSERT_TRUE(extreme::is_hit(found));
        EXPECT_EQ(found.hits[0].triangle, 2 * square);
      }
    }
  }
}

// Within the plane: square by square, entering at u = 0.
TEST(ExtremeBvhFlat, ARayInThePlaneMeetsTheFirstSquare) {
  extreme::Stage stage;
  stage.load("sheet", sheet(2, 0, 20));
  stage.step();
  const Answers first = stage.ray({-5, 7.5, 0}, {1, 0, 0});
  ASSERT_TRUE(extreme::is_hit(first));
  EXPECT_EQ(first.hits[0].distance_m, 5);
  EXPECT_EQ(first.hits[0].triangle, 2u * 7 * 20);
  const Answers all = stage.ray({-5, 7.5, 0}, {1, 0, 0}, extreme::kEndless, HitMode::all);
  EXPECT_EQ(all.hits.size(), 40u) << "both triangles of the 20 squares in its row";
  EXPECT_TRUE(extreme::is_miss(stage.ray({-5, 7.5, 0x1p-1074}, {1, 0, 0})));
}

// Segments and points in a row: no triangle has area, the box has no volume.
TEST(ExtremeBvhFlat, AllOnOneLine) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 1'000; ++i) {
    mesh.vertices.push_back({2.0 * i, 0, 0});
    mesh.vertices.push_back({2.0 * i + 1, 0, 0});
    mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * i});
  }
  extreme::Stage stage;
  stage.load("dashes", mesh);
  stage.step();
  for (std::uint32_t i = 0; i < 1'000; i += 37) {
    const Answers found = stage.ray({2.0 * i + 0.5, 0, 3}, {0, 0, -1});
    ASSERT_TRUE(extreme::is_hit(found)) << i;
    EXPECT_EQ(found.hits[0].triangle, i);
    EXPECT_TRUE(extreme::is_miss(stage.ray({2.0 * i + 1.5, 0, 3}, {0, 0, -1}))) << "between two dashes";
  }
}

}  // namespace
}  // namespace collided::engine::bvh_flat_test
