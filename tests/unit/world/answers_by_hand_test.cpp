// Small worlds whose answers, contacts, bounds and words are known by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "server/world/objects/parts.hpp"
#include "server/world/objects/surface_distance.hpp"
#include "server/world/audit/boxes_only.hpp"
#include "server/world/audit/menu.hpp"
#include "server/world/query/plan.hpp"
#include "server/world/query/query.hpp"
#include "server/world/query/question.hpp"
#include "server/world/world.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

class WorldByHand : public testing::Test {
 protected:
  void load(TriangleMesh mesh, const Filter& filter = {}) {
    Scene scene;
    scene.name = "scene";
    scene.mesh = std::move(mesh);
    scene.parts = {{.name = "part",
                    .first_triangle = 0,
                    .triangle_count = static_cast<std::uint32_t>(scene.mesh.triangles.size()),
                    .filter = filter}};
    auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(indexed)));
  }
  ObjectId define(const std::string& name, const Vec3& at, const Shape& shape, bool moving = true) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape = shape;
    definition.pose.position = at;
    definition.moving = moving;
    const auto defined = world.define(definition);
    EXPECT_TRUE(std::holds_alternative<ObjectId>(defined)) << name;
    return std::get<ObjectId>(defined);
  }
  static Shape ball(double radius_m) {
    Shape shape;
    shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = radius_m}};
    return shape;
  }
  static Shape rock() {
    Shape shape;
    shape.mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(1, 0.5));
    return shape;
  }
  void move(ObjectId id, const Vec3& to) {
    EXPECT_TRUE(world.move(id, {.position = to, .rotation = Quat::Identity()}, 1'000'000'000 * (steps + 1), false));
  }
  void step() { EXPECT_TRUE(world.step(1'000'000'000 * ++steps, 1, {})); }
  bool touch(ObjectId a, ObjectId b) const {
    return std::any_of(world.contacts().begin(), world.contacts().end(), [&](const OpenContact& contact) {
      return (contact.a == a && contact.b == b) || (contact.a == b && contact.b == a);
    });
  }
  Answers ask(Questions questions, const std::vector<double>& numbers) const {
    questions.numbers = numbers;
    Answers answers;
    QueryScratch scratch;
    const SnapshotRing::Lease lease = world.newest();
    answer(*lease, questions, answers, scratch);
    return answers;
  }

  World world{WorldOptions{}};
  std::int64_t steps = 0;
};

TriangleMesh square(double half_m, double z) {
  return {{{-half_m, -half_m, z}, {half_m, -half_m, z}, {half_m, half_m, z}, {-half_m, half_m, z}},
          {{0, 1, 2}, {0, 2, 3}}};
}

TEST_F(WorldByHand, ARayMeetsNothingOfASceneThatMayNotAnswer) {
  load(square(4, 0), {.layers = 2});
  step();
  for (const HitMode mode : {HitMode::any, HitMode::closest, HitMode::all}) {
    const std::vector<double> down{0.5, 0.25, 3, 0, 0, -1, INFINITY};
    Questions question{.kind = QuestionKind::ray, .mode = mode, .mask = 1, .numbers = {}};
    EXPECT_EQ(ask(question, down).answers[0], Verdict::miss);
    question.mask = 2;
    EXPECT_EQ(ask(question, down).answers[0], Verdict::hit);
  }
}

// What was found of a mover and a scene says nothing of the mover and the object with the next number.
TEST_F(WorldByHand, AGapToASceneIsNotOneToAnotherMover) {
  const ObjectId first = define("first", {0, 0, 0}, rock());
  const ObjectId second = define("second", {2, 0, 0}, rock());
  TriangleMesh floor = square(20, -5);
  floor.vertices.insert(floor.vertices.end(), {{19, 19, -5}, {20, 19, -5}, {20, 20, 5}});
  floor.triangles.push_back({4, 5, 6});
  load(floor);
  step();
  move(first, {0.1, 0, 0});
  step();
  EXPECT_FALSE(touch(first, second));
  move(first, {0.2, 0, 0});
  move(second, {1, 0, 0});
  step();
  EXPECT_TRUE(touch(first, second));
}

TEST_F(WorldByHand, WhatIsPlacedOntoTheFirstObjectTouchesIt) {
  const ObjectId first = define("first", {0, 0, 0}, ball(0.5));
  for (int i = 0; i < 60; ++i) define("post" + std::to_string(i), {10.0 + 2 * i, 0, 0}, ball(0.5), false);
  step();
  const ObjectId placed = define("placed", {0.75, 0, 0}, ball(0.5), false);
  step();
  EXPECT_TRUE(touch(first, placed));
  EXPECT_EQ(world.contacts().size(), 1U);
}

// Few that move among many that never do: each is looked for, whatever stood there before it.
TEST_F(WorldByHand, EveryOneOfAFewMoversMeetsWhatWasThereFirst) {
  std::vector<ObjectId> posts;
  for (int i = 0; i < 60; ++i)
    posts.push_back(define("post" + std::to_string(i), {10.0 + 2 * i, 0, 0}, ball(0.5), false));
  const ObjectId one = define("one", {16.75, 0, 0}, ball(0.5));
  const ObjectId other = define("other", {24.75, 0, 0}, ball(0.5));
  step();
  EXPECT_TRUE(touch(posts[3], one));
  EXPECT_TRUE(touch(posts[7], other));
  EXPECT_EQ(world.contacts().size(), 2U);
  EXPECT_FALSE(world.cost().truncated);
  move(one, {30.75, 0, 0});
  move(other, {40.75, 0, 0});
  step();
  EXPECT_TRUE(touch(posts[10], one));
  EXPECT_TRUE(touch(posts[15], other));
  EXPECT_EQ(world.contacts().size(), 2U);
}

// Rays of a camera go through a scene together; short ones meet what is near as well as endless ones do.
TEST_F(WorldByHand, ShortRaysOfACameraMeetWhatIsNear) {
  load(square(500, 0));
  step();
  for (const double length_m : {1.5, 30.0, double{INFINITY}}) {
    std::vector<double> rays;
    for (int i = 0; i < 64; ++i) rays.insert(rays.end(), {0.5, 0.25, 1, 0.01 * (i % 8), 0.01 * (i / 8), -1, length_m});
    for (const HitMode mode : {HitMode::closest, HitMode::any}) {
      const Answers answers = ask({.kind = QuestionKind::ray, .mode = mode, .numbers = {}}, rays);
      ASSERT_EQ(answers.answers.size(), 64U);
      for (std::size_t i = 0; i < 64; ++i) {
        EXPECT_EQ(answers.answers[i], Verdict::hit) << i << ", " << length_m << " m";
        if (mode == HitMode::any) continue;
        const Vec3 direction(rays[7 * i + 3], rays[7 * i + 4], rays[7 * i + 5]);
        EXPECT_NEAR(answers.hits.at(i).distance_m, direction.norm(), 1e-12) << i;
      }
    }
  }
  std::vector<double> shorter;
  for (int i = 0; i < 64; ++i) shorter.insert(shorter.end(), {0.5, 0.25, 1, 0, 0, -1, i % 2 == 0 ? 0.5 : 1.5});
  const Answers answers = ask({.kind = QuestionKind::ray, .numbers = {}}, shorter);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(answers.answers[i], i % 2 == 0 ? Verdict::miss : Verdict::hit) << i;
}

// A hit names its object and triangle: the shapes so named, where they are.
TEST_F(WorldByHand, WhatAHitNamesIsFoundWhereItIs) {
  TriangleMesh floor = square(1, -5);
  load(floor);
  Shape two = ball(0.5);
  two.primitives.push_back(Box{.center = {0, 0, 1}, .half_m = {1, 1, 1}});
  const ObjectId solids = define("solids", {3, 0, 0}, two);
  const ObjectId stone = define("stone", {0, 3, 0}, rock());
  step();
  const SnapshotRing::Lease state = world.newest();
  const auto middles = [&](ObjectId id, std::uint32_t triangle) {
    std::vector<Vec3> found;
    visit_part(*state, id, triangle, [&](const auto& shape) {
      const Aabb around = bounds(shape);
      found.push_back(around.low / 2 + around.high / 2);
    });
    return found;
  };
  const std::vector<Vec3> of_solids = middles(solids, kNoTriangle);
  ASSERT_EQ(of_solids.size(), 2U);
  EXPECT_NEAR((of_solids[0] - Vec3(3, 0, 0)).norm() + (of_solids[1] - Vec3(3, 0, 1)).norm(), 0, 1e-12);
  const std::vector<Vec3> of_stone = middles(stone, 2);
  ASSERT_EQ(of_stone.size(), 1U);
  EXPECT_NEAR((of_stone[0] - Vec3(0, 3, 0)).norm(), 0.5, 0.3);
  const Answers down = ask({.kind = QuestionKind::ray, .numbers = {}}, {-0.5, 0.5, 3, 0, 0, -1, INFINITY});
  ASSERT_EQ(down.hits.size(), 1U);
  EXPECT_EQ(down.hits[0].triangle, 1U);
  const std::vector<Vec3> of_floor = middles(down.hits[0].object, down.hits[0].triangle);
  ASSERT_EQ(of_floor.size(), 1U);
  EXPECT_EQ(of_floor[0], Vec3(0, 0, -5));
}

TEST_F(WorldByHand, ANewWorldIsEmptyAndNoTimeHasPassed) {
  const SnapshotRing::Lease state = world.newest();
  EXPECT_EQ(state->version, 0U);
  EXPECT_EQ(state->world_time_ns, 0);
  EXPECT_EQ(state->objects.size(), 0u);
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_TRUE(world.events().empty());
}

// The most exact of all tests is the one that is told, in whichever order they come.
TEST_F(WorldByHand, AQuestionCountsEveryTestAndKeepsTheHighestLevel) {
  const SnapshotRing::Lease state = world.newest();
  const Questions asked{.kind = QuestionKind::ray, .numbers = {}};
  const std::vector<std::uint8_t> nobody;
  std::vector<AnswerHit> found;
  Question question{.snapshot = *state, .asked = asked, .allowed = nobody, .open_scenes = nobody, .found = found};
  question.count({Decision::no, Level::rational});
  question.count({Decision::yes, Level::filter});
  EXPECT_EQ(question.exact_tests, 2U);
  EXPECT_EQ(question.level, Level::rational);
  EXPECT_FALSE(question.undecided);
  question.count({Decision::undecided, Level::filter});
  question.count({Decision::yes, Level::filter});
  EXPECT_EQ(question.exact_tests, 4U);
  EXPECT_TRUE(question.undecided) << "one open test leaves the answer open";
}

TEST_F(WorldByHand, NothingIsNearerThanWhatHoldsThePointWhateverErrorIsAsked) {
  define("ball", {0, 0, 0}, ball(1));
  define("other", {5, 0, 0}, ball(1));
  step();
  const Answers inside =
      ask({.kind = QuestionKind::near, .max_hits = 1, .error_m = 0.01, .numbers = {}}, {0.25, 0, 0, 9});
  ASSERT_EQ(inside.hits.size(), 1U);
  EXPECT_TRUE(inside.hits[0].is_at_start());
  EXPECT_TRUE(std::isfinite(inside.hits[0].point_error_m));
  const Answers outside =
      ask({.kind = QuestionKind::near, .max_hits = 1, .error_m = 0.01, .numbers = {}}, {2.25, 0, 0, 9});
  ASSERT_EQ(outside.hits.size(), 1U);
  EXPECT_NEAR(outside.hits[0].distance_m, 1.25, outside.hits[0].error_m);
  EXPECT_GT(outside.hits[0].error_m, 1e-3) << "half of it may lie nearer";
  EXPECT_LE(outside.hits[0].error_m, 0.01);
}

TEST_F(WorldByHand, AnOverlapSaysWhichObjectsAreStale) {
  const ObjectId stale = define("stale", {0, 0, 0}, ball(1));
  const ObjectId fresh = define("fresh", {1, 0, 0}, ball(1));
  step();
  world.set_stale(stale, true);
  step();
  const auto flags_of = [](const Answers& answers, ObjectId id) {
    for (const AnswerHit& hit : answers.hits) {
      if (hit.object == id) return static_cast<int>(hit.flags);
    }
    return -1;
  };
  const Answers sphere = ask({.kind = QuestionKind::sphere, .numbers = {}}, {0.5, 0, 0, 0.25});
  const Answers box = ask({.kind = QuestionKind::box, .numbers = {}}, {0.5, 0, 0, 0.25, 0.25, 0.25, 0, 0, 0, 1});
  for (const Answers* answers : {&sphere, &box}) {
    EXPECT_EQ(flags_of(*answers, stale), kHitStale);
    EXPECT_EQ(flags_of(*answers, fresh), 0);
  }
}

TEST_F(WorldByHand, BoxesAloneAnswerForTheirBoxes) {
  load(square(4, 0));
  const ObjectId part = world.newest()->scenes.empty() ? 0 : world.newest()->scenes[0]->part_objects[0];
  const ObjectId one = define("ball", {1, 1, 2}, ball(0.5));
  step();
  const SnapshotRing::Lease lease = world.newest();
  const auto by_boxes = [&](QuestionKind kind, const std::vector<double>& numbers) {
    return answer_by_boxes(*lease, Questions{.kind = kind, .numbers = numbers});
  };
  // Past the ball through a corner of its box; past both; along an axis within a slab and beside it.
  EXPECT_NEAR(by_boxes(QuestionKind::ray, {1.45, 1.45, 5, 0, 0, -2, INFINITY}).distance_m.value_or(-1), 2.5, 1e-9);
  EXPECT_NEAR(by_boxes(QuestionKind::ray, {-1, -1, 5, 0, 0, -2, INFINITY}).distance_m.value_or(-1), 5, 1e-9);
  EXPECT_NEAR(by_boxes(QuestionKind::ray, {-3, 1, 2, 1, 0, 0, INFINITY}).distance_m.value_or(-1), 3.5, 1e-9);
  EXPECT_FALSE(by_boxes(QuestionKind::ray, {-3, 1, 2, 1, 0, 0, 3.25}).distance_m.has_value()) << "too short";
  EXPECT_FALSE(by_boxes(QuestionKind::ray, {-3, 2, 2, 1, 0, 0, INFINITY}).distance_m.has_value());
  EXPECT_NEAR(by_boxes(QuestionKind::near, {1.25, 1.25, 4, 9}).distance_m.value_or(-1), 1.5, 1e-9);
  const std::set<ObjectId> met = by_boxes(QuestionKind::sphere, {1.5, 1.5, 2.5, 0.1}).objects;
  EXPECT_EQ(met, std::set<ObjectId>{one}) << "of another than " << part;
}

// A ball touches an edge of a box, 3, 4 and 5 times a number whose square no double holds: no filter is sure of that.
TEST_F(WorldByHand, AnAnswerSaysHowExactlyItHadToBeDecided) {
  Shape box;
  box.primitives = {Box{.center = Vec3(-1, -1, 0), .half_m = Vec3(1, 1, 1)}};
  define("box", {0, 0, 0}, box);
  step();
  const double k = 0.5 + 0x1p-31;
  const auto level_of = [&](double x) {
    return ask({.kind = QuestionKind::sphere, .numbers = {}}, {x, 4 * k, 0, 5 * k}).levels.at(0);
  };
  EXPECT_GT(level_of(3 * k), 0) << "exactly";
  EXPECT_EQ(level_of(0.125), 0) << "far inside";
  EXPECT_EQ(level_of(2), 0) << "far outside";
  EXPECT_GT(level_of(3 * k), 0) << "nothing is left of the questions before";
}

// A mesh and a solid: counted alike whichever was there first.
TEST_F(WorldByHand, AStepCountsItsExactTests) {
  std::uint64_t counted[2] = {};
  for (const bool mesh_first : {false, true}) {
    World fresh{WorldOptions{}};
    for (const bool is_mesh : {mesh_first, !mesh_first}) {
      ObjectDefinition definition;
      definition.name = is_mesh ? "rock" : "ball";
      definition.shape = is_mesh ? rock() : ball(0.5);
      definition.pose.position = {is_mesh ? 0.0 : 0.9, 0, 0};
      ASSERT_TRUE(std::holds_alternative<ObjectId>(fresh.define(definition)));
    }
    ASSERT_TRUE(fresh.step(1, 1, {}));
    EXPECT_EQ(fresh.contacts().size(), 1U);
    counted[mesh_first ? 1 : 0] = fresh.cost().exact_tests;
  }
  EXPECT_GT(counted[0], 0U);
  EXPECT_EQ(counted[0], counted[1]);
}

TEST_F(WorldByHand, ThePriceListSaysThatBoxesComeWithoutABound) {
  for (int i = 0; i < 8; ++i)
    define("ball" + std::to_string(i), {i & 1 ? 3.0 : 0, i & 2 ? 3.0 : 0, i & 4 ? 3.0 : 0}, ball(1.4));
  step();
  const SnapshotRing::Lease lease = world.newest();
  const std::vector<MenuRow> menu = menu_of(*lease, {.questions = 200, .seed = 7, .cancelled = {}});
  int boxes = 0;
  for (const MenuRow& row : menu) {
    EXPECT_EQ(row.asked, 200U) << row.method;
    if (row.method != "boxes only") continue;
    ++boxes;
    EXPECT_EQ(row.worst_bound_m, INFINITY) << "no bound comes with a box";
    // A box holds its ball: it says yes too often and never no; and the nearest corner of space is a way from its ball.
    if (row.asked_of == "near" || row.asked_of == "pair") {
      EXPECT_GT(row.worst_error_m, 0.01);
      EXPECT_LT(row.worst_error_m, row.asked_of == "near" ? 1.4 : 2.8);
    } else {
      EXPECT_GT(row.wrong, 0U);
      EXPECT_LT(row.wrong, 100U) << row.asked_of;
    }
  }
  EXPECT_EQ(boxes, 6) << "four kinds about places, ways, and pairs of balls";
}

TEST_F(WorldByHand, ThePriceListSaysTheSameOfTheSameQuestions) {
  for (int i = 0; i < 8; ++i)
    define("ball" + std::to_string(i), {i & 1 ? 3.0 : 0, i & 2 ? 3.0 : 0, i & 4 ? 3.0 : 0}, ball(1.4));
  step();
  const SnapshotRing::Lease lease = world.newest();
  const std::vector<MenuRow> first = menu_of(*lease, {.questions = 200, .seed = 7, .cancelled = {}});
  for (int again = 0; again < 3; ++again) {
    const std::vector<MenuRow> menu = menu_of(*lease, {.questions = 200, .seed = 7, .cancelled = {}});
    ASSERT_EQ(menu.size(), first.size());
    for (std::size_t i = 0; i < menu.size(); ++i) {
      EXPECT_EQ(menu[i].undecided, first[i].undecided) << menu[i].method;
      EXPECT_EQ(menu[i].wrong, first[i].wrong) << menu[i].method;
      EXPECT_EQ(menu[i].worst_error_m, first[i].worst_error_m) << menu[i].method;
      EXPECT_EQ(menu[i].worst_bound_m, first[i].worst_bound_m) << menu[i].method;
      EXPECT_LE(menu[i].worst_error_m, menu[i].worst_bound_m) << menu[i].method;
    }
  }
}

TEST_F(WorldByHand, ThePlanSaysWhatATriangleOfTheIndexCosts) {
  load(scenes::terrain(8, 2, 1));
  step();
  const SnapshotRing::Lease lease = world.newest();
  const StaticScene& scene = *lease->scenes[0];
  char bytes[64];
  std::snprintf(bytes, sizeof bytes, " references and %.1f bytes a triangle, ",
                static_cast<double>(scene.bytes()) / 128);
  ASSERT_EQ(scene.mesh.triangles.size(), 128U);
  const PlanRow tree = plan_of(*lease, false)[0];
  EXPECT_EQ(tree.structure, "bvh (static)");
  EXPECT_NE(tree.reason.find(bytes), std::string::npos) << tree.reason << "\nwithout" << bytes;
}

// Mending has cut the object's first triangle: its second piece stands at the end and has the first one's number.
TEST_F(WorldByHand, APieceOfAPlacedObjectsTriangleHasTheNumberOfTheFile) {
  Scene scene;
  scene.name = "scene";
  SceneObject object{.name = "scene/table"};
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 0, 0}};
  mesh->triangles = {{0, 1, 2}, {1, 4, 3}, {1, 3, 2}};
  object.shape.mesh = mesh;
  object.cut.piece_of = std::make_shared<const std::vector<std::uint32_t>>(1, 0U);
  scene.objects = {object};
  auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
  ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(indexed)));
  step();
  const auto told = [&](double x, double y) {
    const SnapshotRing::Lease lease = world.newest();
    const Answers answers = ask({.kind = QuestionKind::ray, .numbers = {}}, {x, y, 1, 0, 0, -1, INFINITY});
    const AnswerHit& hit = answers.hits.at(0);
    return lease->objects[slot_of(hit.object)]->reported_triangle(hit.triangle);
  };
  EXPECT_EQ(told(0.25, 0.25), 0U);
  EXPECT_EQ(told(1.25, 0.25), 1U);
  EXPECT_EQ(told(0.75, 0.75), 0U) << "the piece that stands last";
}

