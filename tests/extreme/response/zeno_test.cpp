// Infinitely many bounces in a finite time: an end by a declared rule, at the time that the closed form gives.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/response/event_driven.hpp"
#include "tests/studies/response/reference.hpp"

namespace collided::response {
namespace {

// Height 1, gravity 2, restitution 1/2: impacts at 3 - 4 / 2^n, the end at 3.
TEST(ResponseZeno, ImpactsFollowTheClosedForm) {
  const RigidBall ball{1, 2, 0.5};
  EXPECT_EQ(ball.rest_s(), 3);
  EventDriven world({{1}, {0}, -2, 0}, {{1}, {0}}, 0.5, 1e-9);
  for (int n = 1; n <= 30; ++n) {
    ASSERT_TRUE(world.advance_to_impact());
    EXPECT_NEAR(world.time(), 3 - 4 * std::exp2(-n), 2e-15 * n) << n;
    EXPECT_NEAR(ball.impact_s(static_cast<std::uint64_t>(n)), 3 - 4 * std::exp2(-n), 2e-15) << n;
  }
}

TEST(ResponseZeno, TheEndIsRestAndItIsReportedOnce) {
  for (const double restitution : {0.1, 0.5, 0.9, 0.99}) {
    const RigidBall ball{1, 2, restitution};
    const double resting_speed = 1e-6;
    EventDriven world({{1}, {0}, -2, 0}, {{1}, {0}}, restitution, resting_speed);
    world.advance(2 * ball.rest_s());
    EXPECT_EQ(world.resting_count(), 1U);
    EXPECT_NEAR(world.motion().position_m[0], 0, 1e-14);
    EXPECT_EQ(world.motion().velocity_m_s[0], 0);
    // Speeds 2 e^n until the first at most the resting speed; that last one may bounce or not.
    const double expected = std::ceil(std::log(resting_speed / 2) / std::log(restitution));
    EXPECT_NEAR(static_cast<double>(world.impacts()), expected, 1) << restitution;
    const std::uint64_t before = world.impacts();
    world.advance(1e6);
    EXPECT_EQ(world.impacts(), before);
  }
}

TEST(ResponseZeno, HeightsAgreeUntilTheRuleLeavesOutTheRest) {
  const RigidBall ball{1, 2, 0.7};
  EventDriven world({{1}, {0}, -2, 0}, {{1}, {0}}, 0.7, 1e-5);
  for (int step = 1; step <= 2'000; ++step) {
    world.advance(0.005);
    // Left out are bounces up to v^2 / 2g = 2.5e-11 high.
    EXPECT_NEAR(world.motion().position_m[0], ball.height(step * 0.005), 1e-10) << step;
  }
}

TEST(ResponseZeno, WithoutARestingSpeedItIsRefused) {
  EXPECT_THROW(EventDriven({{1}, {0}, -2, 0}, {{1}, {0}}, 0.5, 0), std::invalid_argument);
}

// Without gravity three bodies can do the same: two walls closing in on one between them would ring for ever.
TEST(ResponseZeno, BodiesThatCollapseOntoEachOtherEnd) {
  EventDriven world({{1, 1, 1}, {0, 0, 0}}, {{0, 0.5, 1}, {1, 0, -1}}, 0.05, 1e-9);
  world.advance(10);
  EXPECT_LT(world.impacts(), 1'000U);
  EXPECT_NEAR(world.motion().velocity_m_s[0] + world.motion().velocity_m_s[1] + world.motion().velocity_m_s[2], 0,
              1e-15);
}

}  // namespace
}  // namespace collided::response
