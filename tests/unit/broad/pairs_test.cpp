#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <map>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/pose.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/broad/bvh_walks.hpp"

namespace collided::engine {
namespace {

using PairCounts = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

Quat any_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> part;
  const double w = part(random);
  const double x = part(random);
  const double y = part(random);
  return Quat(w, x, y, part(random)).normalized();
}

Aabb box_of(const Triangle& t) { return {t.a.cwiseMin(t.b).cwiseMin(t.c), t.a.cwiseMax(t.b).cwiseMax(t.c)}; }

TriangleMesh scaled(TriangleMesh mesh, double by, const Vec3& moved = Vec3::Zero()) {
  for (Vec3& vertex : mesh.vertices) vertex = by * vertex + moved;
  return mesh;
}

/// Rounding of placing: three products and sums, and a matrix whose rows are off by six roundings.
double placing_slack(const TriangleMesh& mesh, const Frame& frame) {
  double reach = 0;
  for (const Vec3& vertex : mesh.vertices) reach = std::max(reach, vertex.lpNorm<1>());
  return 16 * 0x1p-53 * (reach + frame.position.lpNorm<1>()) + 0x1p-1070;
}

PairCounts offered(const Bvh& a, const Bvh& b, const Frame& frame, double slack_m) {
  PairCounts all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t first, std::uint32_t second) {
    ++all[{first, second}];
    return true;
  };
  a.walk_pairs(b, frame.rotation, frame.position, slack_m, collect, cost);
  EXPECT_GE(cost.candidates, all.size());
  return all;
}

struct Count {
  std::size_t met = 0;
  std::size_t offered = 0;
};

/// Every pair that the exact test says yes to is offered, and none more than four times.
Count expect_none_lost(const TriangleMesh& a, const TriangleMesh& b, const Frame& frame, bool too_few_to_miss = false) {
  const Bvh tree_a = Bvh::build(a);
  const Bvh tree_b = Bvh::build(b);
  const PairCounts found = offered(tree_a, tree_b, frame, placing_slack(b, frame));
  Count count;
  count.offered = found.size();
  for (const auto& [pair, times] : found) EXPECT_LE(times, 4);
  std::vector<Triangle> placed;
  for (std::uint32_t j = 0; j < b.triangles.size(); ++j) placed.push_back(place(frame, b.triangle(j)));
  for (std::uint32_t i = 0; i < a.triangles.size(); ++i) {
    const Triangle own = a.triangle(i);
    for (std::uint32_t j = 0; j < placed.size(); ++j) {
      if (!overlaps(box_of(own), box_of(placed[j])) || !overlaps(own, placed[j]).yes()) continue;
      ++count.met;
      EXPECT_TRUE(found.contains({i, j})) << i << " " << j << std::hexfloat << " at " << frame.position.transpose();
      if (testing::Test::HasFailure()) return count;
    }
  }
  if (!too_few_to_miss) { EXPECT_GT(count.met, 0u); }
  return count;
}

Frame random_frame(std::mt19937_64& random, double reach) {
  return frame_of(Pose{.position = reach * in_cube(random), .rotation = any_rotation(random)});
}

TEST(BroadPairs, LoseNoPairThatTheExactTestMeets) {
  std::mt19937_64 random = oracle::seeded(20260101);
  Count all;
  for (int i = 0; i < 12; ++i) {
    const TriangleMesh sphere = scenes::icosphere(2, 1);
    const TriangleMesh hills = scenes::terrain(24, 3, random());
    const TriangleMesh loose = scenes::scattered(400, 0.3, random());
    for (const TriangleMesh* other : {&sphere, &hills, &loose}) {
      all.met += expect_none_lost(*other, sphere, random_frame(random, 0.8), true).met;
      all.met += expect_none_lost(sphere, *other, random_frame(random, 0.8), true).met;
    }
  }
  EXPECT_GT(all.met, 1000u);
}

// A generous walk that offers everything would pass every other test.
TEST(BroadPairs, OfferFewPairsThatDoNotMeet) {
  std::mt19937_64 random(7);
  const TriangleMesh sphere = scenes::icosphere(3, 1);
  Count all;
  for (const double apart : {0.5, 1.0, 1.9}) {
    const Frame frame = frame_of(Pose{.position = apart * Vec3(0.48, 0.64, 0.6), .rotation = any_rotation(random)});
    const Count count = expect_none_lost(sphere, sphere, frame);
    all.met += count.met;
    all.offered += count.offered;
  }
  EXPECT_LT(all.offered, 3 * all.met);
}

