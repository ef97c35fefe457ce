// A44: when and where exactly.
// Boxes, rods, hulls, meshes and compounds that go far for their size between two poses: a wall of a millimetre, a post
// beside which a rod lies before and after its turn. Two poses alone show nothing of either.
#include <gtest/gtest.h>

#include <set>

#include "server/geometry/convex_hull.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine::fast_bodies_test {
namespace {

Shape one(const Primitive& primitive) { return {.primitives = {primitive}, .mesh = nullptr}; }

/// Everything about 5 mm across.
std::vector<std::pair<std::string, Shape>> small_things() {
  constexpr double kHalf = 2.5e-3;
  const Vec3 half = Vec3::Constant(kHalf);
  const TriangleMesh cube = scenes::box(half);
  const auto hull = std::make_shared<const TriangleMesh>(*convex_hull(cube.vertices));
  Shape compound{.primitives = {Sphere{{kHalf, 0, 0}, kHalf}, Box{.center = {-kHalf, 0, 0}, .half_m = half}},
                 .mesh = nullptr};
  return {{"ball", extreme::ball_shape(kHalf)},
          {"box", extreme::box_shape(half)},
          {"capsule", one(Capsule{{0, -kHalf, 0}, {0, kHalf, 0}, kHalf})},
          {"cylinder", one(Cylinder{{0, -kHalf, 0}, {0, kHalf, 0}, kHalf})},
          {"cone", one(Cone{{0, kHalf, 0}, {0, -kHalf, 0}, kHalf})},
          {"ellipsoid", one(Ellipsoid{.center = Vec3::Zero(), .half_m = {kHalf, kHalf / 2, kHalf}})},
          {"hull", one(Hull{hull})},
          {"mesh", extreme::mesh_shape(cube)},
          {"compound", compound}};
}

/// One episode, begun and ended within the step.
void expect_one_passage(const extreme::Stage& stage, const std::string& what) {
  const std::vector<Event>& events = stage.world.events();
  ASSERT_EQ(events.size(), 2u) << what;
  EXPECT_EQ(events[0].kind, EventKind::began) << what;
  EXPECT_EQ(events[1].kind, EventKind::ended) << what;
  EXPECT_GE(events[0].bracket_low_s, events[0].bracket_high_s);
  EXPECT_LE(events[0].bracket_low_s - events[0].bracket_high_s, 2e-6) << what;
  EXPECT_EQ(stage.world.cost().sweeps_skipped, 0u) << what;
}

/// A kilometre in a second through a wall of a millimetre that is a box, a mesh or static triangles; any phase, any turn.
TEST(ExtremeFastBodies, NothingPassesAMillimetreOfWallAtAKilometreASecond) {
  std::mt19937_64 generator = oracle::seeded(501);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Vec3 half(0.5e-3, 2, 2);
  for (const auto& [name, shape] : small_things()) {
    for (int wall = 0; wall < 3; ++wall) {
      extreme::Stage stage;
      if (wall == 0) stage.block("wall", {0, 0, 0}, half);
      if (wall == 1) stage.add("wall", extreme::mesh_shape(scenes::box(half)), extreme::at({0, 0, 0}));
      if (wall == 2) stage.load("wall", scenes::box(half));
      const auto place = [&](double side) {
        const Vec3 where(side * (500 + 3 * uniform(generator)), uniform(generator), uniform(generator));
        const Quat turn(1, uniform(generator), uniform(generator), uniform(generator));
        return extreme::at(where, turn.normalized());
      };
      const ObjectId thing = stage.add(name, shape, place(-1));
      stage.step();
      double side = 1;
      for (int flight = 0; flight < 6; ++flight, side = -side) {
        stage.move(thing, place(side));
        stage.step();
        expect_one_passage(stage, name + " wall " + std::to_string(wall) + " flight " + std::to_string(flight));
      }
    }
  }
}

TEST(ExtremeFastBodies, BesideTheWallNothingIsMet) {
  for (const auto& [name, shape] : small_things()) {
    extreme::Stage stage;
    stage.load("wall", scenes::box({0.5e-3, 2, 2}));
    const ObjectId thing = stage.add(name, shape, extreme::at({-500, 2.1, 0}));
    stage.step();
    stage.move(thing, extreme::at({500, 2.1, 0}));
    EXPECT_TRUE(stage.step().empty()) << name;
    EXPECT_EQ(stage.world.cost().sweeps_skipped, 0u) << name;
  }
}

/// The contacts of a cube that goes straight are known by hand: with both faces of a wall that is hollow.
TEST(ExtremeFastBodies, TheBracketHoldsTheTime) {
  extreme::Stage stage;
  stage.load("wall", scenes::box({0.5, 2, 2}));
  const ObjectId cube = stage.add("cube", extreme::box_shape({0.125, 0.125, 0.125}), extreme::at({-64, 0.25, 0.375}));
  stage.step();
  stage.move(cube, extreme::at({64, 0.25, 0.375}));
  stage.step();
  const std::vector<Event>& events = stage.world.events();
  ASSERT_EQ(events.size(), 4u);
  const double at_m[] = {-0.5 - 0.125, -0.5 + 0.125, 0.5 - 0.125, 0.5 + 0.125};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(events[i].kind, i % 2 == 0 ? EventKind::began : EventKind::ended);
    const double before_end = 1 - (64 + at_m[i]) / 128;
    EXPECT_GE(events[i].bracket_low_s, before_end);
    EXPECT_LE(events[i].bracket_high_s, before_end);
    EXPECT_LE(events[i].bracket_low_s - events[i].bracket_high_s, 2e-6);
  }
}

