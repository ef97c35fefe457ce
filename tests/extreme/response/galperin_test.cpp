// Two blocks and a wall count the digits of pi: every impact must be found, the last ones crowded, and none invented.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/response/event_driven.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {
namespace {

struct Billiard {
  double heavy_kg;
  std::uint64_t collisions;
};

// source: Galperin, "Playing pool with pi", Regular and Chaotic Dynamics 8, 2003
TEST(ResponseGalperin, ImpactsAreTheDigitsOfPi) {
  for (const Billiard billiard :
       {Billiard{1, 3}, Billiard{1e2, 31}, Billiard{1e4, 314}, Billiard{1e6, 3'141}, Billiard{1e8, 31'415}}) {
    const Line line{{1, billiard.heavy_kg}, {0, 0}, 0, 0};
    const Motion start{{1, 2}, {0, -1}};
    EventDriven world(line, start, 1);
    while (world.advance_to_impact()) ASSERT_LE(world.impacts(), billiard.collisions);
    EXPECT_EQ(world.impacts(), billiard.collisions);
    EXPECT_NEAR(kinetic_energy(line, world.motion()) / kinetic_energy(line, start), 1,
                2.3e-16 * static_cast<double>(4 + billiard.collisions));
  }
}

// On springs the contacts overlap once their gaps are shorter than a contact lasts. Stiff enough, the count is the same,
// and the energy stays: Bullet ends with up to 2,420 times of it.
TEST(ResponseGalperin, StiffSpringsCountTheSame) {
  for (const Billiard billiard : {Billiard{1, 3}, Billiard{1e2, 31}}) {
    const Line line{{1, billiard.heavy_kg}, {0, 0}, 0, 0};
    Motion motion{{1, 2}, {0, -1}};
    Stepper stepper(line, {.spring = {.stiffness_n_m = 1e12}});
    const double before = stepper.energy(motion);
    for (int step = 0; step < 400; ++step) stepper.step(motion, 0.01);
    EXPECT_EQ(stepper.episodes().began(), billiard.collisions);
    EXPECT_NEAR(stepper.energy(motion) / before, 1, 1e-5);
    EXPECT_GE(motion.velocity_m_s[1], motion.velocity_m_s[0]);
  }
}

}  // namespace
}  // namespace collided::response
