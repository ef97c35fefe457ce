// On a lattice every cut lies on vertices: rays in the cutting planes and through their crossings belong to both sides
// of all of them.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine::bvh_lattice_ray_test {
namespace {

/// Boxes of side 1 with shared faces on a 6^3 lattice: 2,592 triangles, half of them twice in one place.
TriangleMesh blocks(const Vec3& origin) {
  TriangleMesh mesh;
  for (int i = 0; i < 216; ++i) {
    scenes::append(mesh, scenes::box({0.5, 0.5, 0.5}, origin + Vec3(i % 6 + 0.5, i / 6 % 6 + 0.5, i / 36 + 0.5)));
  }
  return mesh;
}

TEST(ExtremeBvhLatticeRay, EveryRayFromOutsideToALatticePointHits) {
  for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(-3, -3, -3), Vec3(1e6, 1e6, -1e6)}) {
    extreme::Stage stage;
    stage.load("blocks", blocks(origin));
    stage.step();
    for (int i = 0; i < 343; i += 5) {
      const Vec3 target = origin + Vec3(i % 7, i / 7 % 7, i / 49);
      const Vec3 from = origin + Vec3(-2, -3, -5);
      const Answers found = stage.ray(from, target - from);
      ASSERT_TRUE(extreme::is_hit(found)) << i;
      EXPECT_LE(found.hits[0].distance_m, (target - from).norm() * (1 + 1e-15));
    }
  }
}

TEST(ExtremeBvhLatticeRay, RaysInTheCuttingPlanesEqualBruteForce) {
  extreme::Stage stage;
  stage.load("blocks", blocks({-3, -3, -3}));
  stage.step();
  std::vector<double> rays;
  for (const double zero : {0.0, -0.0}) {
    for (const double y : {-3.0, -1.0, zero, 2.0, 3.0}) {
      rays.insert(rays.end(), {-9, y, zero, 1, zero, 0, extreme::kEndless});  // along edges
      rays.insert(rays.end(), {y, -9, 0.5, zero, 1, zero, 4});                // in faces
      rays.insert(rays.end(), {-9, -9, y, 1, 1, zero, extreme::kEndless});    // through edges
      rays.insert(rays.end(), {-6, -6, -6 + y, 1, 1, 1, extreme::kEndless});  // through corners
    }
  }
  extreme::expect_like_brute_force(stage.world, QuestionKind::ray, rays);
  extreme::expect_like_brute_force(stage.world, QuestionKind::ray, rays, HitMode::all);
}

}  // namespace
}  // namespace collided::engine::bvh_lattice_ray_test
