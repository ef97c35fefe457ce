// Every value of an event, compared with one known by hand, whichever of the two was there first and whichever moves.
#include <gtest/gtest.h>

#include <cmath>

#include "server/world/query/query.hpp"
#include "server/world/world.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kStepSecond = 1'000'000'000;

ObjectDefinition object(const std::string& name, const Primitive& primitive, const Vec3& at) {
  ObjectDefinition definition;
  definition.name = name;
  definition.shape.primitives = {primitive};
  definition.pose.position = at;
  return definition;
}

/// A sheet at z = 0 of two triangles; the second one is where x > y.
ObjectDefinition sheet(const std::string& name) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{-9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, {9, -9, 0}};
  mesh->triangles = {{0, 1, 2}, {0, 3, 1}};
  ObjectDefinition definition;
  definition.name = name;
  definition.shape.mesh = mesh;
  return definition;
}

Pose at(double x, double y, double z) { return {.position = {x, y, z}, .rotation = Quat::Identity()}; }

class WorldStepValues : public testing::Test {
 protected:
  ObjectId define(const ObjectDefinition& definition) { return std::get<ObjectId>(world.define(definition)); }
  void step(std::int64_t time_ns) { ASSERT_TRUE(world.step(time_ns, 1, {.contacts = true, .persisted = true})); }
  const Event& event(std::size_t i) const { return world.events().at(i); }
  World world{WorldOptions{}};
};

struct Passing {
  const char* name;
  bool ball;         // else a box, which is swept as a body
  bool mover_first;  // has the lower id
  bool sheet_moves;  // else the mover does
};

class WorldPassing : public WorldStepValues, public testing::WithParamInterface<Passing> {};

// From 1 m above a sheet to 3 m below it within a second: first contact after 0.75 m of 4 m, 0.8125 s before the end, and
// the last one after 1.25 m.
TEST_P(WorldPassing, TellsWhereWhenHowFastAndInWhichDirection) {
  const Passing& how = GetParam();
  const Primitive shape = how.ball ? Primitive(Sphere{Vec3::Zero(), 0.25})
                                   : Primitive(Box{.center = Vec3::Zero(), .half_m = {0.25, 0.125, 0.25}});
  const ObjectDefinition mover = object("mover", shape, {3, 1, 1});
  const ObjectId first = define(how.mover_first ? mover : sheet("sheet"));
  const ObjectId second = define(how.mover_first ? sheet("sheet") : mover);
  const ObjectId moving = how.mover_first != how.sheet_moves ? first : second;
  // Two poses before the way that counts, so that both have a speed to be told.
  step(1 * kStepSecond);
  world.move(moving, how.sheet_moves ? at(0, 0, 0) : at(3, 1, 1), 2 * kStepSecond, false);
  step(2 * kStepSecond);
  ASSERT_TRUE(world.events().empty());
  world.move(moving, how.sheet_moves ? at(0, 0, 4) : at(3, 1, -3), 3 * kStepSecond, false);
  step(3 * kStepSecond);
  ASSERT_EQ(world.events().size(), 2u);
  const double height_m = how.sheet_moves ? 0.75 : 0;
  const double down = how.mover_first ? -1 : 1;  // from the mover to the sheet, or from the sheet to the mover
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(event(i).kind, i == 0 ? EventKind::began : EventKind::ended);
    EXPECT_EQ(event(i).reason, i == 0 ? EndReason::none : EndReason::separated);
    EXPECT_EQ(event(i).of.a, first);
    EXPECT_EQ(event(i).of.b, second);
    EXPECT_EQ(event(i).of.a_triangle, how.mover_first ? kNoTriangle : 1u);
    EXPECT_EQ(event(i).of.b_triangle, how.mover_first ? 1u : kNoTriangle);
    EXPECT_NEAR((event(i).of.contact.normal - Vec3(0, 0, down)).norm(), 0, 1e-6)
        << event(i).of.contact.normal.transpose();
    if (how.ball && !how.sheet_moves) {
      EXPECT_NEAR(event(i).of.contact.point.x(), 3, 1e-6);
      EXPECT_NEAR(event(i).of.contact.point.y(), 1, 1e-6);
      EXPECT_NEAR(event(i).of.contact.point.z(), height_m, 1e-5);
    }
    EXPECT_NEAR(event(i).of.contact.depth_m, 0, 1e-5);
    EXPECT_EQ(event(i).of.episode, event(0).sequence);
    EXPECT_NEAR(static_cast<double>(event(i).of.began_ns), 2.1875e9, 1e4);
  }
  EXPECT_GE(event(0).bracket_low_s, 0.8125);
  EXPECT_LE(event(0).bracket_high_s, 0.8125);
  EXPECT_NEAR(event(0).bracket_low_s, event(0).bracket_high_s, 2e-6);
  EXPECT_GE(event(1).bracket_low_s, 0.6875);
  EXPECT_LE(event(1).bracket_high_s, 0.6875);
  EXPECT_NEAR(event(1).bracket_low_s, event(1).bracket_high_s, 2e-6);
  // The mover goes down at 4 m/s as seen from the sheet, whichever of them moves.
  EXPECT_NEAR((event(0).relative_velocity - Vec3(0, 0, how.mover_first ? 4 : -4)).norm(), 0, 1e-9)
      << event(0).relative_velocity.transpose();
  EXPECT_EQ(event(1).relative_velocity, Vec3(0, 0, 0));
  EXPECT_TRUE(world.contacts().empty());
}

