// Triangles of all sizes around one centroid: a cut at the middle of the centroids puts all of them on one side.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::bvh_equal_centroids_test {
namespace {

/// Centroid 0 exactly: (-2s, -s), (s, -s), (s, 2s) in three orientations, sizes over twelve decades.
TriangleMesh rosette(std::uint32_t count) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double s = std::ldexp(1.0, static_cast<int>(i % 41) - 20);
    const int axis = static_cast<int>(i % 3);
    for (const auto& [u, v] : {std::pair(-2 * s, -s), std::pair(s, -s), std::pair(s, 2 * s)}) {
      Vec3 corner = Vec3::Zero();
      corner[(axis + 1) % 3] = u;
      corner[(axis + 2) % 3] = v;
      mesh.vertices.push_back(corner);
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TEST(ExtremeBvhEqualCentroids, TheBuildEnds) {
  const Bvh tree = Bvh::build(rosette(10'000));
  EXPECT_LE(tree.report().depth, 64u);
  EXPECT_LE(tree.report().references, 80'000u);
}

TEST(ExtremeBvhEqualCentroids, AnswersAreThoseOfTestingEachOne) {
  extreme::Stage stage;
  stage.load("rosette", rosette(1'000));
  stage.step();
  std::vector<double> rays, boxes;
  for (int i = -21; i <= 21; ++i) {
    const double s = std::ldexp(1.0, i);
    rays.insert(rays.end(), {0, 0, s, 0, 0, -1, extreme::kEndless});
    rays.insert(rays.end(), {s, s, 9, -0.25 * s, 0, -1, extreme::kEndless});
    rays.insert(rays.end(), {-s, -s, -s, 1, 1, 1, s});
    boxes.insert(boxes.end(), {s, s, 0, s / 8, s / 8, s / 8, 1, 0, 0, 0});
  }
  extreme::expect_like_brute_force(stage.world, QuestionKind::ray, rays);
  extreme::expect_like_brute_force(stage.world, QuestionKind::box, boxes);
}

}  // namespace
}  // namespace collided::engine::bvh_equal_centroids_test
