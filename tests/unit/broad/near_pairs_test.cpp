// The walk to the nearest triangles of two trees offers every pair within its limit.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/part.hpp"
#include "server/geometry/pose.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

using PairSet = std::set<std::pair<std::uint32_t, std::uint32_t>>;

constexpr auto kGoesOn = [] { return false; };

PairSet offered_within(const Bvh& a, const Bvh& b, const Frame& frame, double slack_m, double limit_m) {
  PairSet all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t first, std::uint32_t second, double limit) {
    all.emplace(first, second);
    return limit;
  };
  a.walk_near_pairs(b, frame.rotation, frame.position, slack_m, limit_m, collect, kGoesOn, cost);
  return all;
}

Triangle moved(const Frame& frame, const Triangle& t) {
  const auto move = [&](const Vec3& p) { return Vec3(frame.rotation * p + frame.position); };
  return {move(t.a), move(t.b), move(t.c)};
}

/// How many pairs are within the limit; each must be offered.
std::size_t expect_all_within(const TriangleMesh& a, const TriangleMesh& b, const Frame& frame, double slack_m,
                              double limit_m) {
  const PairSet found = offered_within(Bvh::build(a), Bvh::build(b), frame, slack_m, limit_m);
  std::size_t within = 0;
  for (std::uint32_t i = 0; i < a.triangles.size(); ++i) {
    for (std::uint32_t j = 0; j < b.triangles.size(); ++j) {
      const Triangle first = a.triangle(i);
      const Triangle second = moved(frame, b.triangle(j));
      const bool meet = overlaps(ConvexPart(first), ConvexPart(second)).yes();
      const Separation apart = meet ? Separation{} : separation(first, second);
      if (!(apart.distance_m + apart.error_m <= limit_m)) continue;
      ++within;
      EXPECT_TRUE(found.contains({i, j})) << i << ' ' << j << " at " << apart.distance_m << " of " << limit_m;
      if (testing::Test::HasFailure()) return within;
    }
  }
  return within;
}

TriangleMesh mesh_of(int kind, std::mt19937_64& random) {
  switch (kind) {
    case 0: return scenes::icosphere(1, 0.8);
    case 1: return scenes::degenerate(90, random());
    case 2: return scenes::slanted(90, 0.4, random());
    default: return scenes::box({0.3, 0.2, 0.1}, {0.1, 5, -3});
  }
}

TEST(BroadNearPairs, LoseNoneWithinTheLimit) {
  std::mt19937_64 random = oracle::seeded(20261128);
  std::uniform_real_distribution<double> any(-1, 1);
  std::size_t within = 0;
  for (int round = 0; round < 64; ++round) {
    const TriangleMesh a = mesh_of(round % 4, random);
    const TriangleMesh b = mesh_of(round / 4 % 4, random);
    const double w = any(random), x = any(random), y = any(random), z = any(random);
    const Vec3 position(any(random), any(random), any(random));
    Frame frame = frame_of(Pose{.position = position, .rotation = Quat(w, x, y, z).normalized()});
    // A matrix that stretches is no rotation: the walk may offer more, and must not lose any.
    if (round % 8 == 7) frame.rotation.col(1) *= 1.7;
    // The placing rounds, and b may be off by a third of the slack in whatever direction.
    const double off_m = round % 3 == 2 ? 0.01 : 0;
    const Frame off{frame.rotation, frame.position + off_m / 3 * Vec3(1, -1, 1)};
    const double limit_m = 0.05 + 0.3 * std::abs(any(random));
    const PairSet found = offered_within(Bvh::build(a), Bvh::build(b), off, off_m + 1e-13, limit_m);
    within += expect_all_within(a, b, frame, off_m + 1e-13, limit_m);
    for (const auto& pair : offered_within(Bvh::build(a), Bvh::build(b), frame, 1e-13, 0)) {
      EXPECT_TRUE(found.contains(pair)) << "meets in one placing, and is not offered in another within its slack";
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(within, 1000u);
}

TEST(BroadNearPairs, EndWhereTheyAreTold) {
  const TriangleMesh mesh = scenes::icosphere(2, 1);
  const Bvh tree = Bvh::build(mesh);
  WalkCost cost;
  int told = 0;
  const auto ends_at_third = [&](std::uint32_t, std::uint32_t, double limit) { return ++told == 3 ? -1 : limit; };
  tree.walk_near_pairs(tree, Mat3::Identity(), Vec3::Zero(), 0, 9, ends_at_third, kGoesOn, cost);
  EXPECT_EQ(told, 3);
  int asked = 0;
  const auto is_over = [&] { return ++asked == 5; };
  const auto never = [](std::uint32_t, std::uint32_t, double limit) { return limit; };
  tree.walk_near_pairs(tree, Mat3::Identity(), Vec3::Zero(), 0, 9, never, is_over, cost);
  EXPECT_EQ(asked, 5);
  told = 0;
  tree.walk_near_pairs(tree, Mat3::Identity(), Vec3(9, 0, 0), 0, 6.5, ends_at_third, kGoesOn, cost);
  EXPECT_EQ(told, 0) << "nothing is within the limit";
}

// Out of the range that doubles square: offered all the same, and ended as told.
TEST(BroadNearPairs, OutOfRangeOfferEverything) {
  const TriangleMesh mesh = scenes::box({1, 1, 1});
  const Bvh tree = Bvh::build(mesh);
  const Frame far{Mat3::Identity(), Vec3(1e200, 0, 0)};
  EXPECT_EQ(offered_within(tree, tree, far, 0, 1e201).size(), mesh.triangles.size() * mesh.triangles.size());
  WalkCost cost;
  int told = 0;
  const auto ends = [&](std::uint32_t, std::uint32_t, double) { return ++told == 2 ? -1.0 : 1e201; };
  tree.walk_near_pairs(tree, far.rotation, far.position, 0, 1e201, ends, kGoesOn, cost);
  EXPECT_EQ(told, 2);
}

}  // namespace
}  // namespace collided::engine
