// How near two objects came, against the world looked at instant by instant.
#include "server/world/query/nearest_approach.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/world/query/pair_report.hpp"
#include "server/world/query/why_not_meeting.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::nearest_approach_test {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStart = 1'000 * kSecond;
constexpr std::int64_t kTick = 10'000'000;

class NearestApproachTest : public testing::Test {
 protected:
  ObjectId add(const std::string& name, std::uint64_t publisher, const Primitive& shape, const Pose& pose,
               const Filter& filter = {}) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.primitives = {shape};
    definition.pose = pose;
    definition.publisher = publisher;
    definition.moving = publisher != 0;
    definition.filter = filter;
    return std::get<ObjectId>(world.define(definition));
  }
  void say(std::uint64_t publisher, std::int64_t time_ns, ObjectId id, const Pose& pose, bool jumps = false) {
    ASSERT_TRUE(world.move(id, pose, time_ns, jumps));
    world.advance(publisher, time_ns);
    now_ns = std::max(now_ns, time_ns);
    ASSERT_TRUE(world.step(now_ns, 1, {}));
  }
  NearestApproach nearest(ObjectId a, ObjectId b, std::int64_t since_ns = 0, std::int64_t deadline_ns = 0) {
    const SnapshotRing::Lease state = world.newest();
    const auto path_of_a = world.memory().path_of(a);
    const auto path_of_b = world.memory().path_of(b);
    EXPECT_TRUE(path_of_a && path_of_b);
    Deadline deadline(deadline_ns);
    return nearest_approach(*state, a, *path_of_a, b, *path_of_b, since_ns, deadline);
  }
  /// Touching counts as 0.
  double distance_at(ObjectId a, ObjectId b, std::int64_t time_ns) {
    const std::shared_ptr<const Snapshot> state = world.memory().at(time_ns);
    EXPECT_NE(state, nullptr);
    const PairReport report = report_pair(*state, a, b, {});
    return report.touches == Decision::yes ? 0 : report.separation.distance_m;
  }

  World world{WorldOptions{.memory = {.reach_ns = 30 * kSecond}}};
  std::int64_t now_ns = kStart;
};

Pose turned(std::mt19937_64& random, double spread_m) {
  std::uniform_real_distribution<double> place(-spread_m, spread_m);
  std::normal_distribution<double> turn;
  Pose pose{.position = {place(random), place(random), place(random)}};
  pose.rotation = Quat(turn(random), turn(random), turn(random), turn(random)).normalized();
  return pose;
}

