#include "server/world/fences/fence_outline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace collided::engine {
namespace {

constexpr double kBeyond_m = 0.75;

ObjectInfo of(const Primitive& shape) {
  ObjectInfo body;
  body.primitives = {shape};
  return body;
}

/// How far the point is from the axis' segment, along it (0 beside it), and from the axis.
struct FromAxis {
  double beyond_ends_m;
  double across_m;
};
FromAxis from_axis(const Vec3& a, const Vec3& b, const Vec3& point) {
  const Vec3 n = (b - a).normalized();
  const double along_m = (point - a).dot(n);
  return {std::max({0.0, -along_m, along_m - (b - a).norm()}), (point - a - along_m * n).norm()};
}

template <class Distance>
void expect_on_surface(const ObjectInfo& body, const Distance& distance) {
  std::size_t count = 0;
  for (const Polyline& line : outline_of(body, kBeyond_m)) {
    for (const Vec3& point : line) {
      ASSERT_NEAR(distance(point), kBeyond_m, 1e-12) << point.transpose();
      ++count;
    }
  }
  EXPECT_GT(count, 50u);
}

// A box that lies askew in its object has its band askew too, not about its axis-aligned bounds.
TEST(FenceOutline, ABandAboutATurnedBoxIsAtItsDistance) {
  const Mat3 axes = Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Box box{.center = {1, 2, 3}, .axes = axes, .half_m = {0.5, 1, 2}};
  expect_on_surface(of(box), [&](const Vec3& point) {
    const Vec3 in_box = (axes.transpose() * (point - box.center)).cwiseAbs() - box.half_m;
    return in_box.cwiseMax(0).norm();
  });
}

TEST(FenceOutline, ABandAboutACapsuleIsAtItsDistance) {
  const Capsule capsule{.a = {0, 0, 1}, .b = {2, -1, 3}, .radius_m = 0.25};
  expect_on_surface(of(capsule), [&](const Vec3& point) {
    const auto [beyond_ends_m, across_m] = from_axis(capsule.a, capsule.b, point);
    return std::hypot(beyond_ends_m, across_m) - capsule.radius_m;
  });
}

TEST(FenceOutline, ABandAboutACylinderIsAtItsDistance) {
  const Cylinder cylinder{.a = {0, 0, 1}, .b = {2, -1, 3}, .radius_m = 0.25};
  expect_on_surface(of(cylinder), [&](const Vec3& point) {
    const auto [beyond_ends_m, across_m] = from_axis(cylinder.a, cylinder.b, point);
    return std::hypot(beyond_ends_m, std::max(0.0, across_m - cylinder.radius_m));
  });
}

// Of other shapes a box is drawn that holds the band: no line of it is nearer than the band reaches.
TEST(FenceOutline, ABandAboutAnythingElseIsDrawnFartherOut) {
  const Ellipsoid ellipsoid{.center = {1, 0, 0}, .axes = Mat3::Identity(), .half_m = {1, 2, 3}};
  double farthest_m = 0;
  for (const Polyline& line : outline_of(of(ellipsoid), kBeyond_m)) {
    for (const Vec3& point : line) {
      // Outside a larger ellipsoid that lies within the band's surface.
      const Vec3 grown = (point - ellipsoid.center).cwiseQuotient(ellipsoid.half_m);
      EXPECT_GT(grown.norm(), 1);
      farthest_m = std::max(farthest_m, point.z());
    }
  }
  EXPECT_NEAR(farthest_m, 3 + kBeyond_m, 1e-12);
}

// A fence, which has no distance, is drawn as it is.
TEST(FenceOutline, AFenceIsDrawnWhereItIs) {
  const Box box{.center = Vec3::Zero(), .axes = Mat3::Identity(), .half_m = {1, 1, 1}};
  const std::vector<Polyline> lines = outline_of(of(box), 0);
  EXPECT_EQ(lines.size(), 12u);
  for (const Polyline& line : lines) EXPECT_EQ(line.front().cwiseAbs(), Vec3(1, 1, 1));
}

}  // namespace
}  // namespace collided::engine
