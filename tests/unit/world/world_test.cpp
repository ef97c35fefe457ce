#include <gtest/gtest.h>

#include <cmath>

#include "server/geometry/placing_error.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"

namespace collided::engine {
namespace {

Scene floor_scene(const std::string& name, double height_m) {
  Scene scene;
  scene.name = name;
  scene.mesh.vertices = {{-10, -10, height_m}, {10, -10, height_m}, {10, 10, height_m}, {-10, 10, height_m}};
  scene.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.parts = {{.name = name, .first_triangle = 0, .triangle_count = 2, .filter = {}}};
  return scene;
}

void load(World& world, Scene scene) {
  auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
  ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(indexed)));
}

ObjectDefinition added_ball(const std::string& name, const Vec3& at, double radius_m) {
  ObjectDefinition definition;
  definition.name = name;
  definition.shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = radius_m}};
  definition.pose.position = at;
  return definition;
}

ObjectId define(World& world, const ObjectDefinition& definition) {
  const auto defined = world.define(definition);
  EXPECT_TRUE(std::holds_alternative<ObjectId>(defined)) << std::get<Refusal>(defined).reason;
  return std::get<ObjectId>(defined);
}

Pose at(const Vec3& position) { return {.position = position, .rotation = Quat::Identity()}; }

Answers ask(const World& world, QuestionKind kind, std::vector<double> numbers, HitMode mode = HitMode::closest,
            const std::string& only = "") {
  Answers answers;
  QueryScratch scratch;
  Questions questions;
  questions.kind = kind;
  questions.mode = mode;
  questions.only = only;
  questions.numbers = numbers;
  const SnapshotRing::Lease lease = world.newest();
  answer(*lease, questions, answers, scratch);
  return answers;
}

class WorldTest : public testing::Test {
 protected:
  bool step(std::int64_t time_ns) { return world.step(time_ns, 1, {.contacts = true, .persisted = false}); }
  World world{WorldOptions{}};
};