TEST(ExtremeFastBodies, ATurningRodSweepsAThinPost) {
  std::mt19937_64 generator = oracle::seeded(502);
  std::uniform_real_distribution<double> uniform(0.2, 0.8);
  const Vec3 along(1, 0.01, 0.01);
  for (const Shape& rod : {extreme::box_shape(along), one(Capsule{{-1, 0, 0}, {1, 0, 0}, 0.01}),
                           one(Cylinder{{-1, 0, 0}, {1, 0, 0}, 0.01}), extreme::mesh_shape(scenes::box(along))}) {
    for (int i = 0; i < 6; ++i) {
      const double angle = M_PI / 2 * uniform(generator);
      const Vec3 at_post = uniform(generator) * Vec3(std::cos(angle), std::sin(angle), 0);
      extreme::Stage stage;
      const Shape post = one(Cylinder{at_post - Vec3(0, 0, 1), at_post + Vec3(0, 0, 1), 1e-3});
      stage.add("post", post, extreme::at({0, 0, 0}));
      stage.ball("bead", at_post / 2, 1e-3);
      const ObjectId id = stage.add("rod", rod, extreme::at({0, 0, 0}));
      EXPECT_TRUE(stage.step().empty());
      stage.move(id, extreme::at({0, 0, 0}, Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()))));
      stage.step();
      // The post, and the bead half way out, which a hollow rod meets with both its sides.
      const std::size_t count = rod.mesh ? 3 : 2;
      ASSERT_EQ(extreme::count_of(stage.world.events(), EventKind::began), count);
      ASSERT_EQ(extreme::count_of(stage.world.events(), EventKind::ended), count);
      // The side is 1 cm ahead of the axis, the post's and the bead's 1 mm before theirs.
      std::set<ObjectId> met;
      for (const Event& event : stage.world.events()) {
        if (event.kind != EventKind::began || !met.insert(event.of.a).second) continue;
        const bool is_post = stage.world.info(event.of.a)->name == "post";
        const double radius = at_post.norm() * (is_post ? 1 : 0.5);
        const double time = (angle - std::asin(0.011 / radius)) / (M_PI / 2);
        EXPECT_GE(event.bracket_low_s, 1 - time - 1e-9);
        EXPECT_LE(event.bracket_high_s, 1 - time + 1e-9);
      }
    }
  }
}

/// Two that fly through each other, each by more than its size.
TEST(ExtremeFastBodies, HeadOnTheyAreReported) {
  for (const auto& [name, shape] : small_things()) {
    extreme::Stage stage;
    const ObjectId a = stage.add("a", shape, extreme::at({-1, 0, 0}));
    const ObjectId b = stage.add("b", shape, extreme::at({1, 0, 1e-3}, Quat(0.6, 0, 0.8, 0)));
    stage.step();
    stage.move(a, extreme::at({1, 0, 0}));
    stage.move(b, extreme::at({-1, 0, 1e-3}));
    stage.step();
    expect_one_passage(stage, name);
  }
}

TEST(ExtremeFastBodies, AJumpAndASlowStepAreNotSwept) {
  extreme::Stage stage;
  stage.load("wall", scenes::box({0.5e-3, 2, 2}));
  const ObjectId cube = stage.add("cube", extreme::box_shape({1, 1, 1}), extreme::at({-2, 0, 0}));
  stage.step();
  stage.move(cube, extreme::at({2, 0, 0}), true);
  EXPECT_TRUE(stage.step().empty());
  EXPECT_EQ(stage.world.cost().swept, 0u);
  stage.move(cube, extreme::at({1.5, 0, 0}));
  EXPECT_TRUE(stage.step().empty());
  EXPECT_EQ(stage.world.cost().swept, 0u) << "half a metre is little for two metres of cube";
}

}  // namespace
}  // namespace collided::engine::fast_bodies_test