TEST_F(WorldByHand, ThePlanSaysWhatMovingThingsTake) {
  const auto row = [&](const std::string& structure) {
    const SnapshotRing::Lease lease = world.newest();
    for (const PlanRow& plan : plan_of(*lease, false)) {
      if (plan.structure == structure) return plan;
    }
    return PlanRow{};
  };
  define("table", {0, 0, -5}, ball(1), false);
  step();
  for (const char* structure : {"pair search", "swept test", "mesh x mesh"}) {
    EXPECT_FALSE(row(structure).built) << structure;
    EXPECT_NE(row(structure).saves, "") << structure;
  }
  EXPECT_EQ(row("pair search").reason, "nothing moves");
  define("ball", {0, 0, 0}, ball(1));
  define("rock", {3, 0, 0}, rock());
  step();
  for (const char* structure : {"pair search", "swept test", "mesh x mesh"}) {
    EXPECT_TRUE(row(structure).built) << structure;
    EXPECT_EQ(row(structure).saves, "") << structure;
  }
  EXPECT_EQ(row("pair search").reason, "2 movers");
  EXPECT_EQ(row("mesh x mesh").reason, "1 moving meshes");
}

// The ray meets the ball surely; whether it meets the edge of the wall before it, doubles cannot say.
TEST_F(WorldByHand, OneSureHitIsEnoughForWhoAsksForAnyAlone) {
  const Vec3 a(0.1, 0.3, 2), b(0.3, 0.9, 2.3), origin(0.7, -0.1, 0.3);
  const Vec3 direction = (a + b) / 2 - origin;
  define("ball", origin + 3 * direction, ball(0.5));
  Shape wall;
  wall.mesh = std::make_shared<const TriangleMesh>(TriangleMesh{{a, b, {-1, 1, 2}}, {{0, 1, 2}}});
  define("wall", {0, 0, 0}, wall);
  step();
  const std::vector<double> ray{origin.x(),    origin.y(),    origin.z(), direction.x(),
                                direction.y(), direction.z(), INFINITY};
  const auto asked = [&](HitMode mode, Level highest) {
    return ask({.kind = QuestionKind::ray, .mode = mode, .highest = highest, .numbers = {}}, ray);
  };
  EXPECT_EQ(asked(HitMode::any, Level::filter).answers.at(0), Verdict::hit);
  EXPECT_EQ(asked(HitMode::any, Level::filter).reasons.at(0), UndecidedReason::none);
  for (const HitMode mode : {HitMode::closest, HitMode::all}) {
    EXPECT_EQ(asked(mode, Level::filter).answers.at(0), Verdict::undecided) << "the wall may be the nearest";
    EXPECT_EQ(asked(mode, Level::filter).reasons.at(0), UndecidedReason::numeric);
    EXPECT_EQ(asked(mode, Level::rational).answers.at(0), Verdict::hit);
  }
}

