#include <gtest/gtest.h>
#include <gmpxx.h>

#include <array>
#include <cmath>
#include <numeric>

#include "server/geometry/bounding_volumes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

// Each volume contains every point, by rationals.  // A22 A24 A26 A27 A28
namespace collided::engine {
namespace {

using Exact = std::array<mpq_class, 3>;

Exact exact(const Vec3& v) { return {mpq_class(v[0]), mpq_class(v[1]), mpq_class(v[2])}; }
mpq_class dot(const Exact& a, const Exact& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Exact minus(const Exact& a, const Exact& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
mpq_class det(const Exact& a, const Exact& b, const Exact& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1]) + c[0] * (a[1] * b[2] - a[2] * b[1]);
}

bool holds(const Kdop& kdop, const Vec3& point) {
  for (std::size_t i = 0; i < kdop.normals.size(); ++i) {
    const mpq_class reach = dot(exact(kdop.normals[i]), exact(point));
    if (std::isfinite(kdop.low[i]) && reach < mpq_class(kdop.low[i])) return false;
    if (std::isfinite(kdop.high[i]) && reach > mpq_class(kdop.high[i])) return false;
  }
  return true;
}

bool holds(const Sphere& sphere, const Vec3& point) {
  const Exact away = minus(exact(point), exact(sphere.center));
  return dot(away, away) <= mpq_class(sphere.radius_m) * mpq_class(sphere.radius_m);
}

/// The shares u of center + sum u_i half_i axis_i, by Cramer's rule.
bool holds(const Box& box, const Vec3& point) {
  const Exact away = minus(exact(point), exact(box.center));
  std::array<Exact, 3> axes{exact(box.axes.col(0)), exact(box.axes.col(1)), exact(box.axes.col(2))};
  const mpq_class whole = det(axes[0], axes[1], axes[2]);
  for (int i = 0; i < 3; ++i) {
    std::array<Exact, 3> with = axes;
    with[static_cast<std::size_t>(i)] = away;
    if (abs(det(with[0], with[1], with[2]) / whole) > mpq_class(box.half_m[i])) return false;
  }
  return true;
}

std::vector<std::vector<Vec3>> clouds(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<std::vector<Vec3>> all{
      {{1, 2, 3}}, {{0, 0, 0}, {1e-300, 0, 0}}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, scenes::box({1, 2, 3}).vertices};
  for (int i = 0; i < 60; ++i) {
    std::vector<Vec3> cloud;
    const Vec3 stretch(std::pow(10.0, 2 * unit(random)), std::pow(10.0, 2 * unit(random)), i % 5 == 0 ? 0 : 1);
    const Mat3 turn = Quat(unit(random), unit(random), unit(random), 1).normalized().toRotationMatrix();
    const Vec3 place = (i % 3) * 1e6 * Vec3(unit(random), unit(random), unit(random));
    const double scale = i % 7 == 0 ? 1e-150 : i % 7 == 1 ? 1e120 : 1;
    for (int k = 0; k < 40; ++k)
      cloud.push_back(scale * (place + turn * Vec3(unit(random), unit(random), unit(random)).cwiseProduct(stretch)));
    if (i % 4 == 0) {
      for (Vec3& p : cloud) p = (p * (8 / scale)).array().round() * scale;  // ties
    }
    all.push_back(cloud);
  }
  return all;
}

TEST(BoundingVolumes, ContainEveryPoint) {
  std::mt19937_64 random = oracle::seeded(241);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const std::vector<Vec3>& cloud : clouds(random)) {
    std::vector<Kdop> kdops;
    for (const int sides : {6, 14, 18, 26}) kdops.push_back(bounding_kdop(cloud, kdop_normals(sides)));
    kdops.push_back(bounding_kdop(
        cloud, {Vec3(unit(random), unit(random), unit(random)), {1, 0.5, 0.25}, {3, 0, -1}}));  // the user's own
    const Box box = bounding_obb(cloud);
    EXPECT_LE((box.axes.transpose() * box.axes - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-14);
    const Sphere a = diagonal_sphere(cloud);
    const Sphere b = farthest_point_sphere(cloud);
    const Sphere c = smallest_sphere(cloud);
    EXPECT_LE(b.radius_m, a.radius_m);
    EXPECT_LE(c.radius_m, b.radius_m);
    const Aabb aabb = bounding_aabb(cloud);
    for (const Vec3& point : cloud) {
      for (const Kdop& kdop : kdops) {
        ASSERT_TRUE(holds(kdop, point)) << kdop.normals.size();
        ASSERT_NE(contains(kdop, point), std::optional(false));
      }
      ASSERT_TRUE(holds(box, point));
      ASSERT_TRUE(holds(a, point) && holds(b, point) && holds(c, point));
      ASSERT_TRUE((aabb.low.array() <= point.array()).all() && (point.array() <= aabb.high.array()).all());
    }
  }
}

// Outward, but by roundings only: a point a millionth of the size beyond each side is out.
TEST(BoundingVolumes, AreTight) {
  std::mt19937_64 random = oracle::seeded(242);
  for (const std::vector<Vec3>& cloud : clouds(random)) {
    const double size = smallest_sphere(cloud).radius_m;
    const double reach = std::accumulate(cloud.begin(), cloud.end(), 0.0, [](double most, const Vec3& p) {
      return std::max(most, p.cwiseAbs().maxCoeff());
    });
    if (!(size > 1e-9 * reach)) continue;  // far away, roundings are all there is
    const double slack = 1e-12 * (size + reach) + 1e-290;
    for (const int sides : {6, 14, 18, 26}) {
      const Kdop kdop = bounding_kdop(cloud, kdop_normals(sides));
      for (std::size_t i = 0; i < kdop.normals.size(); ++i) {
        double high = -INFINITY;
        for (const Vec3& p : cloud) high = std::max(high, kdop.normals[i].dot(p));
        EXPECT_LE(kdop.high[i], high + slack);
      }
    }
    double farthest = 0;
    const Sphere b = farthest_point_sphere(cloud);
    for (const Vec3& p : cloud) farthest = std::max(farthest, (p - b.center).stableNorm());
    EXPECT_LE(b.radius_m, farthest + slack);
  }
}

// The slack of the box grows with how far its axes are from that: what is measured here has eight roundings of its own at most.
TEST(BoundingVolumes, AxesOfABoxAreOfUnitLengthAndAtRightAnglesToEightRoundings) {
  std::mt19937_64 random = oracle::seeded(244);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const double w = unit(random), x = unit(random), y = unit(random);
    const Mat3 turn = Quat(w, x, y, unit(random)).normalized().toRotationMatrix();
    const Vec3 stretch(1, 0.3 * (1 + unit(random)), 0.01);
    std::vector<Vec3> cloud;
    for (int k = 0; k < 40; ++k) {
      const double a = unit(random), b = unit(random);
      cloud.push_back(turn * Vec3(a, b, unit(random)).cwiseProduct(stretch));
    }
    const Mat3 axes = bounding_obb(cloud).axes;
    ASSERT_LE((axes.transpose() * axes - Mat3::Identity()).cwiseAbs().maxCoeff(), 8 * 0x1p-53) << i;
  }
}

// A24: six sides are the box bit for bit, and more sides never take more room.
TEST(BoundingVolumes, SixSidesAreTheBoxAndMoreSidesNeverTakeMore) {
  std::mt19937_64 random = oracle::seeded(243);
  for (const std::vector<Vec3>& cloud : clouds(random)) {
    const Aabb box = bounding_aabb(cloud);
    const Kdop six = bounding_kdop(cloud, kdop_normals(6));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(six.low[static_cast<std::size_t>(axis)], box.low[axis]);
      EXPECT_EQ(six.high[static_cast<std::size_t>(axis)], box.high[axis]);
    }
    // The slabs of the lesser are among those of the greater, to the bit: so each lies within the one before.
    const auto slabs = [&](int sides) { return bounding_kdop(cloud, kdop_normals(sides)); };
    const auto is_within = [](const Kdop& inner, const Kdop& outer) {
      for (std::size_t i = 0; i < outer.normals.size(); ++i) {
        const auto same =
            std::find(inner.normals.begin(), inner.normals.end(), outer.normals[i]) - inner.normals.begin();
        if (same == static_cast<std::ptrdiff_t>(inner.normals.size())) return false;
        if (inner.low[static_cast<std::size_t>(same)] != outer.low[i] ||
            inner.high[static_cast<std::size_t>(same)] != outer.high[i])
          return false;
      }
      return true;
    };
    EXPECT_TRUE(is_within(slabs(14), six) && is_within(slabs(26), slabs(14)));
    EXPECT_TRUE(is_within(slabs(18), six) && is_within(slabs(26), slabs(18)));
    const double volumes[] = {volume(six), volume(slabs(14)), volume(slabs(26)), volume(slabs(18))};
    if (!(volumes[0] > 1e-200 && volumes[0] < 1e200)) continue;
    EXPECT_NEAR(volumes[0], volume(box), 1e-9 * volumes[0]);
    EXPECT_LE(volumes[1], volumes[0] * (1 + 1e-9));
    EXPECT_LE(volumes[2], volumes[1] * (1 + 1e-9));
    EXPECT_LE(volumes[3], volumes[0] * (1 + 1e-9));
  }
}