TEST(BroadPairs, DegenerateTrianglesLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20260102);
  for (int i = 0; i < 4; ++i) {
    const TriangleMesh odd = scenes::degenerate(300, random());
    expect_none_lost(odd, scenes::icosphere(2, 0.7), random_frame(random, 0.3), true);
    expect_none_lost(scenes::icosphere(1, 0.7), odd, random_frame(random, 0.3), true);
    expect_none_lost(odd, odd, Frame{}, true);
  }
}

// Faces in one plane, edges on edges, corners on corners: everything touches and nothing crosses.
TEST(BroadPairs, CoplanarAndTouchingLoseNothing) {
  TriangleMesh flat = scenes::terrain(12, 1, 1);
  for (Vec3& vertex : flat.vertices) vertex[2] = 0;
  for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(0.25, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0.3, -0.7, 0)}) {
    expect_none_lost(flat, flat, frame_of(Pose{.position = shift, .rotation = Quat::Identity()}));
  }
  const TriangleMesh cube = scenes::box({1, 1, 1});
  for (int k = 0; k < 27; ++k) {
    const Vec3 shift(2 * (k % 3 - 1), 2 * (k / 3 % 3 - 1), 2 * (k / 9 - 1));
    for (const double turn : {0.0, M_PI / 2}) {
      const Quat rotation(Eigen::AngleAxisd(turn, Vec3::UnitZ()));
      expect_none_lost(cube, cube, frame_of(Pose{.position = shift, .rotation = rotation}), turn != 0);
    }
  }
  for (const double offset : {1.0 / 3, 1e6 + 1.0 / 3, 1e9}) {
    const TriangleMesh far = scaled(cube, 0.1, Vec3(offset, -offset, offset / 7));
    expect_none_lost(far, far, Frame{});
    expect_none_lost(far, scaled(cube, 0.1),
                     frame_of(Pose{.position = Vec3(offset, -offset, offset / 7), .rotation = Quat::Identity()}));
  }
}

TEST(BroadPairs, FarFromOriginLosesNothingAndStaysSharp) {
  std::mt19937_64 random = oracle::seeded(20260104);
  const TriangleMesh sphere = scenes::icosphere(3, 1);
  for (const double offset : {1e2, 1e6, 1e9, 1e13}) {
    SCOPED_TRACE(offset);
    const Vec3 away = offset * Vec3(1, -0.7, 0.3);
    const TriangleMesh there = scaled(sphere, 1, away);
    const Frame frame =
        frame_of(Pose{.position = away + 1.2 * in_cube(random).normalized(), .rotation = any_rotation(random)});
    const Count placed = expect_none_lost(there, sphere, frame);
    const Count both = expect_none_lost(scaled(there, 1, -away), scaled(sphere, 1, Vec3(0.5, 0.4, 0.3)), Frame{});
    EXPECT_GT(both.met, 0u);
    if (offset < 1e7) { EXPECT_LT(placed.offered, 3 * placed.met); }
  }
}

TEST(BroadPairs, SizesOfAnyRatioLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20260105);
  // Thirds are no floats, so the large tree keeps edges, off by more than the whole of a small mesh.
  const TriangleMesh hills = scaled(scenes::terrain(24, 2, 5), 1.0 / 3);
  for (const double size : {0.1, 1e-2, 1e-4, 1e-6, 1e-9, 1e-11, 1e-12, 1e-15}) {
    SCOPED_TRACE(size);
    const TriangleMesh small = scaled(scenes::icosphere(1, 1), size);
    for (int i = 0; i < 5; ++i) {
      const Triangle on = hills.triangle(static_cast<std::uint32_t>(random() % hills.triangles.size()));
      const Frame frame = frame_of(Pose{.position = on.a / 2 + on.b / 4 + on.c / 4, .rotation = any_rotation(random)});
      expect_none_lost(hills, small, frame);
      const Frame back{frame.rotation.transpose(), -(frame.rotation.transpose() * frame.position)};
      expect_none_lost(small, hills, back, true);
    }
  }
}

TEST(BroadPairs, ScalesFromTheSmallestToTheLargestDoublesLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20260106);
  for (const double scale : {1e-320, 1e-306, 1e-290, 1e-150, 1e-40, 1e-12, 1e12, 1e40, 1e150, 1e300, 4e307}) {
    SCOPED_TRACE(scale);
    const TriangleMesh a = scaled(scenes::icosphere(1, 1), scale);
    Frame frame = random_frame(random, 0.7);
    frame.position *= scale;
    expect_none_lost(a, a, frame, true);
    expect_none_lost(a, a, Frame{});
  }
}

