// Rays aimed exactly at the edges and corners of a closed mesh a thousand kilometres out: Embree loses a fifth of them
// at corners, Bullet in single precision a tenth.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine::shared_edge_far_test {
namespace {

/// Rays from inside to every corner, to the middle of every edge and to random places on edges: all must hit.
void expect_tight(const extreme::Stage& stage, const TriangleMesh& mesh, const Vec3& inside, std::mt19937_64& random) {
  std::vector<double> rays;
  const auto aim = [&](const Vec3& target) {
    const Vec3 direction = target - inside;
    rays.insert(rays.end(),
                {inside.x(), inside.y(), inside.z(), direction.x(), direction.y(), direction.z(), extreme::kEndless});
  };
  std::uniform_real_distribution<double> part(0, 1);
  for (const TriangleCorners& corners : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3& a = mesh.vertices[corners[static_cast<std::size_t>(k)]];
      const Vec3& b = mesh.vertices[corners[static_cast<std::size_t>((k + 1) % 3)]];
      aim(a);
      aim(0.5 * a + 0.5 * b);
      aim(a + part(random) * (b - a));
    }
  }
  const Answers answers = stage.ask(QuestionKind::ray, rays);
  std::size_t lost = 0;
  for (const auto answer : answers.answers) lost += answer == Verdict::hit ? 0 : 1;
  EXPECT_EQ(lost, 0u) << "of " << answers.answers.size();
}

TEST(ExtremeSharedEdgeFar, AStaticBallLosesNoRay) {
  std::mt19937_64 random = oracle::seeded(411);
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(1e6, -1e6, 1e6), Vec3(1e8, 0, -1e8)}) {
    const TriangleMesh mesh = scenes::icosphere(3, 10, center);
    extreme::Stage stage;
    stage.load("ball", mesh);
    stage.step();
    expect_tight(stage, mesh, center, random);
    expect_tight(stage, mesh, center + Vec3(1.25, -3.5, 0.0625), random);
  }
}

// Corners are placed once and shared, so a turned mesh is as tight as its original.
TEST(ExtremeSharedEdgeFar, ATurnedMovingBallLosesNoRay) {
  std::mt19937_64 random = oracle::seeded(412);
  const TriangleMesh own = scenes::icosphere(2, 10);
  const Quat turned = Quat(0.3, -0.5, 0.7, 0.4).normalized();
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(1e6, -1e6, 1e6)}) {
    extreme::Stage stage;
    stage.add("ball", extreme::mesh_shape(own), extreme::at(center, turned));
    stage.step();
    TriangleMesh placed = own;
    const Frame frame = frame_of(extreme::at(center, turned));
    for (Vec3& vertex : placed.vertices) vertex = place(frame, vertex);
    expect_tight(stage, placed, center, random);
  }
}

}  // namespace
}  // namespace collided::engine::shared_edge_far_test
