#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <set>

#include "tests/oracle/brute_force.hpp"
#include "tests/studies/homework/method.hpp"

namespace collided::homework {
using namespace engine;
namespace {

/// COLLIDED_FRAMES if it is set.
std::size_t frame_count() {
  const char* asked = std::getenv("COLLIDED_FRAMES");
  return asked != nullptr ? std::strtoul(asked, nullptr, 10) : 400;
}

// B2: who counts the events, and begins and ends of pairs alone, knows in every frame which objects touch. A51: the
// coarse phase loses none of them.
TEST(HomeworkEvents, TellInEveryFrameThePairsOfTheOracle) {
  const std::size_t frames = frame_count();
  const Recording recording =
      record({.objects = 12, .polygons = 16, .relative_size = 0.3, .frames = frames, .seed = 2});
  CollidedWorld world(recording);
  std::set<std::pair<std::size_t, std::size_t>> open;
  std::size_t contacts = 0, candidates = 0, changes = 0;
  const auto hear = [&](std::size_t a, std::size_t b, bool began) {
    ++changes;
    const std::pair pair{std::min(a, b), std::max(a, b)};
    ASSERT_TRUE(began ? open.insert(pair).second : open.erase(pair) == 1) << "a second " << (began ? "began" : "ended");
  };
  world.for_each_change(hear);  // what touched from the start
  for (std::size_t f = 0; f < frames; ++f) {
    world.frame(recording.poses[f]);
    world.for_each_change(hear);
    std::set<std::pair<std::size_t, std::size_t>> expected;
    for (const auto& [a, b] : oracle::touching_pairs(*world.world().newest())) {
      const std::size_t i = world.number_of(a), j = world.number_of(b);
      expected.insert({std::min(i, j), std::max(i, j)});
    }
    ASSERT_EQ(open, expected) << "frame " << f;
    contacts += expected.size();
    candidates += world.candidates();
  }
  std::printf("%zu frames, %zu events; %zu pairs that touch of %zu candidates (%.2f candidates a pair)\n", frames,
              changes, contacts, candidates, static_cast<double>(candidates) / static_cast<double>(contacts));
  EXPECT_GT(changes, frames / 20);
  EXPECT_GE(candidates, contacts);
}

}  // namespace
}  // namespace collided::homework