// A vertex moved by less than the slack, each on its own, is what rounding does to a placed mesh.
TEST(BroadPairs, SlackCoversDisplacedVertices) {
  std::mt19937_64 random = oracle::seeded(20260107);
  const TriangleMesh sphere = scenes::icosphere(2, 1);
  for (const double slack_m : {1e-12, 1e-6, 1e-3, 0.1, 3.0, 1e7, 1e20, 1e300}) {
    SCOPED_TRACE(slack_m);
    TriangleMesh moved = sphere;
    for (Vec3& vertex : moved.vertices) vertex += 0.999 * std::min(slack_m, 10.0) * in_cube(random);
    const Frame frame = frame_of(Pose{.position = Vec3(1.1, 0.3, -0.2), .rotation = any_rotation(random)});
    // The slack is told along the first tree's axes; as the displacement is along the second's it is up to sqrt(3) more.
    const PairCounts found = offered(Bvh::build(sphere), Bvh::build(sphere), frame, 1.75 * slack_m);
    std::size_t met = 0;
    for (std::uint32_t i = 0; i < sphere.triangles.size(); ++i) {
      for (std::uint32_t j = 0; j < moved.triangles.size(); ++j) {
        if (!overlaps(sphere.triangle(i), place(frame, moved.triangle(j))).yes()) continue;
        ++met;
        ASSERT_TRUE(found.contains({i, j}));
      }
    }
    EXPECT_GT(met, 0u);
  }
}

TEST(BroadPairs, WhatIsNoRotationKeepsThePromise) {
  std::mt19937_64 random = oracle::seeded(20260108);
  const TriangleMesh sphere = scenes::icosphere(1, 1);
  for (const double stretch : {1 + 1e-6, 0.5, 3.0}) {
    Frame frame = random_frame(random, 0.5);
    frame.rotation *= stretch;
    expect_none_lost(sphere, sphere, frame, true);
  }
}

TEST(BroadPairs, PartsFarApartAreNotWalked) {
  const Bvh tree = Bvh::build(scenes::icosphere(3, 1));
  WalkCost cost;
  const auto never = [](std::uint32_t, std::uint32_t) { return ADD_FAILURE(), false; };
  for (const double away : {2.5, 1e3, 1e30, 1e300}) {
    tree.walk_pairs(tree, Mat3::Identity(), Vec3(0, away, 0), 1e-12, never, cost);
  }
  EXPECT_LE(cost.nodes, 20u);
  Bvh().walk_pairs(tree, Mat3::Identity(), Vec3::Zero(), 0, never, cost);
  tree.walk_pairs(Bvh(), Mat3::Identity(), Vec3::Zero(), 0, never, cost);
}

TEST(BroadPairs, FalseEndsTheWalk) {
  const auto stop = [](std::uint32_t, std::uint32_t) { return false; };
  const TriangleMesh sphere = scenes::icosphere(3, 1);
  const Bvh tree = Bvh::build(sphere);
  const Bvh speck = Bvh::build(scaled(sphere, 1e-15));
  for (const Bvh* other : {&tree, &speck}) {
    WalkCost cost;
    tree.walk_pairs(*other, Mat3::Identity(), sphere.vertices[7], 1e-12, stop, cost);
    other->walk_pairs(tree, Mat3::Identity(), -sphere.vertices[7], 1e-12, stop, cost);
    if (other == &tree) { EXPECT_EQ(cost.candidates, 2u); }
  }
}

// The cost is that of the border where two surfaces cross, not of the surfaces.
TEST(BroadPairs, CostGrowsWithTheBorder) {
  std::uint32_t before = 0;
  for (const int levels : {3, 4, 5}) {
    const Bvh tree = Bvh::build(scenes::icosphere(levels, 1));
    WalkCost cost;
    const auto go_on = [](std::uint32_t, std::uint32_t) { return true; };
    tree.walk_pairs(tree, Quat(0.8, 0.1, 0.5, 0.3).normalized().toRotationMatrix(), Vec3(0.6, 0.5, 0.4), 1e-14, go_on,
                    cost);
    if (before != 0) { EXPECT_LT(cost.nodes, 3 * before) << "twice the border, four times the triangles"; }
    before = cost.nodes;
  }
}

// Each instruction set this machine has, down to plain C++, against the exact test; the walks differ in nothing else.
TEST(BroadPairsSimd, EveryInstructionSetLosesNothing) {
  std::mt19937_64 random = oracle::seeded(20260109);
  TriangleMesh mesh = scenes::icosphere(1, 1);
  scenes::append(mesh, scenes::degenerate(60, random()));
  std::vector<std::int64_t> targets = {HWY_SCALAR, HWY_EMU128};
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) targets.push_back(rest & -rest);
  for (const std::int64_t target : targets) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    std::mt19937_64 same = random;
    for (int i = 0; i < 3; ++i) {
      expect_none_lost(mesh, scenes::icosphere(2, 0.9), random_frame(same, 0.5));
      expect_none_lost(scenes::terrain(10, 2, 3), mesh, random_frame(same, 0.3));
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace
}  // namespace collided::engine
