// A million bounces without a loss, and bodies that lose all at once.
#include <cmath>

#include <gtest/gtest.h>

#include "client/cli/publish/response/collision.hpp"
#include "tests/studies/response/event_driven.hpp"

namespace collided::response {
namespace {

TEST(ResponseLongRun, AMillionElasticBouncesKeepPeriodAndEnergy) {
  const double gravity = 9.81;
  EventDriven world({{1}, {0}, -gravity, 0}, {{1}, {0}}, 1);
  for (int bounce = 0; bounce < 1'000'000; ++bounce) ASSERT_TRUE(world.advance_to_impact());
  const double first = std::sqrt(2 / gravity);
  EXPECT_NEAR(world.time() / (first * (2e6 - 1)), 1, 1e-12);
  const double energy =
      0.5 * world.motion().velocity_m_s[0] * world.motion().velocity_m_s[0] + gravity * world.motion().position_m[0];
  EXPECT_NEAR(energy / gravity, 1, 1e-12);
  EXPECT_EQ(world.impacts(), 1'000'000U);
}

TEST(ResponseLongRun, EnergyOfACrowdStaysWithin1e12ACollision) {
  Line line{{}, {}, 0, 0, 10};
  Motion start;
  for (int body = 0; body < 20; ++body) {
    line.mass_kg.push_back(0.5 + 0.1 * body);
    line.radius_m.push_back(0.1);
    start.position_m.push_back(0.3 + 0.45 * body);
    start.velocity_m_s.push_back(std::sin(7.0 * body));
  }
  EventDriven world(line, start, 1);
  const double before = kinetic_energy(line, start);
  while (world.impacts() < 200'000) ASSERT_TRUE(world.advance_to_impact());
  const double after = kinetic_energy(line, world.motion());
  EXPECT_LT(std::abs(after - before) / before, 1e-12);
  for (std::size_t body = 1; body < line.size(); ++body) EXPECT_GT(gap(line, world.motion().position_m, body), -1e-13);
}

TEST(ResponseLongRun, WithoutRestitutionBodiesGoOnTogether) {
  EventDriven world({{1, 3}, {0.1, 0.1}}, {{0, 1}, {2, 0}}, 0, 1e-12);
  world.advance(1000);
  EXPECT_EQ(world.impacts(), 1U);
  EXPECT_EQ(world.motion().velocity_m_s[0], 0.5);
  EXPECT_EQ(world.motion().velocity_m_s[1], 0.5);
  EXPECT_NEAR(world.motion().position_m[1] - world.motion().position_m[0], 0.2, 1e-12);
}

// A point in the unit cube, 15,000 reflections: each coordinate is back where it began, since a turn of the wall is exact.
TEST(ResponseLongRun, ABilliardIsBackAfterAThousandSeconds) {
  const Vec3 start(1.0 / 3 - 0.5, 1.0 / 5 - 0.5, 1.0 / 7 - 0.5);
  Vec3 position = start;
  Vec3 velocity(3, 5, 7);
  Eigen::Vector3i hits(0, 0, 0);
  for (int step = 0; step < 64'000; ++step) {
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] += velocity[axis] / 64;
      hits[axis] += mirror_between_walls(position[axis], velocity[axis], 0.5, 1);
    }
  }
  EXPECT_EQ(hits, Eigen::Vector3i(3000, 5000, 7000));
  EXPECT_NEAR((position - start).norm(), 0, 64'000 * 1e-16);
  EXPECT_EQ(velocity, Vec3(3, 5, 7));
}

TEST(ResponseLongRun, AStepAcrossALossyCubeManyTimesLosesAtEachWall) {
  double position = 0;
  double velocity = 8;
  position += velocity;  // 1 to the wall, then half as fast each way
  EXPECT_TRUE(mirror_between_walls(position, velocity, 1, 0.5));
  // 7 beyond: 3.5 back, 1.5 beyond the other: 0.75 back.
  EXPECT_EQ(position, -0.25);
  EXPECT_EQ(velocity, 2);
}

}  // namespace
}  // namespace collided::response
