// Half a turn a step and more: a body's bounds change completely between two poses, and whoever keeps or grows the old
// ones looks in the wrong place.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::fast_rotation_test {
namespace {

// Turning by a third about (1, 1, 1) renames the axes: exact, so that kissing is decided to the step.
const Quat kThird(0.5, 0.5, 0.5, 0.5);

std::size_t count_of_contacts(const std::vector<Event>& events, EventKind kind) {
  return static_cast<std::size_t>(std::count_if(events.begin(), events.end(), [&](const Event& event) {
    return event.kind == kind && event.of.doubt == Doubt::none;
  }));
}

TEST(ExtremeFastRotation, ARodThatRenamesItsAxesTouchesToTheStep) {
  for (const double gap : {0.0, 0x1p-49}) {
    extreme::Stage stage;
    // Round at its ends: the corners of a box would come nearer on the way than its sides do at the ends of it.
    Shape round;
    round.primitives = {Capsule{{-9.875, 0, 0}, {9.875, 0, 0}, 0.125}};
    const ObjectId rod = stage.add("rod", round, extreme::at({0, 0, 0}));
    stage.ball("end_x", {11 + gap, 0, 0}, 1);
    stage.ball("end_y", {0, 11 + gap, 0}, 1);
    stage.ball("end_z", {0, 0, 11 + gap}, 1);
    const std::size_t touching = gap == 0 ? 1 : 0;
    EXPECT_EQ(stage.step().size(), touching);
    Quat turned = Quat::Identity();
    for (int i = 0; i < 300; ++i) {
      turned = Quat(i % 3 == 2 ? Quat(Quat::Identity()) : i % 3 == 1 ? Quat(-0.5, 0.5, 0.5, 0.5) : kThird);
      stage.move(rod, extreme::at({0, 0, 0}, turned));
      stage.step();
      // Less than a rounding away, its way is in doubt, and that is told as what it is.
      ASSERT_EQ(count_of_contacts(stage.world.events(), EventKind::began), touching) << i;
      ASSERT_EQ(count_of_contacts(stage.world.events(), EventKind::ended), touching) << i;
      ASSERT_EQ(extreme::open_pairs(stage.world).size(), touching);
    }
  }
}

TEST(ExtremeFastRotation, AMeshThatTurnsIsFoundWhereItIs) {
  TriangleMesh blade;
  blade.vertices = {{0, 0, 0}, {10, 0, 0}, {10, 0.125, 0}};
  blade.triangles = {{0, 1, 2}};
  extreme::Stage stage;
  const ObjectId rotor = stage.add("rotor", extreme::mesh_shape(blade), extreme::at({0, 0, 0}));
  stage.step();
  // By half a turn about z, exact too: (x, y) -> (-x, -y).
  stage.move(rotor, extreme::at({0, 0, 0}, Quat(0, 0, 0, 1)));
  stage.step();
  EXPECT_TRUE(extreme::is_hit(stage.ray({-9, -0.0625, 1}, {0, 0, -1})));
  EXPECT_TRUE(extreme::is_miss(stage.ray({9, 0.0625, 1}, {0, 0, -1})));
  stage.move(rotor, extreme::at({0, 0, 0}, kThird));
  stage.step();
  EXPECT_TRUE(extreme::is_hit(stage.ray({1, 9, 0.0625}, {-1, 0, 0}))) << "(x, y, z) -> (z, x, y)";
  EXPECT_TRUE(extreme::is_miss(stage.ray({-9, -0.0625, 1}, {0, 0, -1})));
}

// An off-centre ball's way is declared to be the chord between its two places: half a turn leads through the hub.
TEST(ExtremeFastRotation, AnOffCentreBallSweepsItsChord) {
  Shape bob;
  bob.primitives = {Sphere{{4, 0, 0}, 0.5}};
  extreme::Stage stage;
  const ObjectId pendulum = stage.add("pendulum", bob, extreme::at({0, 0, 0}));
  stage.ball("hub", {0, 0, 0}, 0.5);
  stage.ball("on_the_arc", {0, 4, 0}, 0.5);
  EXPECT_TRUE(stage.step().empty());
  stage.move(pendulum, extreme::at({0, 0, 0}, Quat(0, 0, 0, 1)));
  ASSERT_EQ(stage.step().size(), 2u);
  EXPECT_EQ(stage.world.info(stage.world.events()[0].of.b)->name, "hub");
  EXPECT_NEAR(stage.world.events()[0].bracket_low_s, 5.0 / 8, 1e-8) << "at 3/8 of the way, (4 - 1) of 8 m";
}

}  // namespace
}  // namespace collided::engine::fast_rotation_test