TEST(WorldPlan, ProbesAreBuiltWhereSomebodyReadsThem) {
  EXPECT_FALSE(plan_of_probes(0, true).built);
  EXPECT_EQ(plan_of_probes(0, true).reason, "no ray is fixed to an object");
  EXPECT_FALSE(plan_of_probes(3, false).built);
  EXPECT_EQ(plan_of_probes(3, false).reason, "3 probes; nobody reads them");
  EXPECT_EQ(plan_of_probes(3, false).saves, "a ray a probe and step");
  EXPECT_TRUE(plan_of_probes(3, true).built);
  EXPECT_EQ(plan_of_probes(3, true).reason, "3 probes that somebody reads");
  EXPECT_EQ(plan_of_probes(3, true).saves, "");
}

TEST(WorldPlan, SearchesThatEndedAtTheirLimitAreTold) {
  EXPECT_TRUE(plan_of_cut_searches(2).built);
  EXPECT_EQ(plan_of_cut_searches(2).reason,
            "2 ended at their limit of looks so far: who came and went then may not have been told");
}

struct Surface {
  TriangleMesh mesh;
  Bvh tree = Bvh::build(mesh);
  std::vector<std::uint32_t> part_of = std::vector<std::uint32_t>(mesh.triangles.size(), 0);
  PartedSurface parted() const { return {mesh, tree, part_of}; }
};

// Without a cut: a sheet over a table says all of a surface over another, corners all of a hole.
TEST(WorldSurfaceDistance, TablesAndCornersSayMuchBeforeAnythingIsCut) {
  const DistanceOptions uncut{.pieces_at_most = 0, .cancelled = {}};
  TriangleMesh fan{{{-2, -2, 0.25}, {2, -2, 0.25}, {2, 2, 0.25}, {-2, 2, 0.25}, {1.5, 0.5, 0.25}},
                   {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  const Surface flat{square(2, 0)};
  const Surface raised{fan};
  EXPECT_NEAR(surface_distance(flat.parted(), raised.parted(), uncut), 0.25, 1e-4);
  const Surface half{{flat.mesh.vertices, {{0, 1, 2}}}};
  EXPECT_NEAR(surface_distance(flat.parted(), half.parted(), uncut), std::sqrt(8.0), 1e-6);
}

}  // namespace
}  // namespace collided::engine
