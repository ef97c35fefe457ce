// Diagonal slivers of aspect a million: each box is the whole scene, so no axis-aligned plane parts two of them, and
// clipping them may cut without end.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::bvh_slivers_test {
namespace {

constexpr std::uint32_t kCount = 2'000;

/// Slivers from corner to corner of the cube, side by side at 2^-20 m.
TriangleMesh slivers() {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double y = i * 0x1p-20;
    mesh.vertices.insert(mesh.vertices.end(), {{0, y, 0}, {1, 1 + y, 1}, {0, y + 0x1p-20, 0}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TEST(ExtremeBvhSlivers, FragmentsAreBounded) {
  const Bvh tree = Bvh::build(slivers());
  EXPECT_LE(tree.report().references, 4u * kCount);
  EXPECT_LE(tree.report().depth, 64u);
}

TEST(ExtremeBvhSlivers, AnswersAreThoseOfTestingEachOne) {
  extreme::Stage stage;
  stage.load("slivers", slivers());
  stage.step();
  std::vector<double> rays, balls;
  for (int i = 0; i < 60; ++i) {
    const double t = i / 60.0;
    // Down the x axis side through the sheet, and along it.
    rays.insert(rays.end(), {t, t + i * 0x1p-19, 2, 0, 0, -1, extreme::kEndless});
    rays.insert(rays.end(), {-1, i * 0x1p-17 - 1, -1, 1, 1, 1, extreme::kEndless});
    balls.insert(balls.end(), {t, t, t, 0x1p-12});
  }
  extreme::expect_like_brute_force(stage.world, QuestionKind::ray, rays);
  extreme::expect_like_brute_force(stage.world, QuestionKind::sphere, balls);
  extreme::expect_like_brute_force(stage.world, QuestionKind::near, balls);
}

// At its root edge sliver i covers y from i to i + 1 steps: the ray in the middle of it meets that one.
TEST(ExtremeBvhSlivers, TheRightOneOfTwoThousand) {
  extreme::Stage stage;
  stage.load("slivers", slivers());
  stage.step();
  for (std::uint32_t i = 0; i < kCount; i += 97) {
    const Answers found = stage.ray({0, (i + 0.5) * 0x1p-20, 1}, {0, 0, -1});
    ASSERT_TRUE(extreme::is_hit(found)) << i;
    EXPECT_EQ(found.hits[0].triangle, i);
    EXPECT_EQ(found.hits[0].distance_m, 1);
  }
}

}  // namespace
}  // namespace collided::engine::bvh_slivers_test