// A part has no pose: not that of a mover whose place in the tables it got, and neither its age nor its speed.
TEST_F(WorldTest, AScenesPartHasNothingOfAMoverThatWasThereBefore) {
  const ObjectId mover = define(world, added_ball("mover", {0, 0, 9}, 0.25));
  step(1'000'000'000);
  world.move(mover, at({1, 0, 9}), 1'010'000'000, false);
  step(1'010'000'000);
  world.remove(mover, EndReason::removed);
  step(1'011'000'000);
  load(world, floor_scene("floor", 0));
  define(world, added_ball("ball", {2, 0, 0.125}, 0.25));
  step(1'012'000'000);
  EXPECT_EQ(slot_of(*world.find("floor")), slot_of(mover)) << "the scene must be worth testing";
  const Answers down = ask(world, QuestionKind::ray, {3, 0, 5, 0, 0, -1, INFINITY});
  ASSERT_EQ(down.answers[0], Verdict::hit);
  EXPECT_EQ(down.oldest_pose_ns, -1) << "nothing that moves decided";
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(world.events()[0].relative_velocity, Vec3::Zero());
}

// Whichever of the two has the lower id: before the new one came they cannot have touched.
TEST_F(WorldTest, AContactWithWhatIsNewBeganWhenThatCame) {
  constexpr std::int64_t kNow = 5'000'000'000;
  const auto expect_now = [&](const char* what) {
    ASSERT_EQ(world.events().size(), 1u) << what;
    EXPECT_EQ(world.events()[0].bracket_low_s, 0) << what;
    EXPECT_EQ(world.events()[0].bracket_high_s, 0) << what;
    EXPECT_EQ(world.events()[0].of.began_ns, kNow) << what;
  };
  const ObjectId ball_id = define(world, added_ball("resting", {0, 0, 0}, 0.25));
  step(1'000'000'000);
  ObjectDefinition post = added_ball("post", {0.25, 0, 0}, 0.25);
  post.moving = false;
  define(world, post);
  step(kNow);
  expect_now("a static object");
  world.remove(*world.find("post"), EndReason::removed);
  step(kNow);
  load(world, floor_scene("floor", 0));
  step(kNow);
  expect_now("a scene");
  world.remove_scene("floor");
  step(kNow);
  define(world, added_ball("other", {0.3, 0, 0}, 0.25));
  world.move(ball_id, at({0.01, 0, 0}), 4'999'000'000, false);
  step(kNow);
  expect_now("a mover");
}

TEST_F(WorldTest, ARayMeetsTheNearerOfFloorAndBall) {
  load(world, floor_scene("floor", 0));
  define(world, added_ball("ball", {0, 0, 1}, 0.25));
  step(1);
  const Answers down = ask(world, QuestionKind::ray, {0, 0, 5, 0, 0, -2, INFINITY});
  ASSERT_EQ(down.answers[0], Verdict::hit);
  EXPECT_EQ(world.info(down.hits[0].object)->name, "ball");
  EXPECT_NEAR(down.hits[0].distance_m, 3.75, down.hits[0].error_m + 1e-15);
  const Answers summand = ask(world, QuestionKind::ray, {3, 0, 5, 0, 0, -1, INFINITY});
  EXPECT_EQ(world.info(summand.hits[0].object)->name, "floor");
  EXPECT_EQ(summand.hits[0].distance_m, 5);
  EXPECT_EQ(ask(world, QuestionKind::ray, {3, 0, 5, 0, 0, -1, 4.5}).answers[0], Verdict::miss);
  EXPECT_EQ(ask(world, QuestionKind::ray, {3, 0, 5, 0, 0, -1, 5}).answers[0], Verdict::hit) << "both ends count";
  EXPECT_EQ(ask(world, QuestionKind::ray, {0, 0, 5, 0, 0, 0, 1}).answers[0], Verdict::invalid);
}

TEST_F(WorldTest, AllHitsComeInOrderAndFiltersHide) {
  load(world, floor_scene("floor", 0));
  define(world, added_ball("low", {0.5, 0.25, 1}, 0.25));
  define(world, added_ball("high", {0.5, 0.25, 3}, 0.25));
  step(1);
  const Answers all = ask(world, QuestionKind::ray, {0.5, 0.25, 5, 0, 0, -1, INFINITY}, HitMode::all);
  ASSERT_EQ(all.hits.size(), 3u);
  EXPECT_EQ(world.info(all.hits[0].object)->name, "high");
  EXPECT_EQ(world.info(all.hits[1].object)->name, "low");
  EXPECT_EQ(world.info(all.hits[2].object)->name, "floor");
  const Answers filtered = ask(world, QuestionKind::ray, {0.5, 0.25, 5, 0, 0, -1, INFINITY}, HitMode::closest, "l*");
  EXPECT_EQ(world.info(filtered.hits[0].object)->name, "low");
}

TEST_F(WorldTest, SphereBoxAndNearSeeStaticAndMoving) {
  load(world, floor_scene("floor", 0));
  define(world, added_ball("ball", {1, 1, 0.5}, 0.25));
  step(1);
  const Answers sphere = ask(world, QuestionKind::sphere, {1, 1, 0.2, 0.3});
  ASSERT_EQ(sphere.hits.size(), 2u);
  EXPECT_NEAR(sphere.hits[0].distance_m, 0.25, 1e-12) << "deepest first: the ball by 0.55 - 0.3";
  EXPECT_NEAR(sphere.hits[1].distance_m, 0.1, 1e-12);
  EXPECT_NEAR(sphere.hits[1].normal.z(), -1, 1e-12) << "from the asked sphere to the floor";
  EXPECT_EQ(ask(world, QuestionKind::box, {5, 5, 1, 0.5, 0.5, 0.5, 1, 0, 0, 0}).answers[0], Verdict::miss);
  EXPECT_EQ(ask(world, QuestionKind::box, {5, 5, 0.5, 0.5, 0.5, 0.5, 1, 0, 0, 0}).answers[0], Verdict::hit)
      << "touching is overlap";
  const Answers near = ask(world, QuestionKind::near, {1, 1, 5, INFINITY});
  ASSERT_EQ(near.hits.size(), 2u);
  EXPECT_EQ(world.info(near.hits[0].object)->name, "ball");
  EXPECT_NEAR(near.hits[0].distance_m, 4.25, 1e-12);
  EXPECT_NEAR(near.hits[1].distance_m, 5, 1e-12);
  EXPECT_EQ(ask(world, QuestionKind::near, {1, 1, 5, 4.0}).answers[0], Verdict::miss);
}

TEST_F(WorldTest, EventsBeginAndEndOnce) {
  load(world, floor_scene("floor", 0));
  const ObjectId id = define(world, added_ball("ball", {0, 0, 1}, 0.25));
  step(1'000'000'000);
  EXPECT_TRUE(world.events().empty());
  world.move(id, at({0, 0, 0.2}), 2'000'000'000, false);
  step(2'000'000'000);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(world.events()[0].kind, EventKind::began);
  EXPECT_NEAR(world.events()[0].of.contact.depth_m, 0.05, 1e-12);
  // It came down 0.8 m in a second and touched after 0.75 m: 0.0625 s before the end.
  EXPECT_NEAR(world.events()[0].bracket_low_s, 0.0625, 1e-6);
  EXPECT_GE(world.events()[0].bracket_low_s, world.events()[0].bracket_high_s);
  world.move(id, at({0.1, 0, 0.2}), 3'000'000'000, false);
  step(3'000'000'000);
  EXPECT_TRUE(world.events().empty());
  world.remove(id, EndReason::removed);
  step(4'000'000'000);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(world.events()[0].reason, EndReason::removed);
}

// A 1 mm wall and a ball that is before it in one pose and behind it in the next.
TEST_F(WorldTest, AFastBallDoesNotPassThroughAWall) {
  load(world, floor_scene("wall", 0));
  const ObjectId id = define(world, added_ball("bullet", {0, 0, 500}, 0.001));
  step(0);
  world.move(id, at({0, 0, -500}), 1'000'000'000, false);
  step(1'000'000'000);
  ASSERT_EQ(world.events().size(), 2u);
  EXPECT_EQ(world.events()[0].kind, EventKind::began);
  EXPECT_EQ(world.events()[1].kind, EventKind::ended);
  EXPECT_EQ(world.events()[1].of.episode, world.events()[0].sequence);
  EXPECT_NEAR(world.events()[0].bracket_low_s, 0.5, 1e-5);
  EXPECT_TRUE(world.contacts().empty());
}

TEST_F(WorldTest, ATeleportedBallDoesNotSweep) {
  load(world, floor_scene("wall", 0));
  const ObjectId id = define(world, added_ball("ball", {0, 0, 5}, 0.1));
  step(0);
  world.move(id, at({0, 0, -5}), 1, true);
  step(1);
  EXPECT_TRUE(world.events().empty());
}

TEST_F(WorldTest, TwoMoversMeetWithTheNormalFromTheFirst) {
  const ObjectId a = define(world, added_ball("a", {0, 0, 0}, 0.5));
  const ObjectId b = define(world, added_ball("b", {5, 0, 0}, 0.5));
  step(0);
  world.move(b, at({0.75, 0, 0}), 1, false);
  step(1);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(world.events()[0].of.a, a);
  EXPECT_EQ(world.events()[0].of.b, b);
  EXPECT_NEAR(world.events()[0].of.contact.normal.x(), 1, 1e-15);
  EXPECT_NEAR(world.events()[0].of.contact.depth_m, 0.25, 1e-15);
}

TEST_F(WorldTest, MovingAndStaticMeshesMeet) {
  load(world, floor_scene("floor", 0));
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  mesh->triangles = {{0, 1, 2}};
  ObjectDefinition fin;
  fin.name = "fin";
  fin.shape.mesh = mesh;
  fin.pose.position = {0, 0, 2};
  const ObjectId id = define(world, fin);
  step(0);
  EXPECT_TRUE(world.events().empty());
  world.move(id, at({0.3, 0.1, -0.5}), 1, false);
  step(1);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(world.events()[0].kind, EventKind::began);
}

// A mesh a million metres out: its triangles are placed with rounding there, and the bounds must know.
TEST_F(WorldTest, FarFromOriginAMovingMeshIsStillFound) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh->triangles = {{0, 1, 2}};
  ObjectDefinition plate;
  plate.name = "plate";
  plate.shape.mesh = mesh;
  plate.pose = {.position = {1e6, -3e6, 2e6}, .rotation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()))};
  define(world, plate);
  step(0);
  const Frame frame = frame_of(plate.pose);
  const Triangle placed = place(frame, mesh->triangle(0));
  for (int i = 0; i < 200; ++i) {
    const double u = (i + 1) / 400.0;  // inside: on the edge itself the aim is off by a rounding
    const Vec3 aim = placed.a + u * (placed.b - placed.a) + 0.25 * (placed.c - placed.a);
    const Vec3 from = aim + Vec3(3, 1 + u, 2);
    const Vec3 d = aim - from;
    const Answers answers =
        ask(world, QuestionKind::ray, {from.x(), from.y(), from.z(), d.x(), d.y(), d.z(), INFINITY});
    EXPECT_EQ(answers.answers[0], Verdict::hit) << i;
  }
  const double off_m = placing_error_m(frame, mesh->triangle(0));
  const Answers corner = ask(world, QuestionKind::sphere, {placed.a.x(), placed.a.y(), placed.a.z(), off_m});
  EXPECT_EQ(corner.answers[0], Verdict::hit) << "the corner is no farther from where it is placed";
}

TEST_F(WorldTest, NamesAreUniqueAndSlotsAreReused) {
  const ObjectId first = define(world, added_ball("ball", {0, 0, 0}, 1));
  EXPECT_TRUE(std::holds_alternative<Refusal>(world.define(added_ball("ball", {0, 0, 0}, 1))));
  world.remove(first, EndReason::removed);
  step(1);
  const ObjectId second = define(world, added_ball("ball", {0, 0, 0}, 1));
  EXPECT_EQ(slot_of(first), slot_of(second));
  EXPECT_NE(first, second);
  EXPECT_EQ(world.info(first), nullptr);
}

TEST_F(WorldTest, LoadingASceneFindsWhatAlreadyTouchesIt) {
  define(world, added_ball("ball", {0, 0, 0}, 0.5));
  step(0);
  load(world, floor_scene("floor", 0));
  step(1);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(world.remove_scene("floor"), 1u);
  step(2);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(world.events()[0].reason, EndReason::geometry_changed);
  EXPECT_EQ(ask(world, QuestionKind::ray, {3, 3, 5, 0, 0, -1, INFINITY}).answers[0], Verdict::miss);
}

}  // namespace
}  // namespace collided::engine
