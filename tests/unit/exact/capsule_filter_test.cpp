#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/overlap/capsule_filter.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::capsule_filter_test {
namespace {

Vec3 any(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

Mat3 turned(std::mt19937_64& random) {
  const Vec3 axis = any(random);
  return Eigen::AngleAxisd(3 * axis.norm(), axis.normalized()).toRotationMatrix();
}

/// Nothing, or a part in 10^7 to 10^17 either way.
double about_nothing(std::mt19937_64& random) {
  const double size = std::pow(10.0, -7 - static_cast<double>(random() % 11));
  return random() % 4 == 0 ? 0 : random() % 2 == 0 ? size : -size;
}

struct Counts {
  int decided = 0;
  int open = 0;

  template <class A>
  void check(const A& a, const Capsule& b, const char* name, int i) {
    const Decision quick = kernel::quickly_overlaps(a, b);
    (quick == Decision::undecided ? open : decided) += 1;
    if (quick == Decision::undecided) return;
    EXPECT_EQ(quick, exactly::overlaps(a, b)) << name << " " << i;
  }
};

/// A capsule that touches, misses or cuts by about nothing what has a point there and lies behind the plane across
/// outward; some are crosswise, parallel or points.
Capsule at(const Vec3& point, const Vec3& outward, double reach_m, std::mt19937_64& random) {
  const Vec3 up = outward.normalized();
  Vec3 along = any(random);
  if (random() % 2 == 0) along -= along.dot(up) * up;
  if (random() % 9 == 0) along.setZero();
  const Vec3 nearest = point + (reach_m + about_nothing(random)) * up;
  const bool leans_away = along.dot(up) >= 0;
  const Vec3 start = leans_away && random() % 2 == 0 ? nearest : (nearest - (leans_away ? 0.3 : 1.0) * along).eval();
  return {.a = start, .b = start + along, .radius_m = 0};
}

TEST(CapsuleFilter, DecidesAsRationalsDoNearTouchingOnEveryScale) {
  std::mt19937_64 random = oracle::seeded(77);
  Counts capsules;
  Counts boxes;
  for (int i = 0; i < 20'000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(random() % 300) - 150);
    const Vec3 far = i % 5 == 0 ? 1e6 * any(random) : Vec3(Vec3::Zero());
    Capsule core{.a = any(random), .b = any(random), .radius_m = std::abs(any(random)[0])};
    if (i % 11 == 0) core.b = core.a;
    Vec3 across = any(random);
    across -= across.dot(core.b - core.a) / std::max((core.b - core.a).squaredNorm(), 1e-300) * (core.b - core.a);
    const double radius = std::abs(any(random)[1]);
    Capsule other = at(core.a + 0.4 * (core.b - core.a), across, core.radius_m + radius, random);
    other.radius_m = radius;
    if (i % 13 == 0) other.b = other.a + (core.b - core.a);
    Box box{.center = any(random), .axes = turned(random), .half_m = any(random).cwiseAbs()};
    if (i % 7 == 0) box.axes.col(0) += 1e-3 * any(random);
    Vec3 side = any(random);
    for (double& x : side) x = random() % 2 == 0 ? std::copysign(1.0, x) : x;
    const Vec3 outward = side.unaryExpr([](double x) { return std::abs(x) == 1 ? x : 0.0; });
    if (outward.isZero()) continue;
    Capsule summand = at(box.center + box.axes * box.half_m.cwiseProduct(side), box.axes * outward, radius, random);
    summand.radius_m = radius;
    for (Capsule* c : {&core, &other, &summand}) *c = {scale * (c->a + far), scale * (c->b + far), scale * c->radius_m};
    box.center = scale * (box.center + far);
    box.half_m *= scale;
    capsules.check(core, other, "capsules", i);
    boxes.check(box, summand, "box", i);
  }
  std::printf("capsules: %d decided, %d left open; boxes: %d and %d\n", capsules.decided, capsules.open, boxes.decided,
              boxes.open);
  EXPECT_GT(capsules.decided, 6'000);
  EXPECT_GT(boxes.decided, 5'000);
  EXPECT_GT(capsules.open, 1'000) << "the scenes must be worth testing";
  EXPECT_GT(boxes.open, 1'000) << "the scenes must be worth testing";
}

// What moves freely is rarely near touching: nearly all of it is decided here.
TEST(CapsuleFilter, DecidesNearlyAllOfWhatIsThrownTogether) {
  std::mt19937_64 random = oracle::seeded(79);
  Counts capsules;
  Counts boxes;
  for (int i = 0; i < 20'000; ++i) {
    const Capsule a{.a = any(random), .b = any(random), .radius_m = 0.2};
    const Capsule b{.a = any(random), .b = any(random), .radius_m = 0.1};
    capsules.check(a, b, "capsules", i);
    boxes.check(Box{.center = any(random), .axes = turned(random), .half_m = 0.5 * any(random).cwiseAbs()}, b, "box",
                i);
  }
  EXPECT_EQ(capsules.open, 0);
  std::printf("boxes: %d of 20000 left open\n", boxes.open);
  EXPECT_LT(boxes.open, 1'000);
}

TEST(CapsuleFilter, SaysNothingOutOfRange) {
  const Capsule unit{.a = Vec3::Zero(), .b = Vec3::UnitX(), .radius_m = 1};
  EXPECT_EQ(kernel::quickly_overlaps(unit, {.a = Vec3(1e200, 0, 0), .b = Vec3::Zero(), .radius_m = 1}),
            Decision::undecided);
  const Capsule tiny{.a = Vec3(1e-170, 0, 0), .b = Vec3::Zero(), .radius_m = 0};
  EXPECT_EQ(kernel::quickly_overlaps(tiny, tiny), Decision::undecided);
  EXPECT_EQ(kernel::quickly_overlaps(Box{.center = Vec3::Zero(), .axes = Mat3::Zero(), .half_m = Vec3::Ones()}, unit),
            Decision::undecided);
}

}  // namespace
}  // namespace collided::engine::capsule_filter_test
