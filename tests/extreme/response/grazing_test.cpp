// A ball that just reaches the ceiling, by an ulp more or less.
#include <cmath>

#include <gtest/gtest.h>

#include "client/cli/publish/response/collision.hpp"
#include "tests/studies/response/event_driven.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {
namespace {

// Thrown at 1 m/s under gravity 2 it rises by exactly 1/4.
TEST(ResponseGrazing, ATouchWithoutSpeedTakesAndGivesNothing) {
  for (const double ceiling : {0.25, std::nextafter(0.25, 0.0), std::nextafter(0.25, 1.0)}) {
    const Line line{{1}, {0}, -2, -10, ceiling};
    EventDriven rigid(line, {{0}, {1}}, 1);
    rigid.advance(1);
    // An ulp of height too little leaves sqrt(2 g ulp) = 1.5e-8 m/s, which the impact turns round.
    EXPECT_NEAR(rigid.motion().position_m[0], 0, 3e-8) << ceiling;
    EXPECT_NEAR(rigid.motion().velocity_m_s[0], -1, 3e-8);
    EXPECT_LE(rigid.impacts(), 1U);
    for (const double stiffness : {1e2, 1e12}) {
      Stepper stepper(line, {.spring = {.stiffness_n_m = stiffness, .damping_ratio = 0.3}});
      Motion motion{{0}, {1}};
      for (int step = 0; step < 7; ++step) stepper.step(motion, 1.0 / 7);
      EXPECT_NEAR(motion.position_m[0], 0, 1e-7) << ceiling << ' ' << stiffness;
      EXPECT_NEAR(motion.velocity_m_s[0], -1, 1e-7);
      EXPECT_LE(stepper.episodes().began(), 1U);
      EXPECT_LT(stepper.counts().substeps, 1'000U);
    }
  }
}

// Velocities across the line of centres are none of the impact's business.
TEST(ResponseGrazing, SpheresThatPassAlongEachOtherKeepTheirVelocities) {
  Vec3 a{1, 0, 0};
  Vec3 b{-1, 0, 0};
  EXPECT_FALSE(restitute(a, b, {1, 1}, Vec3::UnitY(), 1));
  EXPECT_EQ(a, Vec3(1, 0, 0));
  EXPECT_EQ(b, Vec3(-1, 0, 0));
  // Parting ones are not pulled back.
  EXPECT_FALSE(restitute(a, b, {1, 1}, -Vec3::UnitX(), 1));
  EXPECT_EQ(a, Vec3(1, 0, 0));
}

}  // namespace
}  // namespace collided::response
