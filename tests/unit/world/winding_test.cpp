// Meshes that do not close and are solid by their winding number: what `inside` and signed near say of them, and that all
// else takes them as surfaces.
#include <cmath>

#include "server/world/solids/winding.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/solid_oracle.hpp"
#include "tests/oracle/winding_oracle.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/world/solid_world.hpp"

namespace collided::engine {
namespace {

class WorldWinding : public SolidWorld {
 protected:
  static TriangleMesh box_without_lid() {
    TriangleMesh mesh = scenes::box({1, 1, 1});
    std::erase_if(mesh.triangles, [&](const TriangleCorners& t) {
      return mesh.vertices[t[0]].z() == 1 && mesh.vertices[t[1]].z() == 1 && mesh.vertices[t[2]].z() == 1;
    });
    return mesh;
  }
  DeclaredSolids load_by_winding(const std::string& name, const TriangleMesh& mesh) {
    Scene scene;
    scene.name = name;
    scene.mesh = mesh;
    scene.parts = {{.name = name,
                    .first_triangle = 0,
                    .triangle_count = static_cast<std::uint32_t>(mesh.triangles.size()),
                    .filter = {}}};
    auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
    DeclaredSolids declared = declare_solids(indexed.scene, *indexed.geometry, "*", {}, SolidBy::winding);
    EXPECT_TRUE(std::holds_alternative<std::uint32_t>(world_.add_scene(indexed)));
    step();
    return declared;
  }
  void add_by_winding(const std::string& name, const TriangleMesh& mesh, const Pose& pose) {
    ObjectDefinition definition;
    definition.name = name;
    definition.pose = pose;
    definition.shape.mesh = std::make_shared<const TriangleMesh>(mesh);
    DeclaredMesh declared = declare_solid_at_once(definition.shape.mesh, SolidBy::winding);
    definition.indexed = declared.indexed;
    definition.winding = declared.winding;
    EXPECT_TRUE(declared.winding && !declared.solid) << declared.refusal;
    EXPECT_TRUE(std::holds_alternative<ObjectId>(world_.define(definition)));
    step();
  }
};

TEST_F(WorldWinding, ABoxWithoutLidHoldsAPointAndSaysByWhat) {
  const DeclaredSolids declared = load_by_winding("crate", box_without_lid());
  EXPECT_EQ(declared.by_winding, 1u);
  EXPECT_EQ(declared.count, 0u);
  EXPECT_TRUE(declared.refused.empty());
  ASSERT_EQ(declared.warnings.size(), 1u);
  EXPECT_NE(declared.warnings[0].find("solid by winding number, since it does not close"), std::string::npos)
      << declared.warnings[0];
  inside({0.25, 0, -0.5});
  ASSERT_EQ(names(), "crate");
  EXPECT_EQ(answers_.hits[0].flags, kHitInside | kHitByWinding);
  EXPECT_DOUBLE_EQ(answers_.hits[0].distance_m, 0.5) << "how far the surface is";
  EXPECT_EQ(answers_.hits[0].error_m, INFINITY) << "which is no depth: there may be a way out through the hole";
  EXPECT_EQ(inside({0.25, 0, 1.01}).answers[0], Verdict::miss);
  EXPECT_EQ(inside({0.25, 0, 1}).reasons[0], UndecidedReason::numeric) << "in the opening the number is exactly 1/2";
  EXPECT_EQ(inside({1, 0, 0}).reasons[0], UndecidedReason::numeric) << "on the surface the number jumps";
}

TEST_F(WorldWinding, NearHasASignByItAndIsElseThatOfTheSurface) {
  add_by_winding("crate", box_without_lid(), {});
  ask(QuestionKind::near, {0.25, 0, -0.5, INFINITY}, HitMode::signed_near, 1);
  expect_first(-0.5);
  EXPECT_EQ(answers_.hits[0].flags, kHitInside | kHitByWinding);
  ask(QuestionKind::near, {0.25, 0, -0.5, INFINITY}, HitMode::closest, 1);
  expect_first(0.5);
  EXPECT_EQ(answers_.hits[0].flags, 0);
  ask(QuestionKind::near, {2, 0, 0, INFINITY}, HitMode::signed_near, 1);
  expect_first(1);
}

TEST_F(WorldWinding, ToAllElseItIsASurface) {
  add_by_winding("crate", box_without_lid(), {});
  EXPECT_EQ(ask(QuestionKind::sphere, {0, 0, 0, 0.1}).answers[0], Verdict::miss);
  EXPECT_EQ(ask(QuestionKind::box, {0, 0, 0, 0.1, 0.1, 0.1, 1, 0, 0, 0}).answers[0], Verdict::miss);
  ask(QuestionKind::ray, {0, 0, 0, 1, 0, 0, INFINITY});
  expect_first(1);
}

TEST_F(WorldWinding, WhatClosesStaysExact) {
  const DeclaredSolids declared = load_by_winding("cube", scenes::box({1, 1, 1}));
  EXPECT_EQ(declared.count, 1u);
  EXPECT_EQ(declared.by_winding, 0u);
  EXPECT_TRUE(declared.warnings.empty());
  inside({1, 0, 0});
  EXPECT_EQ(names(), "cube");
  EXPECT_EQ(answers_.hits[0].flags, kHitInside) << "on the surface, which a winding number would not decide";
}

// The frame rounds, so a point may be seen on another side of 1/2 than the pose has it: such are undecided.
TEST_F(WorldWinding, RandomPointsAtRandomPosesAreThoseOfThePlainSum) {
  std::mt19937_64 random = oracle::seeded(63);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> any(-1.2, 1.2);
  TriangleMesh holed = scenes::icosphere(2, 1);
  for (std::size_t i = 0; i < 40; ++i) holed.triangles.erase(holed.triangles.begin() + static_cast<long>(7 * i));
  const Pose pose{.position = {10 * normal(random), 10 * normal(random), 10 * normal(random)},
                  .rotation = Quat(normal(random), normal(random), normal(random), normal(random)).normalized()};
  add_by_winding("holed", holed, pose);
  int counts[3] = {};
  for (int i = 0; i < 500; ++i) {
    const Vec3 point = place(frame_of(pose), Vec3(any(random), any(random), any(random)));
    const oracle::RationalPoint seen = oracle::seen_from(pose, point);
    const Vec3 own(seen[0].get_d(), seen[1].get_d(), seen[2].get_d());
    const auto truth = static_cast<double>(oracle::winding_by_sum(holed, own));
    const Verdict verdict = inside(point).answers[0];
    ++counts[static_cast<int>(verdict)];
    if (verdict == Verdict::hit) { ASSERT_GT(truth, 0.5 - 1e-12); }
    if (verdict == Verdict::miss && own.cwiseAbs().maxCoeff() < 0.9) { ASSERT_LT(truth, 0.5 + 1e-12); }
  }
  EXPECT_GT(counts[static_cast<int>(Verdict::hit)], 50);
  EXPECT_GT(counts[static_cast<int>(Verdict::miss)], 50);
  EXPECT_LT(counts[static_cast<int>(Verdict::undecided)], 3);
}

}  // namespace
}  // namespace collided::engine
