// Far from the world's origin two objects pass each other as they do near it: where subtracting a common origin rounds
// nothing, their events are the same, with brackets as narrow.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/world/posed_ways.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kStep_ns = 20'000'000;
/// Positions are multiples of it, so that they are doubles a billion metres out, too.
constexpr double kLattice_m = 0x1p-20;

Vec3 on_lattice(const Vec3& p) { return (p / kLattice_m).array().round() * kLattice_m; }

/// Passages of two objects, the second of which flies past the first and turns where asked.
std::vector<Actor> passage(std::mt19937_64& random, bool turns) {
  oracle::RandomShapes shapes(random, oracle::Family::random);
  std::uniform_real_distribution<double> in(-1, 1);
  std::vector<Actor> actors(2);
  const auto rotation = [&] { return Quat(in(random), in(random), in(random), in(random)).normalized(); };
  for (std::size_t i = 0; i < 2; ++i) {
    actors[i].name = i == 0 ? "a" : "b";
    const int kind = std::uniform_int_distribution<int>(0, 4)(random);
    if (kind == 0) actors[i].shape.mesh = std::make_shared<const TriangleMesh>(scenes::box({0.6, 0.5, 0.4}));
    else actors[i].shape.primitives = {shapes.solid(kind)};
  }
  const Vec3 begin(2, in(random), in(random));
  const Vec3 travel = Vec3(-2, in(random), in(random)) - begin;
  const Quat first = rotation();
  const Quat last = turns ? Quat(first.slerp(0.4, rotation())) : first;
  const Pose rest{.position = on_lattice(Vec3(in(random), in(random), in(random)) / 2), .rotation = rotation()};
  constexpr int kSteps = 10;
  for (int k = 0; k <= kSteps; ++k) {
    const double share = static_cast<double>(k) / kSteps;
    actors[0].poses.push_back({k * kStep_ns, rest});
    const Quat turned = turns ? Quat(first.slerp(share, last)) : first;
    actors[1].poses.push_back({k * kStep_ns, {.position = on_lattice(begin + share * travel), .rotation = turned}});
  }
  return actors;
}

std::vector<Actor> moved(std::vector<Actor> actors, const Vec3& by) {
  for (Actor& actor : actors) {
    for (PoseAt& at : actor.poses) at.pose.position += by;
  }
  return actors;
}

TEST(WorldFarOut, EventsAndBracketsAreThoseNearTheOrigin) {
  std::mt19937_64 random = oracle::seeded(20261130);
  std::size_t compared = 0;
  for (int i = 0; i < 120; ++i) {
    const std::vector<Actor> near = passage(random, i % 2 == 0);
    const PairEvents story = story_of(near);
    const PairEvents far_story = story_of(moved(near, Vec3(0x1p30, -0x1p29, 0x1p28)));
    ASSERT_EQ(story.size(), far_story.size()) << "passage " << i;
    for (const auto& [pair, events] : story) {
      const std::vector<PairEvent>& far_events = far_story.at(pair);
      ASSERT_EQ(events.size(), far_events.size()) << "passage " << i;
      for (std::size_t k = 0; k < events.size(); ++k) {
        ++compared;
        EXPECT_EQ(events[k].kind, far_events[k].kind) << "passage " << i;
        EXPECT_EQ(events[k].doubt, far_events[k].doubt) << "passage " << i;
        EXPECT_LE(far_events[k].low_ns, events[k].high_ns) << "passage " << i;
        EXPECT_LE(events[k].low_ns, far_events[k].high_ns) << "passage " << i;
        EXPECT_LE(far_events[k].high_ns - far_events[k].low_ns, 1000) << "passage " << i;
      }
    }
  }
  EXPECT_GT(compared, 150u);
}

}  // namespace
}  // namespace collided::engine
