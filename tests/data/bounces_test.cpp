#include <cmath>
#include <cstdio>

#include "tests/data/recorded.hpp"

namespace collided::recorded {
using namespace engine;
namespace {

class RecordedBounces : public RecordedReality {};

/// How often something began to touch, in steps (0: the first), of one recording of poses.
struct Story {
  std::vector<int> began;
  int times_met = 0;  // by frames: how often it touches at one and did not at the one before
  bool touches_at_start = false;
  bool touches_at_end = false;
};

Story play(Stage& stage, const Rows& rows, std::size_t first, std::size_t end, const Shape& shape, bool turns) {
  const auto pose = [&](std::size_t row) { return turns ? rows.pose(row) : Pose{.position = rows.point(row)}; };
  const ObjectId mover = stage.add("mover", shape, pose(first), true);
  Story story;
  bool touched = false;
  for (std::size_t row = first; row < end; ++row) {
    if (row > first) stage.move(mover, pose(row));
    stage.step();
    for (const Event& event : stage.world().events()) {
      if (event.kind == EventKind::began) story.began.push_back(static_cast<int>(row - first));
    }
    const bool touches = !stage.touching().empty();
    if (row == first) story.touches_at_start = touches;
    story.times_met += touches && !touched ? 1 : 0;
    touched = touches;
  }
  story.touches_at_end = !stage.touching().empty();
  stage.world().remove(mover, EndReason::removed);
  stage.step();
  return story;
}

/// The frame before which the vertical velocity changes most.
int largest_jump(const Rows& rows, std::size_t first, std::size_t end) {
  int frame = 0;
  double most = 0;
  for (std::size_t row = first + 1; row < end; ++row) {
    const double jump = std::abs(rows.number(row, "vz") - rows.number(row - 1, "vz"));
    if (jump <= most) continue;
    most = jump;
    frame = static_cast<int>(row - first);
  }
  return frame;
}

// 285 tosses of an acrylic cube onto a table, filmed at 148 Hz: it begins in the air, first touches where its lowest
// corner first is at the ground or below, within two frames of the jump in the recorded velocity in nine tosses of ten,
// and ends lying.
TEST_F(RecordedBounces, TossedCubesLandWhenTheirVelocityJumps) {
  const Rows rows(data_ / "cube_tosses/tosses.csv.gz"), expected(data_ / "cube_tosses/expected.csv");
  Stage stage;
  Shape ground, cube;
  ground.primitives = {Box{.center = {0, 0, -50}, .half_m = {100, 100, 50}}};
  cube.primitives = {Box{.center = Vec3::Zero(), .half_m = Vec3::Constant(0.0524)}};
  stage.add("ground", ground, {}, false);
  int near_jump = 0, same_frame = 0, same_intervals = 0;
  const auto tosses = rows.groups("toss");
  ASSERT_EQ(tosses.size(), expected.size());
  for (std::size_t i = 0; i < tosses.size(); ++i) {
    const auto [first, end] = tosses[i];
    ASSERT_EQ(rows.integer(first, "toss"), expected.integer(i, "toss"));
    const Story story = play(stage, rows, first, end, cube, true);
    EXPECT_FALSE(story.touches_at_start) << i;
    EXPECT_TRUE(story.touches_at_end) << i;
    ASSERT_FALSE(story.began.empty()) << i;
    same_frame += story.began[0] == expected.integer(i, "first_contact_frame");
    same_intervals += story.times_met == expected.integer(i, "contact_intervals_at_z0");
    // Between two frames it may leave the table and come back.
    EXPECT_GE(static_cast<int>(story.began.size()), story.times_met) << i;
    near_jump += std::abs(story.began[0] - largest_jump(rows, first, end)) <= 2;
  }
  std::printf(
      "%zu tosses: first contact in the expected frame %d, as many contacts as expected %d, within 2 frames of the "
      "jump %d (%.1f %%)\n",
      tosses.size(), same_frame, same_intervals, near_jump, 100.0 * near_jump / static_cast<double>(tosses.size()));
  EXPECT_EQ(tosses.size(), 285u);
  EXPECT_EQ(same_frame, 285);
  EXPECT_EQ(same_intervals, 285);
  EXPECT_GE(near_jump, 0.9 * 285);
}

// 73 throws of a table tennis ball, filmed at 100 Hz: each bounces once, at the sample where its path turns.
TEST_F(RecordedBounces, ThrownBallsBounceOnce) {
  const Rows rows(data_ / "table_tennis/balls.csv.gz"), expected(data_ / "table_tennis/expected.csv");
  Stage stage;
  Shape table, ball;
  table.primitives = {Box{.center = {1, 1.75, -0.465}, .half_m = {1, 1.45, 0.035}}};
  ball.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = 0.02}};
  stage.add("table", table, {}, false);
  int once = 0, in_time = 0;
  const auto throws = rows.groups("throw");
  ASSERT_EQ(throws.size(), expected.size());
  for (std::size_t i = 0; i < throws.size(); ++i) {
    const auto [first, end] = throws[i];
    const Story story = play(stage, rows, first, end, ball, false);
    EXPECT_EQ(story.began.size(), 1u) << "throw " << i;
    EXPECT_FALSE(story.touches_at_start || story.touches_at_end) << "throw " << i;
    once += story.began.size() == 1 ? 1 : 0;
    in_time +=
        !story.began.empty() && std::abs(story.began[0] - expected.integer(i, "first_contact_sample")) <= 1 ? 1 : 0;
  }
  std::printf("%zu throws: one bounce %d, within a sample of the expected one %d\n", throws.size(), once, in_time);
  EXPECT_EQ(once, 73);
  EXPECT_EQ(in_time, 73);
}

}  // namespace
}  // namespace collided::recorded
