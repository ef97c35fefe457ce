// Contacts that happen at once: the order rule is pair by pair from the low end, again until nobody approaches.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/response/event_driven.hpp"
#include "tests/studies/response/reference.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {
namespace {

const Line kCradle{{1, 1, 1, 1, 1}, {0.5, 0.5, 0.5, 0.5, 0.5}};

TEST(ResponseSimultaneous, ACradleThatTouchesPassesTheBlowOn) {
  EventDriven from_left(kCradle, {{-1, 1, 2, 3, 4}, {1, 0, 0, 0, 0}}, 1);
  from_left.advance(2);
  EXPECT_EQ(from_left.motion().velocity_m_s, std::vector<double>({0, 0, 0, 0, 1}));
  EventDriven from_right(kCradle, {{0, 1, 2, 3, 5}, {0, 0, 0, 0, -1}}, 1);
  from_right.advance(2);
  EXPECT_EQ(from_right.motion().velocity_m_s, std::vector<double>({-1, 0, 0, 0, 0}));
}

TEST(ResponseSimultaneous, TwoBallsInTwoBallsOut) {
  EventDriven world(kCradle, {{-2, -1, 2, 3, 4}, {1, 1, 0, 0, 0}}, 1);
  world.advance(4);
  EXPECT_EQ(world.motion().velocity_m_s, std::vector<double>({0, 0, 0, 1, 1}));
}

// Linear springs do not make an ideal cradle of balls that touch: the blow spreads. A gap a thousand times as wide as a
// contact is deep passes it on whole.
// source: Herrmann, Schmaelzle, "Simple explanation of a well-known collision experiment", Am. J. Phys. 49, 1981
TEST(ResponseSimultaneous, SpringsPassABlowOnAcrossGapsAndSpreadItWithoutThem) {
  Stepper apart(kCradle, {.spring = {.stiffness_n_m = 1e12}});
  Motion gaps{{-1, 1.001, 2.002, 3.003, 4.004}, {1, 0, 0, 0, 0}};
  for (int step = 0; step < 200; ++step) apart.step(gaps, 0.01);
  EXPECT_NEAR(gaps.velocity_m_s[4], 1, 1e-5);
  Stepper together(kCradle, {.spring = {.stiffness_n_m = 1e8}});
  Motion touching{{-1, 1, 2, 3, 4}, {1, 0, 0, 0, 0}};
  for (int step = 0; step < 200; ++step) together.step(touching, 0.01);
  EXPECT_LT(touching.velocity_m_s[4], 0.995);
  EXPECT_GT(touching.velocity_m_s[4], 0.9);
  EXPECT_NEAR(momentum(kCradle, touching), 1, 1e-13);
  EXPECT_NEAR(together.energy(touching), 0.5, 1e-6);
}

TEST(ResponseSimultaneous, AHeavyBallOnAStackEndsItsRounds) {
  const Line line{{1, 1, 1e9}, {0.5, 0.5, 0.5}, -9.81, 0};
  Stepper stepper(line, {.method = Method::impulse, .restitution = 0.999});
  Motion motion{{0.5, 1.5, 2.5}, {0, 0, -100}};
  const double before = stepper.energy(motion);
  stepper.step(motion, 1e-3);
  // The light ones' speeds are differences of impulses of 1e11 N s: four roundings of that.
  const double rounding_m_s = 4 * 1.2e-16 * 1e11;
  for (std::size_t contact = 0; contact <= line.size(); ++contact)
    EXPECT_GE(gap_rate(line, motion.velocity_m_s, contact), -rounding_m_s) << contact;
  EXPECT_LE(stepper.energy(motion), before * (1 + 1e-12));
}

}  // namespace
}  // namespace collided::response
