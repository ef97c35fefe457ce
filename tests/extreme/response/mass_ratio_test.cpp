// A millionfold mass meets a light one, either way round.
#include <cmath>

#include <gtest/gtest.h>

#include "client/cli/publish/response/collision.hpp"
#include "tests/studies/response/reference.hpp"
#include "tests/studies/response/stepper.hpp"
#include "tests/studies/response/tolerance.hpp"

namespace collided::response {
namespace {

TEST(ResponseMassRatio, AnImpulseGivesTheExactSpeeds) {
  Vec3 heavy{1, 0, 0};
  Vec3 light{0, 0, 0};
  EXPECT_TRUE(restitute(heavy, light, {1e-6, 1}, Vec3::UnitX(), 1));
  EXPECT_NEAR(heavy.x(), 999999.0 / 1000001.0, 1e-15);
  EXPECT_NEAR(light.x(), 2000000.0 / 1000001.0, 4e-16);
  EXPECT_NEAR(1e6 * heavy.x() + light.x(), 1e6, 2e-10);
}

TEST(ResponseMassRatio, AnImpulseWithRestitutionPartsAsFastAsItSays) {
  for (const double ratio : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
    for (const double restitution : {0.0, 0.3, 1.0}) {
      Vec3 a{0.7, 0.1, 0};
      Vec3 b{-0.4, 0, 0.2};
      restitute(a, b, {1 / ratio, 1}, Vec3::UnitX(), restitution);
      // Speeds change by up to 2.2 m/s, with five roundings of it to each side.
      EXPECT_NEAR(b.x() - a.x(), restitution * 1.1, 10 * 1.2e-16 * 2.2);
      EXPECT_NEAR(ratio * a.x() + b.x(), ratio * 0.7 - 0.4, 4e-16 * (1 + ratio));
      EXPECT_EQ(a.y(), 0.1);
      EXPECT_EQ(b.z(), 0.2);
    }
  }
}

TEST(ResponseMassRatio, SpringsFollowTheClosedForm) {
  for (const double ratio : {1e-6, 1.0, 1e6}) {
    for (const double stiffness : {1e2, 1e7, 1e12}) {
      const Line line{{ratio, 1}, {0.1, 0.1}};
      const Motion start{{-0.5, 0.2}, {1, 0}};
      const Spring spring{.stiffness_n_m = stiffness};
      Stepper stepper(line, {.spring = spring});
      Motion motion = start;
      for (int step = 0; step < 100; ++step) stepper.step(motion, 0.02);
      const Motion expected = compliant_pair(spring, line, start, 2);
      // A milligram on the stiffest spring: the contact is a nanometre deep, and its gap is known to 1e-16 m.
      const double allowed = 1e-6 + 10 * kUnseenGap * kTouching * 0.5 * spring.frequency(line.reduced_mass(1));
      EXPECT_NEAR(motion.velocity_m_s[0], expected.velocity_m_s[0], allowed) << ratio << ' ' << stiffness;
      EXPECT_NEAR(motion.velocity_m_s[1], expected.velocity_m_s[1], allowed) << ratio << ' ' << stiffness;
      EXPECT_NEAR(motion.position_m[1], expected.position_m[1], 4e-6) << ratio << ' ' << stiffness;
      EXPECT_NEAR(momentum(line, motion), ratio, 1e-15 * (1 + ratio) * 100);
    }
  }
}

// All contacts at once, the masses eight decades apart: forces come out to the last digits, so a light body between heavy
// ones is held still.
TEST(ResponseMassRatio, AHeavyBodyRestsOnALightOne) {
  for (const double top_kg : {1e-6, 1.0, 1e6}) {
    const double stiffness = 1e10;
    const Line line{{1, top_kg}, {0.1, 0.1}, -10, 0};
    const double low_m = 0.1 - 10 * (1 + top_kg) / stiffness;
    Motion motion{{low_m, low_m + 0.2 - 10 * top_kg / stiffness}, {0, 0}};
    const Motion start = motion;
    Stepper stepper(line, {.spring = {.stiffness_n_m = stiffness, .damping_ratio = 0.2}});
    for (int step = 0; step < 1000; ++step) stepper.step(motion, 1e-3);
    EXPECT_NEAR(motion.position_m[0], start.position_m[0], 1e-14) << top_kg;
    EXPECT_NEAR(motion.position_m[1], start.position_m[1], 1e-14) << top_kg;
  }
}

}  // namespace
}  // namespace collided::response
