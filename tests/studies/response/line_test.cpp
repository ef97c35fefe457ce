#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/response/line.hpp"

namespace collided::response {
namespace {

TEST(ResponseFlight, TheGapIsZeroWhenItSaysAndClosing) {
  for (const double acceleration : {-9.81, 0.0, 2.0}) {
    for (const double rate : {-3.0, -1e-3, 0.0, 2.0}) {
      const double seconds = time_to_touch(0.5, rate, acceleration);
      if (!std::isfinite(seconds)) {
        EXPECT_GE(acceleration + (rate < -1.5 ? -1 : 0), 0) << rate;
        continue;
      }
      EXPECT_NEAR(0.5 + seconds * (rate + 0.5 * acceleration * seconds), 0, 1e-15 * (1 + seconds));
      EXPECT_LE(rate + acceleration * seconds, 0);
    }
  }
}

/// Two balls of 2 and 3 kg between walls at 0 and 10, pulled down.
Line two_balls() {
  return {.mass_kg = {2, 3}, .radius_m = {0.5, 1}, .gravity_m_s2 = -10, .low_wall_m = 0, .high_wall_m = 10};
}

TEST(ResponseLine, EveryContactHasItsOwnGapRateAndFreeAcceleration) {
  const Line line = two_balls();
  const Motion motion{.position_m = {2, 6}, .velocity_m_s = {-1, 3}};
  const std::vector<double> gaps{1.5, 2.5, 3}, rates{-1, 4, -3}, accelerations{-10, 0, 10};
  for (std::size_t contact = 0; contact <= line.size(); ++contact) {
    EXPECT_EQ(gap(line, motion.position_m, contact), gaps[contact]) << contact;
    EXPECT_EQ(gap_rate(line, motion.velocity_m_s, contact), rates[contact]) << contact;
    EXPECT_EQ(free_gap_acceleration(line, contact), accelerations[contact]) << contact;
  }
  EXPECT_EQ(line.reduced_mass(0), 2);
  EXPECT_DOUBLE_EQ(line.reduced_mass(1), 1.2);
  EXPECT_EQ(line.reduced_mass(2), 3);
}

TEST(ResponseLine, EnergyMomentumAndDepthAreThoseOfAllBodies) {
  const Line line = two_balls();
  const Motion motion{.position_m = {2, 6}, .velocity_m_s = {-1, 3}};
  EXPECT_EQ(kinetic_energy(line, motion), 1 + 13.5);
  EXPECT_EQ(gravity_energy(line, motion), 10 * (2 * 2 + 3 * 6));
  EXPECT_EQ(momentum(line, motion), -2 + 9);
  EXPECT_EQ(deepest_penetration(line, motion), 0);
  EXPECT_EQ(deepest_penetration(line, {.position_m = {2, 9.25}, .velocity_m_s = {0, 0}}), 0.25);
  EXPECT_EQ(deepest_penetration(line, {.position_m = {5, 6}, .velocity_m_s = {0, 0}}), 0.5);
  EXPECT_EQ(largest_coordinate(line, {.position_m = {-7, 6}, .velocity_m_s = {0, 0}}), 7);
  EXPECT_EQ(largest_coordinate(line, {.position_m = {0, 0}, .velocity_m_s = {0, 0}}), 1) << "a radius";
}

// A flight is a parabola: its gaps meet the same one from their own rates and accelerations.
TEST(ResponseLine, AFlightKeepsEveryGapsEquation) {
  const Line line = two_balls();
  Motion motion{.position_m = {2, 6}, .velocity_m_s = {-1, 3}};
  const Motion start = motion;
  const double seconds = 0.25;
  fly(line, motion, seconds);
  EXPECT_DOUBLE_EQ(motion.velocity_m_s[0], -3.5);
  EXPECT_DOUBLE_EQ(motion.velocity_m_s[1], 0.5);
  for (std::size_t contact = 0; contact <= line.size(); ++contact) {
    const double rate = gap_rate(line, start.velocity_m_s, contact),
                 acceleration = free_gap_acceleration(line, contact);
    EXPECT_NEAR(gap(line, motion.position_m, contact),
                gap(line, start.position_m, contact) + seconds * (rate + 0.5 * acceleration * seconds), 1e-14);
  }
}

// A ball that leaves the floor at 1 m/s is back after 2 v / g, not at once.
TEST(ResponseFlight, ABounceDoesNotMeetItsOwnStart) {
  EXPECT_DOUBLE_EQ(time_to_touch(0, 1, -10), 0.2);
  EXPECT_DOUBLE_EQ(time_to_touch(-1e-17, 1, -10), 0.2);
  EXPECT_EQ(time_to_touch(0, -1, 0), 0);
}

}  // namespace
}  // namespace collided::response
