// Far from the world's origin two objects pass each other as they do near it: their events are the same, with brackets as
// narrow, and no kind of pair takes more arithmetic.
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/geometry/convex_hull.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/world/posed_ways.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kStep_ns = 20'000'000;
/// Positions are multiples of it, so that they are doubles a billion metres out, too.
constexpr double kLattice_m = 0x1p-20;
const Vec3 kFarOut(0x1p30, -0x1p29, 0x1p28);

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

/// The same events, with brackets that overlap. Returns how many.
std::size_t expect_same(const PairEvents& story, const PairEvents& far_story, const std::string& which) {
  std::size_t compared = 0;
  EXPECT_EQ(story.size(), far_story.size()) << which;
  for (const auto& [pair, events] : story) {
    const auto found = far_story.find(pair);
    if (found == far_story.end() || found->second.size() != events.size()) {
      ADD_FAILURE() << which << ": other events of " << pair;
      continue;
    }
    const std::vector<PairEvent>& far_events = found->second;
    for (std::size_t k = 0; k < events.size(); ++k) {
      ++compared;
      EXPECT_EQ(events[k].kind, far_events[k].kind) << which;
      EXPECT_EQ(events[k].doubt, far_events[k].doubt) << which;
      EXPECT_LE(far_events[k].low_ns, events[k].high_ns) << which;
      EXPECT_LE(events[k].low_ns, far_events[k].high_ns) << which;
    }
  }
  return compared;
}

TEST(WorldFarOut, EventsAndBracketsAreThoseNearTheOrigin) {
  std::mt19937_64 random = oracle::seeded(20261130);
  std::size_t compared = 0;
  for (int i = 0; i < 120; ++i) {
    const std::vector<Actor> near = passage(random, i % 2 == 0);
    const PairEvents far_story = story_of(moved(near, kFarOut));
    compared += expect_same(story_of(near), far_story, "passage " + std::to_string(i));
    for (const auto& [pair, events] : far_story) {
      for (const PairEvent& event : events) EXPECT_LE(event.high_ns - event.low_ns, 1000) << "passage " << i;
    }
  }
  EXPECT_GT(compared, 150u);
}

enum class Way { rests, goes_straight, turns };

const char* name(Way way) {
  return way == Way::rests ? "rests" : way == Way::goes_straight ? "goes straight" : "turns";
}

/// Of the kinds 0 to 7: sphere, box, capsule, cylinder, cone, ellipsoid, hull, mesh; half a metre to each side and less.
Shape solid_of(int kind) {
  const Vec3 half(0.5, 0.375, 0.25);
  const TriangleMesh corners = scenes::box(half);
  Shape shape;
  switch (kind) {
    case 0: shape.primitives = {Sphere{Vec3::Zero(), 0.5}}; break;
    case 1: shape.primitives = {Box{Vec3::Zero(), Mat3::Identity(), half}}; break;
    case 2: shape.primitives = {Capsule{{-0.25, 0, 0}, {0.25, 0, 0}, 0.25}}; break;
    case 3: shape.primitives = {Cylinder{{0, 0, -0.25}, {0, 0, 0.25}, 0.5}}; break;
    case 4: shape.primitives = {Cone{{0, 0, 0.5}, {0, 0, -0.25}, 0.375}}; break;
    case 5: shape.primitives = {Ellipsoid{Vec3::Zero(), Mat3::Identity(), half}}; break;
    case 6: shape.primitives = {Hull{std::make_shared<const TriangleMesh>(*convex_hull(corners.vertices))}}; break;
    default: shape.mesh = std::make_shared<const TriangleMesh>(corners);
  }
  return shape;
}

/// What the first object does beside and in the second one, which rests: of the kinds of solid_of(), with the same draws for
/// every pair of kinds.
std::vector<Actor> meeting(int kind_a, int kind_b, Way way, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> in(-1, 1);
  const auto rotation = [&] { return Quat(in(random), in(random), in(random), in(random)).normalized(); };
  std::vector<Actor> actors(2);
  actors[0] = {.name = "a", .shape = solid_of(kind_a), .poses = {}};
  // Of two publishers: the two are decided on common time, else at the step's end.
  actors[1] = {.name = "b", .shape = solid_of(kind_b), .publisher = 1 + seed % 2, .poses = {}};
  const Pose rest{.position = on_lattice(Vec3(in(random), in(random), in(random)) / 4), .rotation = rotation()};
  const Vec3 begin(1.5, in(random) / 2, in(random) / 2);
  const Vec3 travel = Vec3(-1.5, in(random) / 2, in(random) / 2) - begin;
  const Quat first = rotation();
  const Quat last = way == Way::turns ? Quat(first.slerp(0.4, rotation())) : first;
  constexpr int kSteps = 6;
  for (int k = 0; k <= kSteps; ++k) {
    const double share = way == Way::rests ? 0.5 : static_cast<double>(k) / kSteps;
    const Quat turned = way == Way::turns ? Quat(first.slerp(share, last)) : first;
    actors[0].poses.push_back({k * kStep_ns, {.position = on_lattice(begin + share * travel), .rotation = turned}});
    actors[1].poses.push_back({k * kStep_ns, rest});
  }
  return actors;
}

class FarOutKinds : public testing::TestWithParam<std::tuple<int, int, Way>> {};

// Counted rather than timed. Seen from a common origin the two have the coordinates that they have near the world's origin,
// so that the same tests are left open. Only the points of contacts and the frames between poses are rounded by where the
// world is: of two that turn, a test for each meeting may be left open for that.
TEST_P(FarOutKinds, TakeNoMoreArithmeticThanNearTheOrigin) {
  const auto [kind_a, kind_b, way] = GetParam();
  constexpr int kMeetings = 12;
  RungCounts near;
  RungCounts far;
  for (int i = 0; i < kMeetings; ++i) {
    const std::vector<Actor> actors = meeting(kind_a, kind_b, way, 1 + i);
    const auto counted = [&](const std::vector<Actor>& of, RungCounts& sum) {
      const RungCounts before = kernel::rungs;
      const PairEvents story = story_of(of);
      sum.uncertain += kernel::rungs.uncertain - before.uncertain;
      sum.expansion += kernel::rungs.expansion - before.expansion;
      sum.rational += kernel::rungs.rational - before.rational;
      return story;
    };
    const PairEvents story = counted(actors, near);
    const PairEvents far_story = counted(moved(actors, kFarOut), far);
    expect_same(story, far_story, "meeting " + std::to_string(i));
  }
  const std::uint64_t more = way == Way::turns ? kMeetings : 0;
  EXPECT_LE(far.uncertain, near.uncertain + more) << name(way);
  EXPECT_LE(far.expansion, near.expansion + more) << name(way);
  EXPECT_LE(far.rational, near.rational + more) << name(way);
}

INSTANTIATE_TEST_SUITE_P(AllPairs, FarOutKinds,
                         testing::Combine(testing::Range(0, 8), testing::Range(0, 8),
                                          testing::Values(Way::rests, Way::goes_straight, Way::turns)));

}  // namespace
}  // namespace collided::engine
