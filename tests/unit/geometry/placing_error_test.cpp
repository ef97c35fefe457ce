#include "server/geometry/placing_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/plane_reach.hpp"
#include "tests/oracle/seed.hpp"

// Where things are placed in double, against where the numbers given have them: (q v q*) / |q|^2 + p.

namespace collided::engine {
namespace {

using oracle::Point;
using oracle::Rational;
using oracle::Wide;

/// The quaternion as a publisher sends it, its length a little off, and the frame that the border makes of it.
struct Given {
  Quat q;
  Vec3 position;
  Frame frame;

  Given(std::mt19937_64& generator, double far_m) {
    std::normal_distribution<double> any;
    std::uniform_real_distribution<double> coordinate(-far_m, far_m);
    q = Quat(any(generator), any(generator), any(generator), any(generator)).normalized();
    q.coeffs() *= 1 + std::uniform_real_distribution<double>(-1e-6, 1e-6)(generator);
    position = Vec3(coordinate(generator), coordinate(generator), coordinate(generator));
    Pose pose{position, Quat()};
    pose.rotation.coeffs() = q.coeffs() / q.norm();
    frame = frame_of(pose);
  }

  /// v + 2 w (u x v) + 2 u x (u x v), all over |q|^2.
  Point place_exactly(const Point& v) const {
    const Point u = oracle::exact(q.vec());
    const Rational w = q.w();
    const Rational uu = oracle::dot(u, u);
    const Point turned =
        oracle::plus(oracle::times(w * w - uu, v),
                     oracle::plus(oracle::times(2 * oracle::dot(u, v), u), oracle::times(2 * w, oracle::cross(u, v))));
    return oracle::plus(oracle::times(1 / (w * w + uu), turned), oracle::exact(position));
  }
};

double length(const Point& v) { return static_cast<double>(sqrt(Wide(oracle::dot(v, v)))); }

TEST(GeometryPlacingError, NoPlacedPointIsFartherOff) {
  std::mt19937_64 generator = oracle::seeded(40);
  std::normal_distribution<double> any;
  double worst = 0;
  for (int i = 0; i < 6000; ++i) {
    const Given given(generator, i % 3 == 0 ? 0 : std::pow(10, i % 9));
    const Vec3 own = Vec3(any(generator), any(generator), any(generator)) * std::pow(10, i % 5 - 2);
    const Point off = oracle::minus(oracle::exact(place(given.frame, own)), given.place_exactly(oracle::exact(own)));
    const double bound_m = placing_error_m(given.frame, Sphere{own, 1});
    ASSERT_LE(length(off), bound_m) << i;
    ASSERT_LE(bound_m, placing_error_m(given.frame, own.norm() * (1 + 1e-15)));
    worst = std::max(worst, length(off) / bound_m);
  }
  EXPECT_GT(worst, 0.2) << "and the bound is no more than it must be";
}

/// A shape that is not turned loses what the sums lose, and nothing where they are exact.
TEST(GeometryPlacingError, WhatIsMovedByHalvesAndWholesLosesNothing) {
  const Frame moved{Mat3::Identity(), {2.5, -3, 1024}};
  EXPECT_EQ(placing_error_m(moved, Sphere{{0.5, 0.25, 3}, 0.1}), 0);
  EXPECT_EQ(placing_error_m(moved, Box{.center = {1, 2, 3}, .half_m = {0.1, 0.2, 0.3}}), 0);
  EXPECT_EQ(placing_error_m(moved, Cylinder{{0, 0, -1}, {0, 0, 1}, 0.7}), 0);
  EXPECT_EQ(placing_error_m(Frame{}, Triangle{{0.1, 0.2, 0.3}, {1, 2, 3}, {0, 0, 0.7}}), 0);
  EXPECT_EQ(placing_error_m(Frame{}, 5.0), 0);
  EXPECT_GT(placing_error_m(moved, Sphere{{0.1, 0.25, 3}, 0.1}), 0);
}

/// The rims of a short cylinder and cone far out: their ends round, which turns the discs.
TEST(GeometryPlacingError, ADiscsRimIsNoFartherOffThanItsAxisTurnsIt) {
  std::mt19937_64 generator = oracle::seeded(41);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  for (int i = 0; i < 600; ++i) {
    const Given given(generator, std::pow(10, i % 7));
    const double half_m = std::pow(10, -(i % 6)) / 2;
    const Cylinder own{{0, 0, -half_m}, {0, 0, half_m}, 1};
    const Cylinder placed = place(given.frame, own);
    const double bound_m = placing_error_m(given.frame, own);
    const double at = angle(generator);
    // As near the rim as doubles come, and not outside it.
    const Vec3 rim(std::cos(at) * (1 - 1e-15), std::sin(at) * (1 - 1e-15), half_m);
    const Point truth = given.place_exactly(oracle::exact(rim));
    const Point axis = oracle::minus(oracle::exact(placed.b), oracle::exact(placed.a));
    const Point to = oracle::minus(truth, oracle::exact(placed.a));
    const Point turn = oracle::cross(to, axis);
    const Wide l = sqrt(Wide(oracle::dot(axis, axis)));
    const Wide along = Wide(oracle::dot(to, axis)) / l;
    const Wide beyond = along > l ? Wide(along - l) : Wide(0);
    const Wide out = sqrt(Wide(oracle::dot(turn, turn))) / l - 1;
    const double off_m = static_cast<double>(sqrt(beyond * beyond + (out > 0 ? Wide(out * out) : Wide(0))));
    ASSERT_LE(off_m, bound_m) << i;
    ASSERT_LE(bound_m, placing_error_m(given.frame, Cone{own.a, own.b, own.radius_m}) * (1 + 1e-12));
  }
}

/// A box's corner and an ellipsoid's ends of its axes.
TEST(GeometryPlacingError, CornersAndAxesAreNoFartherOff) {
  std::mt19937_64 generator = oracle::seeded(42);
  for (int i = 0; i < 1000; ++i) {
    const Given given(generator, std::pow(10, i % 7));
    const Box own{.center = {0.25, -0.5, 0.75}, .half_m = {0.3, 0.5, 70}};
    const Box placed = place(given.frame, own);
    Point corner = oracle::exact(placed.center);
    Point truth = oracle::exact(own.center);
    for (int k = 0; k < 3; ++k) {
      const Rational reach = i >> k & 1 ? Rational(own.half_m[k]) : Rational(-own.half_m[k]);
      corner = oracle::plus(corner, oracle::times(reach, oracle::exact(placed.axes.col(k))));
      truth[static_cast<std::size_t>(k)] += reach;
    }
    ASSERT_LE(length(oracle::minus(corner, given.place_exactly(truth))), placing_error_m(given.frame, own)) << i;
    EXPECT_EQ(placing_error_m(given.frame, own),
              placing_error_m(given.frame, Ellipsoid{own.center, own.axes, own.half_m}));
  }
}

}  // namespace
}  // namespace collided::engine
