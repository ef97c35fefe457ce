#include <cmath>

#include <gtest/gtest.h>

#include "client/response/damper.hpp"
#include "client/response/line.hpp"

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

TEST(ResponseDamper, ItsRestitutionIsThatOfTheContactItself) {
  for (const double ratio : {0.0, 0.01, 0.2, 0.5, 0.70710678118654752, 0.9, 1.0, 1.5, 5.0}) {
    const ContactPhase phase({.stiffness_n_m = 1e4, .damping_ratio = ratio}, 2.0, 3.0, 0);
    const double leaves = -phase.depth_rate(phase.duration());
    EXPECT_NEAR(leaves / 3.0, restitution_of_damping(ratio), 1e-9) << ratio;
  }
}

TEST(ResponseDamper, RestitutionAndDampingAreInverse) {
  for (const double restitution : {1e-3, 0.01, 0.1, 0.25, 0.5, 0.9, 0.999, 1.0}) {
    EXPECT_NEAR(restitution_of_damping(damping_of_restitution(restitution)), restitution, 2e-15) << restitution;
  }
  EXPECT_EQ(damping_of_restitution(1), 0);
}

TEST(ResponseDamper, ARestitutionThatNoDamperGivesIsRefused) {
  EXPECT_THROW((void)damping_of_restitution(9e-4), std::invalid_argument);
  EXPECT_THROW((void)damping_of_restitution(1.0001), std::invalid_argument);
  EXPECT_THROW((void)damping_of_restitution(std::nan("")), std::invalid_argument);
}

// The closed form satisfies its own equation m y" + d y' + k y = load, by differences, damped and not, loaded and not.
TEST(ResponseContactPhase, SolvesItsEquation) {
  for (const double ratio : {0.0, 0.3, 2.0}) {
    for (const double load : {0.0, 20.0}) {
      const Spring spring{.stiffness_n_m = 100, .damping_ratio = ratio};
      const ContactPhase phase(spring, 1, 2, load);
      EXPECT_NEAR(phase.depth(0), 0, 1e-15);
      EXPECT_NEAR(phase.depth_rate(0), 2, 1e-14);
      for (double t = 0.01; t < 0.3; t += 0.01) {
        const double h = 1e-6;  // differences of it are within h^2 times the third derivative, 1e-9 and 1e-7
        const double acceleration = (phase.depth_rate(t + h) - phase.depth_rate(t - h)) / (2 * h);
        EXPECT_NEAR((phase.depth(t + h) - phase.depth(t - h)) / (2 * h), phase.depth_rate(t), 1e-9);
        EXPECT_NEAR(acceleration + spring.damping(1) * phase.depth_rate(t) + 100 * phase.depth(t), load, 1e-7);
      }
    }
  }
}

TEST(ResponseContactPhase, AnUndampedContactLastsHalfAPeriodAndReturnsItsSpeed) {
  const ContactPhase phase({.stiffness_n_m = 1e12}, 1, 4, 0);
  EXPECT_NEAR(phase.duration(), 3.141592653589793e-6, 1e-20);
  EXPECT_NEAR(phase.depth_rate(phase.duration()), -4, 1e-14);
  EXPECT_NEAR(phase.deepest(), 4e-6, 1e-20);
}

TEST(ResponseContactPhase, AWeightWithoutSpeedStaysForEver) {
  const ContactPhase phase({.stiffness_n_m = 1e8, .damping_ratio = 0.2}, 1, 0, 9.81);
  EXPECT_TRUE(std::isinf(phase.duration()));
  EXPECT_NEAR(phase.depth(1), 9.81e-8, 1e-20);
}

}  // namespace
}  // namespace collided::response