// Boxes that go and turn with instants of their own, some of them by jumps: nobody saw them nearer than is said, and the
// distance that is told was there at the time that is told.
TEST_F(NearestApproachTest, NoInstantIsNearerThanWhatIsSaid) {
  std::mt19937_64 random = oracle::seeded(2'705);
  const auto size = [&] { return std::uniform_real_distribution<double>(0.1, 0.8)(random); };
  int touched = 0;
  for (int round = 0; round < 40; ++round) {
    const std::string number = std::to_string(round);
    const std::uint64_t first = 2 * static_cast<std::uint64_t>(round) + 1;
    const auto box = [&] { return Box{.center = Vec3::Zero(), .half_m = {size(), size(), size()}}; };
    const ObjectId a = add("a" + number, first, box(), turned(random, 3));
    const ObjectId b = add("b" + number, first + 1, box(), turned(random, 3));
    const std::int64_t begin_ns = now_ns + kTick;
    std::int64_t last_a_ns = begin_ns;
    std::int64_t last_b_ns = begin_ns;
    for (int i = 1; i <= 6; ++i) {
      last_a_ns = begin_ns + i * kTick;
      last_b_ns = begin_ns + i * kTick + kTick / 3;
      say(first, last_a_ns, a, turned(random, 3), random() % 5 == 0);
      say(first + 1, last_b_ns, b, turned(random, 3), random() % 5 == 0);
    }
    const NearestApproach found = nearest(a, b, begin_ns);
    ASSERT_EQ(found.from_ns, begin_ns + kTick) << "the server met the second one then";
    ASSERT_EQ(found.to_ns, last_a_ns);
    double sampled_m = INFINITY;
    for (std::int64_t time_ns = found.from_ns; time_ns <= last_a_ns; time_ns += kTick / 37)
      sampled_m = std::min(sampled_m, distance_at(a, b, time_ns));
    if (found.end == ApproachEnd::touched) {
      ++touched;
      EXPECT_LT(distance_at(a, b, found.time_ns), 1e-6) << "round " << round;
      continue;
    }
    ASSERT_EQ(found.end, ApproachEnd::found) << "round " << round;
    EXPECT_LE(found.at_least_m, sampled_m + 1e-9) << "round " << round;
    EXPECT_GE(found.at_least_m, found.distance_m - found.error_m - std::max(1e-3 * found.distance_m, 1e-6));
    EXPECT_LE(found.distance_m, sampled_m * (1 + 1e-3) + 1e-6) << "round " << round;
    EXPECT_NEAR(distance_at(a, b, found.time_ns), found.distance_m, 1e-6) << "round " << round;
  }
  EXPECT_GT(touched, 3);
  EXPECT_LT(touched, 37) << "too few pass each other";
}

// Worked out by hand: a ball of 0.5 m passes the face of a box at 3.2 cm, half-way between two poses.
TEST_F(NearestApproachTest, APassBetweenTwoPosesIsFoundAtItsTime) {
  const ObjectId ball = add("drone", 7, Sphere{.center = Vec3::Zero(), .radius_m = 0.5}, {.position = {-2, 0, 0}});
  const ObjectId point = add("tip", 0, Sphere{.center = Vec3::Zero(), .radius_m = 0}, {.position = {0, 0.532, 0}});
  say(7, kStart + kSecond, ball, {.position = {-2, 0, 0}});
  say(7, kStart + 2 * kSecond, ball, {.position = {2, 0, 0}});
  const NearestApproach found = nearest(ball, point);
  EXPECT_EQ(found.end, ApproachEnd::found);
  EXPECT_NEAR(found.distance_m, 0.032, 4e-5);
  EXPECT_LE(found.at_least_m, 0.032);
  EXPECT_GE(found.at_least_m, 0.0319);
  EXPECT_NEAR(static_cast<double>(found.time_ns - kStart) * 1e-9, 1.5, 0.01);
  // The stretch may begin later: then the end of it is the nearest.
  const NearestApproach later = nearest(ball, point, kStart + 2 * kSecond - kTick);
  EXPECT_EQ(later.from_ns, kStart + 2 * kSecond - kTick);
  EXPECT_GT(later.distance_m, 1.5);
}

TEST_F(NearestApproachTest, ADeadlineThatIsOverLeavesABoundThatHolds) {
  const ObjectId a = add("a", 7, Sphere{.center = Vec3::Zero(), .radius_m = 0.5}, {.position = {-2, 0, 0}});
  const ObjectId b = add("b", 0, Sphere{.center = Vec3::Zero(), .radius_m = 0.1}, {.position = {0, 0.7, 0}});
  say(7, kStart + kSecond, a, {.position = {-2, 0, 0}});
  say(7, kStart + 2 * kSecond, a, {.position = {2, 0, 0}});
  const NearestApproach found = nearest(a, b, 0, 1);
  EXPECT_EQ(found.end, ApproachEnd::cut_short);
  EXPECT_LE(found.at_least_m, 0.1);
}

// What keeps a contact from being told has a sentence each.
TEST_F(NearestApproachTest, WhyNoContactIsTold) {
  const Sphere ball{.center = Vec3::Zero(), .radius_m = 1};
  const ObjectId a = add("a", 7, ball, {}, {.layers = 1, .mask = 2, .group = 5});
  const ObjectId b = add("b", 0, ball, {}, {.layers = 4, .mask = 8, .group = 5});
  const ObjectId c = add("c", 0, ball, {});
  const ObjectId d = add("d", 8, ball, {});
  world.set_pair_rules({{.a = "c", .b = "d", .because = "they are welded", .allows = true}});
  ASSERT_TRUE(world.step(++now_ns, 1, {}));
  const auto why = [&](ObjectId x, ObjectId y) { return why_not_meeting(*world.newest(), x, y); };
  EXPECT_EQ(why(a, b),
            (std::vector<std::string>{"layers 0x1 of 'a' are not in mask 0x8 of 'b'",
                                      "layers 0x4 of 'b' are not in mask 0x2 of 'a'", "both are of group 5"}));
  EXPECT_EQ(why(c, d), (std::vector<std::string>{"rule 'c' 'd' allows them to touch: they are welded"}));
  EXPECT_EQ(why(b, c).at(0), "neither of them moves");
  EXPECT_TRUE(why(d, b).size() == 1) << "layers 0x1 are not in mask 0x8";
}

}  // namespace
}  // namespace collided::engine::nearest_approach_test
