#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "client/cli/publish/response/damper.hpp"

namespace collided::response {
namespace {

// Laid down without speed it sinks to where the spring bears it, never deeper, and stays.
TEST(ResponseOverdamped, AWeightSinksToItsRestAndStays) {
  for (double ratio = 1.25; ratio < 20; ratio *= 1.01) {
    const ContactPhase phase({.stiffness_n_m = 1e4, .damping_ratio = ratio}, 2, 0, 19.62);
    EXPECT_TRUE(std::isinf(phase.duration())) << ratio;
    EXPECT_NEAR(phase.deepest(), 19.62e-4, 1e-12) << ratio;
    EXPECT_NEAR(phase.depth(100), 19.62e-4, 1e-12) << ratio;
  }
}

// Pulled apart, the spring lets go, and at that moment bears nothing.
TEST(ResponseOverdamped, APullEndsTheContactWhereTheForceIsNothing) {
  const double stiffness_n_m = 1e4;
  const double mass_kg = 2;
  for (const double ratio : {1.25, 2., 8.}) {
    for (const double load_n : {-0.5, -5., -50.}) {
      const Spring spring{.stiffness_n_m = stiffness_n_m, .damping_ratio = ratio};
      const ContactPhase phase(spring, mass_kg, 0.5, load_n);
      const double end_s = phase.duration();
      ASSERT_TRUE(std::isfinite(end_s)) << ratio << " " << load_n;
      EXPECT_GT(end_s, 0);
      const double force_n = stiffness_n_m * phase.depth(end_s) + spring.damping(mass_kg) * phase.depth_rate(end_s);
      EXPECT_NEAR(force_n, 0, 1e-9 * spring.damping(mass_kg)) << ratio << " " << load_n;
    }
  }
}

// Laid down without speed it swings through its rest, by what is left of it after half a period.
TEST(ResponseUnderdamped, AWeightSwingsThroughItsRest) {
  for (double ratio = 0.01; ratio < 0.9; ratio *= 1.01) {
    const ContactPhase phase({.stiffness_n_m = 1e4, .damping_ratio = ratio}, 2, 0, 19.62);
    const double left = std::exp(-std::numbers::pi * ratio / std::sqrt(1 - ratio * ratio));
    EXPECT_NEAR(phase.deepest(), 19.62e-4 * (1 + left), 1e-12) << ratio;
  }
}

}  // namespace
}  // namespace collided::response
