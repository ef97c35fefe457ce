// Bounds contain what they bound: turned, far out, under way. A candidate too many costs time, one too few a collision.
#include <gtest/gtest.h>

#include <cmath>

#include "server/geometry/placing_error.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/objects/part_index.hpp"
#include "server/world/objects/sweep.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

class WorldPlacedBounds : public testing::Test {
 protected:
  double any(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vec3 point(double size) { return {any(-size, size), any(-size, size), any(-size, size)}; }
  Pose pose(double size) {
    return {.position = point(size), .rotation = Quat(any(-1, 1), any(-1, 1), any(-1, 1), any(-1, 1)).normalized()};
  }
  static ObjectInfo mesh_object(TriangleMesh mesh) {
    auto shared = std::make_shared<const TriangleMesh>(std::move(mesh));
    ObjectInfo info;
    info.mesh = indexed_mesh(shared, Bvh::build(*shared));
    return info;
  }
  std::mt19937_64 random = oracle::seeded(81);
};

bool contains(const Aabb& box, const Vec3& p) {
  return (box.low.array() <= p.array()).all() && (p.array() <= box.high.array()).all();
}
bool contains(const Aabb& box, const Aabb& inner) { return contains(box, inner.low) && contains(box, inner.high); }

// The corners of a box-shaped mesh lie on its own bounds, so a turned corner lies on the placed ones, or a rounding beyond.
TEST_F(WorldPlacedBounds, ATurnedMeshLiesWithinItsBoundsToTheLastBit) {
  for (int i = 0; i < 2'000; ++i) {
    const ObjectInfo info =
        mesh_object(scenes::box({any(0.1, 1), any(0.1, 1), any(0.1, 1)}, point(i % 2 == 0 ? 0 : 3)));
    const Frame frame = frame_of(pose(i % 3 == 0 ? 1 : std::pow(10, i % 7)));
    const Aabb bounds = bounds_of(info, frame);
    for (const Vec3& vertex : info.mesh->mesh->vertices) ASSERT_TRUE(contains(bounds, place(frame, vertex))) << i;
    EXPECT_LT((bounds.high - bounds.low).maxCoeff(), 2 * info.mesh->radius_m + 1e-3)
        << "no more than a rounding too large";
  }
}

// Corners in a wider type, moved by what placing may be off: none leaves the bounds, at any size, and they are not wider
// than the tightest ones by more than roundings.
TEST_F(WorldPlacedBounds, ATurnedBoxLiesWithinItsBoundsWhereverItsPlacingPutsIt) {
  int turned = 0;
  for (int i = 0; i < 20'000; ++i) {
    const int power = static_cast<int>(any(-330, 300));
    const double size_m = i % 2 == 0 ? 1 : std::pow(10, power);
    const Box own{.center = i % 3 == 0 ? Vec3(Vec3::Zero()) : Vec3(size_m * point(1)),
                  .half_m = size_m * (point(1).cwiseAbs() + Vec3::Constant(i % 5 == 0 ? 0 : 1e-3))};
    const Frame frame = frame_of(pose(i % 4 == 0 ? 1e6 * size_m : size_m));
    const double off_m = placing_error_m(frame, own);
    if (off_m == 0) continue;  // all of it underflows, and the tightest bounds serve
    ++turned;
    const Box placed = place(frame, own);
    const Aabb bounds = bounds_as_given(frame, own);
    const Aabb tight = engine::bounds(placed);
    for (int k = 0; k < 3; ++k) {
      long double reach = off_m;
      for (int axis = 0; axis < 3; ++axis) {
        reach += std::abs(static_cast<long double>(placed.axes(k, axis))) * placed.half_m[axis];
      }
      ASSERT_LE(bounds.low[k], placed.center[k] - reach) << i;
      ASSERT_GE(bounds.high[k], placed.center[k] + reach) << i;
      const double largest_m = std::max(std::abs(tight.low[k]), std::abs(tight.high[k]));
      EXPECT_GE(bounds.low[k], tight.low[k] - off_m - 1e-14 * largest_m - 1e-322) << i;
      EXPECT_LE(bounds.high[k], tight.high[k] + off_m + 1e-14 * largest_m + 1e-322) << i;
    }
  }
  EXPECT_GT(turned, 15'000);
}

TEST_F(WorldPlacedBounds, TurnedPartsWithAnIndexLieWithinTheirsToo) {
  for (int i = 0; i < 300; ++i) {
    std::vector<Primitive> parts;
    for (int k = 0; k < 40; ++k) {
      if (k % 2 == 0) parts.push_back(Sphere{point(1), any(0, 0.1)});
      else parts.push_back(Capsule{point(1), point(1), any(0, 0.1)});
    }
    // Balls of no size at the corners of all the others' bounds.
    for (int corner = 0; corner < 8; ++corner) {
      parts.push_back(Sphere{Vec3(corner & 1 ? 2 : -2, corner & 2 ? 3 : -3, corner & 4 ? 4 : -4), 0});
    }
    ObjectInfo info;
    info.primitives = SharedPrimitives(parts);
    info.rare.edit().parts = index_parts(info.primitives);
    ASSERT_TRUE(info.rare->parts);
    const Frame frame = frame_of(pose(std::pow(10, i % 7)));
    const Aabb bounds = bounds_of(info, frame);
    for (const Primitive& primitive : info.primitives) {
      if (const auto* ball = std::get_if<Sphere>(&primitive); ball && ball->radius_m == 0) {
        ASSERT_TRUE(contains(bounds, place(frame, *ball).center)) << i;
      }
    }
  }
}

// An object's own frame may be far out and turned: what of it lies in a box of the world is in the box seen from there.
TEST_F(WorldPlacedBounds, WhatABoxOfTheWorldHoldsIsInTheBoxSeenFromAFrame) {
  for (int i = 0; i < 2'000; ++i) {
    const Frame frame = frame_of(pose(std::pow(10, i % 7)));
    std::vector<Vec3> own;
    Aabb world;
    for (int k = 0; k < 8; ++k) {
      own.push_back(point(1));
      world.extend(place(frame, own.back()));
    }
    const Aabb seen = seen_from(frame, world, std::sqrt(3.0));
    for (const Vec3& p : own) ASSERT_TRUE(contains(seen, p)) << i;
    // A single point: nothing but roundings is between the two.
    const Vec3 placed = place(frame, own[0]);
    ASSERT_TRUE(contains(seen_from(frame, {.low = placed, .high = placed}, std::sqrt(3.0)), own[0])) << i;
  }
}

TEST_F(WorldPlacedBounds, OfWhatLiesBeyondAllNumbersEverythingIsACandidate) {
  const double huge = std::numeric_limits<double>::max();
  const Frame turned{Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()).toRotationMatrix(), Vec3(-huge, huge, 0)};
  const Aabb seen = seen_from(turned, {.low = Vec3(huge / 2, -huge, 0), .high = Vec3(huge, -huge / 2, 1)}, 1);
  EXPECT_EQ(seen.low, Vec3::Constant(-INFINITY));
  EXPECT_EQ(seen.high, Vec3::Constant(INFINITY));
}

// Two meshes so far apart are not tested until they have gone as far together: a turn that is thought shorter than it is
// lets a blade pass through what it would meet.
TEST_F(WorldPlacedBounds, NoPointGoesFartherThanTheLongestWay) {
  for (int i = 0; i < 5'000; ++i) {
    const double angle = i % 10 == 0 ? any(3, M_PI) : std::pow(10, any(-6, 0));
    const double reach_m = any(0.1, 3);
    const Vec3 travel = i % 3 == 0 ? Vec3(Vec3::Zero()) : point(2);
    const Frame from = frame_of(pose(1));
    const Frame to{Mat3(Eigen::AngleAxisd(angle, point(1).normalized()) * from.rotation), from.position + travel};
    const double longest_m = longest_displacement_m(from, to, reach_m);
    const double truth_m = travel.norm() + angle * reach_m;
    EXPECT_GE(longest_m * (1 + 1e-9), truth_m) << angle;
    EXPECT_LE(longest_m, 1.58 * truth_m) << "little more than that";
  }
}

TEST_F(WorldPlacedBounds, AnObjectUnderWayLiesWithinItsBoundsAtEveryTime) {
  for (int i = 0; i < 300; ++i) {
    const ObjectInfo info = mesh_object(scenes::box({any(0.1, 1), any(0.1, 1), any(0.1, 1)}, point(1)));
    const Frame from = frame_of(pose(3));
    const Frame to{Mat3(Eigen::AngleAxisd(any(0, 3.1), point(1).normalized()) * from.rotation),
                   from.position + point(1)};
    const BodyMotion motion(from, to);
    const Aabb all = bounds(info, motion, reach_of(info));
    const Aabb quick = quick_bounds(info, from, to, bounds_of(info, to), reach_of(info));
    for (int k = 0; k <= 16; ++k) {
      ASSERT_TRUE(contains(all, bounds_of(info, motion.at(k / 16.0)))) << i;
      ASSERT_TRUE(contains(quick, bounds_of(info, motion.at(k / 16.0)))) << i;
    }
  }
}

TEST_F(WorldPlacedBounds, TheReachOfEachKindIsThatKnownByHand) {
  const auto of = [](const Primitive& primitive) {
    ObjectInfo info;
    info.primitives = {primitive};
    return reach_of(info);
  };
  const auto expect = [](double reach_m, double truth_m) {
    EXPECT_GE(reach_m, truth_m * (1 - 1e-15));
    EXPECT_LE(reach_m, 3.001 * truth_m) << "generous for what has corners, but not without end";
  };
  expect(of(Sphere{{3, 4, 0}, 0.5}), 5.5);
  expect(of(Box{.center = Vec3::Zero(), .half_m = {2, 3, 6}}), 7);
  expect(of(Capsule{{0, 0, 1}, {0, 0, 4}, 0.25}), 4.25);
  expect(of(Cylinder{{0, 0, -4}, {0, 0, 4}, 3}), 5);
  expect(of(Cylinder{{0, 0, -0.1}, {0, 0, 0.1}, 3}), std::hypot(3, 0.1));
  expect(of(Ellipsoid{.center = Vec3::Zero(), .half_m = {2, 0.5, 1}}), 2);
  expect(reach_of(mesh_object(scenes::box({2, 3, 6}))), 7);
  ObjectInfo both = mesh_object(scenes::box({2, 3, 6}));
  both.primitives = {Sphere{{0, 0, 20}, 0.5}};
  expect(reach_of(both), 20.5);
}

}  // namespace
}  // namespace collided::engine
