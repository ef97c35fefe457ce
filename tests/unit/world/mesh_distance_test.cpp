// The distance of two meshes, by a walk down both trees, beside every triangle with every other.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <limits>
#include <random>

#include "server/geometry/float_environment.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/pair_report.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

/// A mesh as an object at a pose.
struct PlacedMesh {
  ObjectInfo info;
  Frame frame;

  PlacedMesh(TriangleMesh mesh, const Pose& pose)
      : info(without_world({.primitives = {}, .mesh = std::make_shared<const TriangleMesh>(std::move(mesh))})),
        frame(frame_of(pose)) {}
  Placed placed() const { return {.info = &info, .frame = frame, .bounds = bounds_of(info, frame)}; }
  std::vector<PlacedPart> parts() const { return parts_of(placed()); }
};

/// The slow twin: every pair, by the same test. low_m: no two triangles are nearer.
struct EveryPair {
  double least_m = std::numeric_limits<double>::infinity();
  double low_m = std::numeric_limits<double>::infinity();
  bool overlap = false;

  EveryPair(const PlacedMesh& a, const PlacedMesh& b) {
    const std::vector<PlacedPart> parts_b = b.parts();
    for (const PlacedPart& of_a : a.parts()) {
      for (const PlacedPart& of_b : parts_b) {
        if (overlaps(of_a.part, of_b.part).yes()) {
          overlap = true;
          return;
        }
        const Separation here = separation(of_a.part, of_b.part);
        least_m = std::min(least_m, here.distance_m);
        low_m = std::min(low_m, here.distance_m - here.error_m);
      }
    }
  }
};

Separation walked(const PlacedMesh& a, const PlacedMesh& b, WalkCost& cost) {
  Deadline none;
  return distance_between(a.placed(), b.placed(), cost, none);
}

/// False: they touch, and there is no distance.
bool expect_as_every_pair(const PlacedMesh& a, const PlacedMesh& b, const std::string& what) {
  const EveryPair twin(a, b);
  if (twin.overlap) return false;
  WalkCost cost;
  const Separation found = walked(a, b, cost);
  // What the walk found was among the pairs; a pair that it lost would be nearer than the bound admits.
  EXPECT_GE(found.distance_m, twin.least_m) << what;
  EXPECT_LE(found.distance_m - found.error_m, std::max(twin.low_m, 0.0)) << what;
  EXPECT_LE(std::abs((found.on_b - found.on_a).norm() - found.distance_m), found.error_m + 2 * found.point_error_m)
      << what;
  return true;
}

class AnyMesh {
 public:
  explicit AnyMesh(std::mt19937_64& random) : random_(random) {}

  double any() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 vector() {
    const double x = any(), y = any();
    return {x, y, any()};
  }
  Quat rotation() {
    const double w = any(), x = any(), y = any();
    return Quat(w, x, y, any()).normalized();
  }
  TriangleMesh mesh(int kind) {
    switch (kind % 6) {
      case 0: return latitude_longitude_sphere(0.7, 12, 8);
      case 1: return scenes::degenerate(120, random_());
      case 2: return scenes::terrain(9, 2, random_());
      case 3: return scenes::scattered(100, 0.05, random_());
      case 4: return scenes::box({0.5, 0.5, 0.5});
      default: return scenes::slanted(100, 0.3, random_());
    }
  }

 private:
  std::mt19937_64& random_;
};

TriangleMesh scaled(TriangleMesh mesh, double by) {
  for (Vec3& vertex : mesh.vertices) vertex *= by;
  return mesh;
}

TEST(MeshDistance, IsAsEveryPairOfTrianglesSays) {
  std::mt19937_64 random = oracle::seeded(20261125);
  AnyMesh make(random);
  int apart = 0;
  for (int i = 0; i < 120; ++i) {
    const double size_a = i % 5 == 3 ? 1e-4 : 1;
    const double size_b = i % 5 == 4 ? 1e-9 : 1;
    const Vec3 middle_m = i % 3 == 2 ? 1e6 * make.vector() : make.vector();
    const double away_m = i % 7 == 6 ? 1e7 : 2.5;
    const PlacedMesh a(scaled(make.mesh(i), size_a), {.position = middle_m, .rotation = make.rotation()});
    const PlacedMesh b(scaled(make.mesh(i / 6), size_b),
                       {.position = middle_m + away_m * make.vector(), .rotation = make.rotation()});
    apart += expect_as_every_pair(a, b, "round " + std::to_string(i)) ? 1 : 0;
    if (HasFailure()) return;
  }
  EXPECT_GT(apart, 60);
}

TEST(MeshDistance, OfOneShellInAnotherIsAsEveryPairSays) {
  std::mt19937_64 random = oracle::seeded(20261126);
  AnyMesh make(random);
  for (const double inner_m : {0.85, 0.5, 1e-3}) {
    for (int i = 0; i < 4; ++i) {
      const PlacedMesh outer(latitude_longitude_sphere(1, 16, 10),
                             {.position = {7, 8, 9}, .rotation = make.rotation()});
      const PlacedMesh inner(latitude_longitude_sphere(inner_m, 16, 10),
                             {.position = Vec3(7, 8, 9) + 0.02 * make.vector(), .rotation = make.rotation()});
      EXPECT_TRUE(expect_as_every_pair(outer, inner, std::to_string(inner_m)));
      EXPECT_TRUE(expect_as_every_pair(inner, outer, std::to_string(inner_m)));
    }
  }
}