INSTANTIATE_TEST_SUITE_P(
    EveryOrder, WorldPassing,
    testing::Values(Passing{"BallFirst", true, true, false}, Passing{"BallSecond", true, false, false},
                    Passing{"BoxFirst", false, true, false}, Passing{"BoxSecond", false, false, false},
                    Passing{"SheetPastBallFirst", true, true, true}, Passing{"SheetPastBallSecond", true, false, true},
                    Passing{"SheetPastBoxFirst", false, true, true}, Passing{"SheetPastBoxSecond", false, false, true}),
    [](const auto& how) { return std::string(how.param.name); });

// Against a part of a static scene: the part was there first, or the mover was.
TEST_F(WorldStepValues, AStaticPartIsToldWithItsOwnTriangleInBothOrders) {
  for (const bool is_part_first : {true, false}) {
    for (const auto& [passes, is_box] : {std::pair(true, false), std::pair(false, false), std::pair(true, true)}) {
      World here(WorldOptions{});
      ObjectId ball = 0;
      const Primitive shape = is_box ? Primitive(Box{.center = Vec3::Zero(), .half_m = {0.125, 0.25, 0.25}})
                                     : Primitive(Sphere{Vec3::Zero(), 0.25});
      const auto define_ball = [&] { ball = std::get<ObjectId>(here.define(object("ball", shape, {3, 1, 1}))); };
      if (!is_part_first) define_ball();
      Scene scene{.name = "hall"};
      scene.mesh.vertices = {{-9, -9, -5}, {9, 9, -5}, {-9, 9, -5}, {-9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, {9, -9, 0}};
      scene.mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {3, 6, 4}};
      scene.parts = {{.name = "hall/cellar", .first_triangle = 0, .triangle_count = 1, .filter = {}},
                     {.name = "hall/floor", .first_triangle = 1, .triangle_count = 2, .filter = {}}};
      const auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
      ASSERT_TRUE(std::holds_alternative<std::uint32_t>(here.add_scene(indexed)));
      if (is_part_first) define_ball();
      here.step(1 * kStepSecond, 1, {});
      here.move(ball, at(3, 1, 1), 2 * kStepSecond, false);
      here.step(2 * kStepSecond, 1, {});
      here.move(ball, at(3, 1, passes ? -1 : 0.125), 3 * kStepSecond, false);
      here.step(3 * kStepSecond, 1, {});
      ASSERT_EQ(here.events().size(), passes ? 2u : 1u);
      const Event& began = here.events()[0];
      EXPECT_EQ(here.info(is_part_first ? began.of.a : began.of.b)->name, "hall/floor");
      EXPECT_EQ(is_part_first ? began.of.a_triangle : began.of.b_triangle, 1u);
      EXPECT_EQ(is_part_first ? began.of.b_triangle : began.of.a_triangle, kNoTriangle);
      EXPECT_NEAR((began.of.contact.normal - Vec3(0, 0, is_part_first ? 1 : -1)).norm(), 0, 1e-9);
      EXPECT_NEAR(began.of.contact.depth_m, passes ? 0 : 0.125, is_box ? 1e-5 : 1e-8);
      // 2 m/s for 0.75 m; or 0.875 m/s, of 0.875 m 0.75.
      const double before_s = passes ? 1 - 0.375 : 1 - 0.75 / 0.875;
      EXPECT_NEAR(began.bracket_low_s, before_s, is_box ? 2e-6 : 1e-8);
      EXPECT_NEAR(began.bracket_high_s, before_s, is_box ? 2e-6 : 1e-8);
      EXPECT_NEAR(began.relative_velocity.z(), (passes ? 2 : 0.875) * (is_part_first ? -1 : 1), 1e-9);
    }
  }
}

