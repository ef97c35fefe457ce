// Slabs: rays against boxes, and against k-DOPs and frustums, which the engine holds as hulls of their corners.
// In whole numbers the slabs' answer is exact: the hits, the entries and the points inside are the same.  // A32 A33 A34
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/bounding_volumes.hpp"
#include "server/geometry/convex_hull.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/slabs.hpp"

namespace collided::engine::ray_slabs_test {
namespace {

using oracle::dot;
using oracle::Whole;
using oracle::WholeSolid;
using oracle::WholeVector;

Vec3 vec(const WholeVector& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

std::optional<Hull> hull_of(const std::vector<WholeVector>& corners) {
  std::vector<Vec3> points;
  for (const WholeVector& corner : corners) points.push_back(vec(corner));
  auto mesh = convex_hull(points);
  if (!mesh) return std::nullopt;
  return Hull{std::make_shared<const TriangleMesh>(std::move(*mesh))};
}

Whole number(std::mt19937_64& random, Whole low, Whole high) {
  return low + static_cast<Whole>(random() % static_cast<std::uint64_t>(high - low + 1));
}

struct Tally {
  int hits = 0;
  int misses = 0;
  int inside = 0;
};

/// Rays between lattice points about the solid: along faces, through edges and corners, beside it.
void compare(const WholeSolid& solid, const Hull& hull, Whole size, std::mt19937_64& random, Tally& tally) {
  for (int i = 0; i < 40; ++i) {
    WholeVector origin, target, direction;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin[axis] = number(random, -2, 2) * size / 2;
      target[axis] = number(random, -3, 3) * size / 3;
      direction[axis] = target[axis] - origin[axis];
    }
    const bool holds = solid.holds(origin);
    ASSERT_EQ(overlaps(Sphere{vec(origin), 0}, hull).yes(), holds) << vec(origin).transpose();
    if (direction == WholeVector{}) continue;
    const auto truth = slab_entry(solid, origin, direction);
    RayHit hit;
    const ExactResult found = cast_ray(Ray{vec(origin), vec(direction)}, hull, hit);
    ASSERT_EQ(found.decision, truth ? Decision::yes : Decision::no)
        << vec(origin).transpose() << " towards " << vec(direction).transpose();
    ++(truth ? tally.hits : tally.misses);
    tally.inside += holds ? 1 : 0;
    if (!truth) continue;
    const double entry_m =
        static_cast<double>(truth->above) / static_cast<double>(truth->below) * vec(direction).norm();
    ASSERT_NEAR(hit.distance_m, entry_m, hit.distance_error_m + 1e-14 * entry_m);
    ASSERT_EQ(hit.inside, holds);
  }
}

/// The k-DOP of some lattice points; its corners are whole, since twelve is a multiple of the determinants of its normals.
WholeSolid whole_kdop(int sides, std::mt19937_64& random) {
  std::vector<WholeVector> points(6);
  for (WholeVector& point : points) {
    for (Whole& coordinate : point) coordinate = 12 * number(random, -4, 4);
  }
  WholeSolid solid;
  for (const Vec3& normal : kdop_normals(sides)) {
    const WholeVector ahead{static_cast<Whole>(normal[0]), static_cast<Whole>(normal[1]),
                            static_cast<Whole>(normal[2])};
    const WholeVector back{-ahead[0], -ahead[1], -ahead[2]};
    Whole high = dot(ahead, points[0]), low = high;
    for (const WholeVector& point : points)
      high = std::max(high, dot(ahead, point)), low = std::min(low, dot(ahead, point));
    solid.planes.push_back({ahead, high});
    solid.planes.push_back({back, -low});
  }
  return solid;
}

// A32: a box is three slabs. Directions with zeros, starts on a face and rays along it: whole numbers know every answer,
// and no number of a hit is NaN.
TEST(ExactRaySlabs, ARayMeetsABoxAsItsSlabsSay) {
  std::mt19937_64 random = oracle::seeded(32);
  int hits = 0, zeros = 0, on_a_slab = 0;
  constexpr int kRays = 1'000'000;
  for (int i = 0; i < kRays; ++i) {
    WholeVector low, high, origin, direction;
    WholeSolid solid;
    bool on = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = 2 * number(random, -4, 3), high[axis] = low[axis] + 2 * number(random, 0, 4);
      origin[axis] = number(random, -9, 12), direction[axis] = number(random, -3, 3);
      WholeVector ahead{}, back{};
      ahead[axis] = 1, back[axis] = -1;
      solid.planes.push_back({ahead, high[axis]});
      solid.planes.push_back({back, -low[axis]});
      on = on || origin[axis] == low[axis] || origin[axis] == high[axis];
    }
    if (direction == WholeVector{}) continue;
    const bool has_zero = std::count(direction.begin(), direction.end(), 0) > 0;
    zeros += has_zero ? 1 : 0;
    on_a_slab += has_zero && on ? 1 : 0;
    const auto truth = slab_entry(solid, origin, direction);
    const Box box{(vec(low) + vec(high)) / 2, Mat3::Identity(), (vec(high) - vec(low)) / 2};
    RayHit hit;
    ASSERT_EQ(cast_ray(Ray{vec(origin), vec(direction)}, box, hit).decision, truth ? Decision::yes : Decision::no) << i;
    if (!truth) continue;
    ++hits;
    const double entry_m =
        static_cast<double>(truth->above) / static_cast<double>(truth->below) * vec(direction).norm();
    ASSERT_NEAR(hit.distance_m, entry_m, hit.distance_error_m + 1e-14 * entry_m) << i;
    ASSERT_TRUE(std::isfinite(hit.exit_m) && hit.point.allFinite() && hit.normal.allFinite()) << i;
  }
  EXPECT_GT(hits, kRays / 40);
  EXPECT_GT(zeros, kRays / 10);
  EXPECT_GT(on_a_slab, kRays / 20);
}

// A34
TEST(ExactRaySlabs, ARayMeetsAKDopAsItsSlabsSay) {
  std::mt19937_64 random = oracle::seeded(34);
  for (const int sides : {6, 14, 18, 26}) {
    Tally tally;
    for (int i = 0; i < 60; ++i) {
      const WholeSolid solid = whole_kdop(sides, random);
      const auto hull = hull_of(solid.whole_corners());
      if (!hull) continue;  // flat
      compare(solid, *hull, 48, random, tally);
      if (HasFatalFailure()) FAIL() << sides << " sides, " << i;
    }
    EXPECT_GT(tally.hits, 200) << sides;
    EXPECT_GT(tally.misses, 200) << sides;
    EXPECT_GT(tally.inside, 20) << sides;
  }
}

/// What a camera at the origin sees along z between two distances: the picture is from (left, low) to (right, high) at a
/// distance of `away`, and need not lie about the axis.
WholeSolid frustum(Whole away, Whole left, Whole right, Whole low, Whole high, Whole nearest, Whole farthest) {
  return {{{{0, 0, -1}, -nearest * away},
           {{0, 0, 1}, farthest * away},
           {{-away, 0, left}, 0},
           {{away, 0, -right}, 0},
           {{0, -away, low}, 0},
           {{0, away, -high}, 0}}};
}

/// Boxes inside, outside and across, against the frustum's faces clipped to the box and its half-spaces about the centre.
void compare_boxes(const WholeSolid& solid, const Hull& hull, std::mt19937_64& random, Tally& tally) {
  for (int i = 0; i < 6; ++i) {
    WholeVector center;
    for (Whole& coordinate : center) coordinate = number(random, -12, 20);
    const Box box{vec(center), Mat3::Identity(), Vec3::Constant(static_cast<double>(number(random, 0, 8)))};
    bool truth = solid.holds(center);
    for (std::uint32_t face = 0; face < hull.mesh->triangles.size() && !truth; ++face) {
      truth = oracle::overlaps_by_clipping(box, hull.mesh->triangle(face));
    }
    ASSERT_EQ(overlaps(box, hull).yes(), truth) << vec(center).transpose();
    ++(truth ? tally.hits : tally.misses);
  }
}

// A33: a frustum is six half-spaces: the rays that enter it, the points and the boxes that a camera sees. As a question of
// the world it is a pair with an object of this shape.
TEST(ExactRaySlabs, AFrustumHoldsAndIsMetAsItsHalfSpacesSay) {
  std::mt19937_64 random = oracle::seeded(33);
  Tally tally, boxes;
  for (int i = 0; i < 200; ++i) {
    const Whole left = number(random, -6, 0), low = number(random, -6, 0);
    const WholeSolid solid = frustum(number(random, 1, 6), left, left + number(random, 1, 8), low,
                                     low + number(random, 1, 8), number(random, 1, 2), number(random, 3, 5));
    const std::vector<WholeVector> corners = solid.whole_corners();
    ASSERT_EQ(corners.size(), 8u);
    const auto hull = hull_of(corners);
    ASSERT_TRUE(hull);
    compare(solid, *hull, 24, random, tally);
    if (i % 10 == 0) compare_boxes(solid, *hull, random, boxes);  // clipping takes milliseconds
    if (HasFatalFailure()) FAIL() << i;
  }
  EXPECT_GT(boxes.hits, 10);
  EXPECT_GT(boxes.misses, 20);
  EXPECT_GT(tally.hits, 500);
  EXPECT_GT(tally.misses, 500);
  EXPECT_GT(tally.inside, 50);
}

}  // namespace
}  // namespace collided::engine::ray_slabs_test
