#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/arithmetic/ladder.hpp"
#include "server/exact_phase/kernels/overlap_kernel.hpp"
#include "server/exact_phase/motion/ball_motion_filter.hpp"
#include "server/exact_phase/overlap/ball_filter.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::ball_filter_test {
namespace {

Vec3 any(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

MovingSphere resting(const Sphere& ball) {
  return {.start = ball.center, .end = ball.center, .radius_m = ball.radius_m};
}

// Within a rounding or two of touching, at rest and at the end of a way, on every scale.
TEST(BallFilter, NeverPartsWhatMeets) {
  std::mt19937_64 random = oracle::seeded(71);
  std::uniform_real_distribution<double> radius(0.1, 2);
  int touching = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(random() % 900) - 450);
    Sphere a{.center = any(random), .radius_m = radius(random)};
    Sphere b{.center = a.center, .radius_m = radius(random)};
    b.center += (a.radius_m + b.radius_m) * any(random).normalized();
    for (Sphere* ball : {&a, &b}) {
      ball->center *= scale;
      ball->radius_m *= scale;
    }
    if (!overlaps(a, b).yes()) continue;
    ++touching;
    ASSERT_FALSE(kernel::surely_apart(resting(a), b));
    const Vec3 from = a.center + 3 * (a.center - b.center);
    ASSERT_FALSE(kernel::surely_apart({.start = from, .end = a.center, .radius_m = a.radius_m}, b));
  }
  EXPECT_GT(touching, 50'000) << "the scenes must be worth testing";
}

Mat3 turned(std::mt19937_64& random) {
  const Vec3 axis = any(random);
  return Eigen::AngleAxisd(3 * axis.norm(), axis.normalized()).toRotationMatrix();
}

/// A ball that touches, misses or cuts the shape by about `by` of its size at a point of it.
Sphere ball_at(const Vec3& point, const Vec3& outward, double by, std::mt19937_64& random) {
  const double radius = 0.1 + std::abs(any(random)[0]);
  return {.center = point + (radius + by) * outward.normalized(), .radius_m = radius};
}

/// Nothing, or a part in 10^7 to 10^17 either way.
double about_nothing(std::mt19937_64& random) {
  const double size = std::pow(10.0, -7 - static_cast<double>(random() % 11));
  return random() % 4 == 0 ? 0 : random() % 2 == 0 ? size : -size;
}

// Near touching, at faces, edges and corners, on every scale; axes as they come from poses, and some that are skew.
TEST(BallFilter, DecidesBoxesAndCapsulesAsRationalsDo) {
  std::mt19937_64 random = oracle::seeded(73);
  int decided = 0;
  int open = 0;
  const auto check = [&](const Sphere& ball, const auto& other, const char* name, int i) {
    const Decision quick = kernel::quickly_overlaps(ball, other);
    (quick == Decision::undecided ? open : decided) += 1;
    if (quick == Decision::undecided) return;
    EXPECT_EQ(quick, kernel::sets_meet<Dyadic>(ball, other)) << name << ' ' << i;
  };
  for (int i = 0; i < 20'000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(random() % 300) - 150);
    Box box{.center = any(random), .axes = turned(random), .half_m = any(random).cwiseAbs()};
    if (i % 7 == 0) box.axes.col(0) += 1e-3 * any(random);
    Vec3 side = any(random);
    for (double& x : side) x = random() % 2 == 0 ? std::copysign(1.0, x) : x;
    const Vec3 outward = side.unaryExpr([](double x) { return std::abs(x) == 1 ? x : 0.0; });
    if (outward.isZero()) continue;
    Sphere ball = ball_at(box.center + box.axes * box.half_m.cwiseProduct(side), box.axes * outward,
                          about_nothing(random), random);
    const Vec3 a = any(random);
    Capsule capsule{.a = a, .b = a + any(random), .radius_m = 0.5};
    Sphere other = ball_at(a + 0.5 * outward.normalized(), outward, about_nothing(random), random);
    for (double* length : {&ball.radius_m, &other.radius_m, &capsule.radius_m}) *length *= scale;
    for (Vec3* point : {&ball.center, &other.center, &capsule.a, &capsule.b, &box.center, &box.half_m}) *point *= scale;
    check(ball, box, "box", i);
    check(other, capsule, "capsule", i);
  }
  std::printf("near touching: %d decided, %d left open\n", decided, open);
  EXPECT_GT(decided, 10'000);
  EXPECT_GT(open, 1'000) << "the scenes must be worth testing";
}

// Centre on the way, grazing: the nearest point is inside the way.
TEST(BallFilter, SeesWhatPassesOnTheWay) {
  const Sphere other{.center = {0, 2, 0}, .radius_m = 1};
  EXPECT_FALSE(kernel::surely_apart({.start = {-9, 0, 0}, .end = {7, 0, 0}, .radius_m = 1}, other));
  EXPECT_TRUE(kernel::surely_apart({.start = {-9, 0, 0}, .end = {7, 0, 0}, .radius_m = 1 - 0x1p-20}, other));
  EXPECT_FALSE(kernel::surely_apart({.start = {-9, 4, 0}, .end = {7, 0, 0}, .radius_m = 1}, other));
}

TEST(BallFilter, SaysNothingOutOfRange) {
  const Sphere far{.center = {1e200, 0, 0}, .radius_m = 1};
  EXPECT_FALSE(kernel::surely_apart(resting({.center = Vec3::Zero(), .radius_m = 1}), far));
  const Sphere tiny{.center = {1e-170, 0, 0}, .radius_m = 0};
  EXPECT_FALSE(kernel::surely_apart(resting({.center = Vec3::Zero(), .radius_m = 0}), tiny));
}

// A metre along x: what lies on the line beyond either end is as far as from that end.
TEST(BallFilter, PartsWhatLiesOnTheLineBeyondEitherEndOfTheWay) {
  const MovingSphere mover{.start = {0, 0, 0}, .end = {1, 0, 0}, .radius_m = 0.25};
  for (const double x : {-10.0, -0.75, 1.75, 10.0})
    EXPECT_TRUE(kernel::surely_apart(mover, {.center = {x, 0, 0}, .radius_m = 0.25})) << x;
  for (const double x : {-0.25, 0.0, 0.5, 1.25})
    EXPECT_FALSE(kernel::surely_apart(mover, {.center = {x, 0, 0}, .radius_m = 0.25})) << x;
  EXPECT_TRUE(kernel::surely_apart(mover, {.center = {0.5, 0.75, 0}, .radius_m = 0.25}));
  for (const double x : {-10.0, -0.75, 1.75, 10.0}) {
    EXPECT_EQ(kernel::quickly_overlaps(Sphere{{x, 0, 0}, 0.25}, Capsule{{0, 0, 0}, {1, 0, 0}, 0.25}), Decision::no)
        << x;
  }
  EXPECT_EQ(kernel::quickly_overlaps(Sphere{{1.25, 0, 0}, 0.25}, Capsule{{0, 0, 0}, {1, 0, 0}, 0.25}), Decision::yes);
}

}  // namespace
}  // namespace collided::engine::ball_filter_test
