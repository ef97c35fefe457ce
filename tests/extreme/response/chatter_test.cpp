// Poses that jitter about touching: with the declared hysteresis one contact, without it each toggle.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/response/episodes.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {
namespace {

struct Jitter {
  Line line{{1, 1}, {0.5, 0.5}};
  Motion touching{{1, 2}, {0, 0}};
  Motion apart{{std::nextafter(1.0, 0.0), std::nextafter(2.0, 3.0)}, {0, 0}};
};

TEST(ResponseChatter, AnUlpToEitherSideBeginsOnce) {
  const Jitter jitter;
  Episodes episodes;
  for (int step = 0; step < 1'000; ++step)
    episodes.observe(jitter.line, step % 2 == 0 ? jitter.touching : jitter.apart);
  EXPECT_EQ(episodes.began(), 1U);
  EXPECT_EQ(episodes.ended(), 0U);
}

TEST(ResponseChatter, WithoutHysteresisEveryToggleCounts) {
  const Jitter jitter;
  Episodes episodes(0);
  for (int step = 0; step < 1'000; ++step)
    episodes.observe(jitter.line, step % 2 == 0 ? jitter.touching : jitter.apart);
  EXPECT_EQ(episodes.began(), 500U);
  EXPECT_EQ(episodes.ended(), 500U);
}

// A real parting is one, even if it is small: ten times the hysteresis.
TEST(ResponseChatter, APartingBeyondTheHysteresisEnds) {
  const Jitter jitter;
  Motion parted = jitter.touching;
  parted.position_m[1] += 2 * 10 * kHysteresis;
  Episodes episodes;
  episodes.observe(jitter.line, jitter.touching);
  episodes.observe(jitter.line, parted);
  EXPECT_EQ(episodes.ended(), 1U);
}

// A resting body on any spring: one contact for ever, on every method that is stable there.
TEST(ResponseChatter, ARestingContactDoesNotChatter) {
  for (const Method method : {Method::implicit_euler, Method::compliant, Method::impulse}) {
    for (const double stiffness : {1e4, 1e8, 1e12}) {
      Stepper stepper(
          {{1}, {0.5}, -9.81, 0.25},
          {.method = method, .spring = {.stiffness_n_m = stiffness, .damping_ratio = 0.7}, .restitution = 0.5});
      Motion motion{{0.75}, {0}};
      for (int step = 0; step < 10'000; ++step) stepper.step(motion, 1.0 / 60);
      EXPECT_EQ(stepper.episodes().began(), 1U) << name(method) << stiffness;
      EXPECT_EQ(stepper.episodes().ended(), 0U) << name(method) << stiffness;
    }
  }
}

}  // namespace
}  // namespace collided::response