TEST(BoundingVolumes, KnownByHand) {
  const std::vector<Vec3> octahedron{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  EXPECT_NEAR(volume(bounding_kdop(octahedron, kdop_normals(6))), 8, 1e-12);
  EXPECT_NEAR(volume(bounding_kdop(octahedron, kdop_normals(14))), 4.0 / 3, 1e-12) << "the octahedron itself";
  EXPECT_NEAR(diagonal_sphere(octahedron).radius_m, std::sqrt(3.0), 1e-14);
  EXPECT_EQ(smallest_sphere(octahedron).center, Vec3(0, 0, 0));
  EXPECT_NEAR(smallest_sphere(octahedron).radius_m, 1, 1e-14);
  // A needle askew: the box along it is all but flat.
  std::vector<Vec3> needle;
  for (int i = 0; i < 50; ++i) needle.emplace_back(i, 2 * i, 2 * i + 0.001 * (i % 3));
  EXPECT_LT(volume(bounding_obb(needle)), 1e-3 * volume(bounding_aabb(needle)));
  // An obtuse triangle: the smallest sphere is the one on its longest side; about its corners it would be larger.
  EXPECT_NEAR(smallest_sphere(std::vector<Vec3>{{0, 0, 0}, {10, 0, 0}, {5, 1, 0}}).radius_m, 5, 1e-14);
  // A regular tetrahedron of edge sqrt 8: radius sqrt 3.
  EXPECT_NEAR(smallest_sphere(std::vector<Vec3>{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}).radius_m,
              std::sqrt(3.0), 1e-14);
  EXPECT_THROW(kdop_normals(8), std::invalid_argument);
  EXPECT_EQ(contains(bounding_kdop(octahedron, kdop_normals(14)), {0.5, 0.5, 0.1}), std::optional(false));
  EXPECT_EQ(contains(bounding_kdop(octahedron, kdop_normals(14)), {0.25, 0.5, 0.25}), std::optional(true));
}

TEST(BoundingVolumes, TheSmallestSphereIsNoLargerThanAnyOther) {
  std::mt19937_64 random = oracle::seeded(244);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 15; ++i) {
    std::vector<Vec3> cloud;
    for (int k = 0; k < 30; ++k) cloud.emplace_back(unit(random), unit(random), unit(random));
    const double radius_m = smallest_sphere(cloud).radius_m;
    // Ritter's and many others' centres; the least over a shrinking search is a bound from above that the true one meets.
    Vec3 center = Vec3::Zero();
    double step = 1;
    for (int k = 0; k < 4000; ++k) {
      const Vec3 other = center + step * Vec3(unit(random), unit(random), unit(random));
      if (sphere_about(cloud, other).radius_m < sphere_about(cloud, center).radius_m) center = other;
      else step = std::max(1e-9, step * 0.99);
    }
    EXPECT_LE(radius_m, sphere_about(cloud, center).radius_m * (1 + 1e-12)) << i;
  }
}

}  // namespace
}  // namespace collided::engine