// Two that move at once: each has half of the speed, the contact is in the middle.
TEST_F(WorldStepValues, TwoThatMeetOnTheirWaysAreToldInTheOrderOfTheirIds) {
  for (const bool left_first : {true, false}) {
    for (const bool has_boxes : {true, false}) {
      World here(WorldOptions{});
      const Primitive shape = has_boxes ? Primitive(Box{.center = Vec3::Zero(), .half_m = Vec3::Constant(0.5)})
                                        : Primitive(Sphere{Vec3::Zero(), 0.5});
      const auto define_at = [&](double x) {
        return std::get<ObjectId>(here.define(object(x < 0 ? "left" : "right", shape, {x, 0, 0})));
      };
      const ObjectId first = define_at(left_first ? -8 : 8);
      const ObjectId second = define_at(left_first ? 8 : -8);
      const ObjectId left = left_first ? first : second;
      const ObjectId right = left_first ? second : first;
      here.step(1 * kStepSecond, 1, {});
      for (const double x : {8.0, -8.0}) {
        const std::int64_t now_ns = (x > 0 ? 2 : 3) * kStepSecond;
        here.move(left, at(-x, 0, 0), now_ns, false);
        here.move(right, at(x, 0, 0), now_ns, false);
        here.step(now_ns, 1, {});
      }
      ASSERT_EQ(here.events().size(), 2u);
      const Event& began = here.events()[0];
      const double to_second = left_first ? 1 : -1;
      EXPECT_EQ(began.of.a, first);
      EXPECT_EQ(began.of.b, second);
      EXPECT_NEAR((began.of.contact.normal - Vec3(to_second, 0, 0)).norm(), 0, 1e-5);
      EXPECT_NEAR((began.relative_velocity - Vec3(-32 * to_second, 0, 0)).norm(), 0, 1e-9);
      EXPECT_NEAR(began.bracket_low_s, 1 - 7.5 / 16, 1e-5);
      EXPECT_NEAR(began.bracket_high_s, 1 - 7.5 / 16, 1e-5);
      EXPECT_NEAR(here.events()[1].bracket_low_s, 1 - 8.5 / 16, 1e-5);
      EXPECT_NEAR(here.events()[1].bracket_high_s, 1 - 8.5 / 16, 1e-5);
    }
  }
}

TEST_F(WorldStepValues, ASlowContactBeganAndEndedWhereItsWaySays) {
  const ObjectId box = define(object("box", Box{.center = Vec3::Zero(), .half_m = Vec3::Constant(0.5)}, {3, 1, 0.75}));
  define(sheet("sheet"));
  step(1 * kStepSecond);
  world.move(box, at(3, 1, 0.625), 2 * kStepSecond, false);
  step(2 * kStepSecond);
  world.move(box, at(3, 1, 0.4375), 5 * kStepSecond / 2, false);
  step(11 * kStepSecond / 4);
  ASSERT_EQ(world.events().size(), 1u);
  // Two thirds of the way from 2.0 s to 2.5 s.
  EXPECT_GE(event(0).bracket_low_s, 5.0 / 12);
  EXPECT_LE(event(0).bracket_high_s, 5.0 / 12);
  EXPECT_LE(event(0).bracket_low_s - event(0).bracket_high_s, 2e-6);
  EXPECT_NEAR(static_cast<double>(event(0).of.began_ns), 7e9 / 3, 1e3);
  EXPECT_NEAR(event(0).relative_velocity.z(), 0.375, 1e-12) << "of the sheet against the box";
  EXPECT_NEAR(event(0).of.contact.depth_m, 0.0625, 1e-12);
  world.move(box, at(3, 1, 0.45), 3 * kStepSecond, false);
  step(3 * kStepSecond);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(event(0).kind, EventKind::persisted);
  EXPECT_NEAR(event(0).of.contact.depth_m, 0.05, 1e-12);
  EXPECT_NEAR(event(0).relative_velocity.z(), -0.025, 1e-12);
  world.move(box, at(3, 1, 0.75), 4 * kStepSecond, false);
  step(9 * kStepSecond / 2);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(event(0).kind, EventKind::ended);
  // A sixth of the way from 3.0 s to 4.0 s.
  EXPECT_GE(event(0).bracket_low_s, 8.0 / 6);
  EXPECT_LE(event(0).bracket_high_s, 8.0 / 6);
  EXPECT_LE(event(0).bracket_low_s - event(0).bracket_high_s, 2e-6);
  EXPECT_NEAR(event(0).of.contact.depth_m, 0.05, 1e-12) << "as it last was";
}