// Known by hand: faces, edges and corners that face each other across a gap, down to one that no float resolves.
TEST(MeshDistance, OfTwoBoxesIsTheirGap) {
  const TriangleMesh box = scenes::box({1, 1, 1});
  for (const double gap_m : {1.0, 0x1p-20, 0x1p-45}) {
    for (const Vec3& side : {Vec3(1, 0, 0), Vec3(0, 1, 1), Vec3(1, 1, 1)}) {
      const PlacedMesh a(box, {});
      const PlacedMesh b(box, {.position = (2 + gap_m) * side, .rotation = Quat::Identity()});
      WalkCost cost;
      const Separation found = walked(a, b, cost);
      EXPECT_NEAR(found.distance_m, gap_m * side.norm(), found.error_m) << gap_m << " along " << side.transpose();
      EXPECT_LT(found.error_m, 1e-13);
    }
  }
}

// At the ends of the range squares overflow or vanish: every pair is then offered, and none is lost.
TEST(MeshDistance, AtTheEndsOfTheRangeLosesNothing) {
  const TriangleMesh box = scenes::box({1, 1, 1});
  for (const double size : {0x1p-500, 0x1p-150, 0x1p150, 0x1p500}) {
    const PlacedMesh a(scaled(box, size), {});
    const PlacedMesh b(scaled(box, size), {.position = Vec3(3 * size, 0, 0), .rotation = Quat::Identity()});
    const PlacedMesh speck(box, {.position = Vec3(3 * size, 0, 0), .rotation = Quat::Identity()});
    expect_as_every_pair(a, b, "equal sizes");
    if (size > 1) expect_as_every_pair(a, speck, "a speck beside it");
  }
}

// A walk that offered everything would pass all of the above.
TEST(MeshDistance, TestsFewPairsOfManyTriangles) {
  const TriangleMesh ball = latitude_longitude_sphere(1, 130, 64);
  const PlacedMesh a(ball, {});
  const Quat turn = Quat(0.3, -0.5, 0.7, 0.2).normalized();
  WalkCost apart;
  walked(a, PlacedMesh(ball, {.position = {1.2, 1.6, 1.5}, .rotation = turn}), apart);
  EXPECT_LT(apart.candidates, ball.triangles.size() / 16);
  EXPECT_LT(apart.nodes, ball.triangles.size() / 4);
  WalkCost far;
  walked(a, PlacedMesh(ball, {.position = {1.2e6, 1.6e6, 1.5e6}, .rotation = turn}), far);
  EXPECT_LT(far.candidates, ball.triangles.size() / 16);
  WalkCost within;
  walked(a, PlacedMesh(scaled(ball, 0.9), {.position = {0.01, 0.02, -0.01}, .rotation = turn}), within);
  EXPECT_LT(within.candidates, ball.triangles.size());
}

// Every instruction set offers the same pairs in the same order, so that an answer does not depend on the machine.
TEST(MeshDistance, IsTheSameForEveryInstructionSet) {
  std::mt19937_64 random = oracle::seeded(20261127);
  AnyMesh make(random);
  const PlacedMesh a(latitude_longitude_sphere(1, 40, 20), {});
  const PlacedMesh b(make.mesh(2), {.position = {0, 1.7, 2.2}, .rotation = make.rotation()});
  std::vector<std::int64_t> targets;
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) targets.push_back(rest & -rest);
  WalkCost expected_cost;
  const Separation expected = walked(a, b, expected_cost);
  for (const std::int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    WalkCost cost;
    const Separation found = walked(a, b, cost);
    EXPECT_EQ(found.distance_m, expected.distance_m) << hwy::TargetName(target);
    EXPECT_EQ(found.error_m, expected.error_m) << hwy::TargetName(target);
    EXPECT_EQ(found.on_a, expected.on_a) << hwy::TargetName(target);
    EXPECT_EQ(cost.candidates, expected_cost.candidates) << hwy::TargetName(target);
    EXPECT_EQ(cost.nodes, expected_cost.nodes) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

// The walk is asked at each pair of nodes: it ends long before a nearest pair is known, and says so.
TEST(MeshDistance, EndsAtTheDeadline) {
  const TriangleMesh ball = latitude_longitude_sphere(1, 130, 64);
  const PlacedMesh a(ball, {});
  const PlacedMesh b(scaled(ball, 0.95), {});
  Deadline over(1);
  WalkCost cost;
  distance_between(a.placed(), b.placed(), cost, over);
  EXPECT_TRUE(over.was_over());
  EXPECT_LT(cost.nodes, 3u);
}

}  // namespace
}  // namespace collided::engine