// A publisher's clock is set back: what is measured in object time stays in order.
TEST_F(WorldStepValues, TheTimeOfAnObjectDoesNotGoBackWithItsPublishersClock) {
  const ObjectId ball = define(object("ball", Sphere{Vec3::Zero(), 0.25}, {3, 1, 5}));
  define(sheet("sheet"));
  step(1 * kStepSecond);
  world.move(ball, at(3, 1, 4), 3 * kStepSecond, false);
  step(3 * kStepSecond);
  const auto posed_ns = [&] { return world.newest()->posed_ns[slot_of(ball)]; };
  ASSERT_EQ(posed_ns(), 3 * kStepSecond);
  world.move(ball, at(3, 1, 0), 1 * kStepSecond, false);
  step(4 * kStepSecond);
  EXPECT_EQ(posed_ns(), 3 * kStepSecond);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_GE(event(0).bracket_low_s, event(0).bracket_high_s) << "began before it began";
  EXPECT_LE(event(0).bracket_low_s, 1.0) << "at 3 s it did not touch";
  EXPECT_GE(event(0).of.began_ns, 3 * kStepSecond);
  EXPECT_EQ(event(0).relative_velocity, Vec3(0, 0, 0)) << "a way without time has no speed";
  world.move(ball, at(3, 1, 5), 5 * kStepSecond, false);
  step(5 * kStepSecond);
  EXPECT_EQ(posed_ns(), 5 * kStepSecond) << "once its clock is past that, it goes on";
}

// The age of an answer is that of the oldest pose among those that decided it.
TEST_F(WorldStepValues, AnAnswerIsAsOldAsTheOldestPoseThatDecidedIt) {
  const ObjectId low = define(object("low", Sphere{Vec3::Zero(), 0.25}, {0, 0, 1}));
  const ObjectId high = define(object("high", Sphere{Vec3::Zero(), 0.25}, {0, 0, 3}));
  ObjectDefinition post = object("post", Sphere{Vec3::Zero(), 0.25}, {0, 0, 5});
  post.moving = false;
  define(post);
  step(7);
  const auto oldest_ns = [&](HitMode mode, double length_m, const std::string& skip = {}) {
    const std::vector<double> ray{0, 0, 0, 0, 0, 1, length_m};
    Answers answers;
    QueryScratch scratch;
    answer(*world.newest(), {.kind = QuestionKind::ray, .mode = mode, .skip = skip, .numbers = ray}, answers, scratch);
    return answers.oldest_pose_ns;
  };
  using enum HitMode;
  EXPECT_EQ(oldest_ns(all, 9), 7) << "a definition is of the step that shows it";
  world.move(low, at(0, 0, 1), 20, false);
  world.move(high, at(0, 0, 3), 10, false);
  step(30);
  EXPECT_EQ(oldest_ns(all, 9), 10);
  EXPECT_EQ(oldest_ns(closest, 9), 20) << "the nearer one decided alone";
  EXPECT_EQ(oldest_ns(all, 9, "high"), 20);
  EXPECT_EQ(oldest_ns(all, 9, "*h*"), 20);
  EXPECT_EQ(oldest_ns(closest, 9, "[lh]*"), -1) << "what never moves has no age";
  EXPECT_EQ(oldest_ns(all, 0.5), -1);
  world.move(high, at(0, 0, 3), 40, false);
  step(40);
  EXPECT_EQ(oldest_ns(all, 9), 20);
}

// A thin blade turns within a step over a post that it touches in neither of its two poses.
TEST_F(WorldStepValues, ABladeThatTurnsFastMeetsWhatStandsBetweenItsPoses) {
  for (const double angle : {0.02, 0.1, 0.5, M_PI / 2, 3.0}) {
    World here(WorldOptions{});
    ObjectDefinition post =
        object("post", Sphere{Vec3::Zero(), 1e-6}, {2 * std::cos(angle / 2), 2 * std::sin(angle / 2), 0});
    post.moving = false;
    here.define(post);
    const ObjectId blade = std::get<ObjectId>(
        here.define(object("blade", Box{.center = {1.5, 0, 0}, .half_m = {0.6, 0.002, 0.01}}, {0, 0, 0})));
    here.step(1 * kStepSecond, 1, {});
    here.move(blade, {.position = Vec3::Zero(), .rotation = Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()))},
              2 * kStepSecond, false);
    here.step(2 * kStepSecond, 1, {});
    ASSERT_EQ(here.events().size(), 2u) << angle;
    EXPECT_GT(here.events()[0].bracket_low_s, 0.5) << "half way, less half of the blade";
    EXPECT_LT(here.events()[0].bracket_high_s, 0.56) << angle;
    // The post was there first; at 2 m from the axis the blade goes 2 m a radian, across the direction to the post.
    const Vec3 across(-std::sin(angle / 2), std::cos(angle / 2), 0);
    EXPECT_NEAR((here.events()[0].relative_velocity - 2 * angle * across).norm(), 0, 0.01 * angle) << angle;
  }
}

}  // namespace
}  // namespace collided::engine
