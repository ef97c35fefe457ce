#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "server/exact_phase/distance/convex_pair.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/kernels/membership_kernel.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::convex_test {
namespace {

using oracle::Family;
using oracle::RandomShapes;

Hull hull_of(const std::vector<Vec3>& points) {
  TriangleMesh mesh;
  mesh.vertices = points;
  return {std::make_shared<const TriangleMesh>(std::move(mesh))};
}

constexpr int kAround = 24;

/// Corners of a regular polygon about the axis from a to b, at the distance from it.
void add_ring(std::vector<Vec3>& points, const Vec3& center, const Vec3& axis, double radius_m) {
  const Vec3 d = axis.normalized();
  int least = 0;
  d.cwiseAbs().minCoeff(&least);
  const Vec3 u = d.cross(Vec3::Unit(least)).normalized();
  const Vec3 v = d.cross(u);
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAround;
    points.push_back(center + radius_m * (std::cos(angle) * u + std::sin(angle) * v));
  }
}

/// A polytope that the shape holds (grow 0) or that holds it (grow 1), both by more than rounding.
Hull polytope(const Cylinder& c, bool outer) {
  const double radius_m =
      outer ? c.radius_m / std::cos(std::numbers::pi / kAround) + 1e-9 * (c.radius_m + (c.b - c.a).norm())
            : c.radius_m * (1 - 1e-9);
  const Vec3 shift = (outer ? 1e-9 : -1e-9) * (c.b - c.a);
  std::vector<Vec3> points;
  add_ring(points, c.a - shift, c.b - c.a, radius_m);
  add_ring(points, c.b + shift, c.b - c.a, radius_m);
  return hull_of(points);
}

Hull polytope(const Cone& c, bool outer) {
  const double radius_m =
      outer ? c.radius_m / std::cos(std::numbers::pi / kAround) + 1e-8 * (c.radius_m + (c.base - c.apex).norm())
            : c.radius_m * (1 - 1e-8);
  const Vec3 shift = (outer ? 1e-9 : -1e-9) * (c.base - c.apex);
  std::vector<Vec3> points{c.apex - shift};
  add_ring(points, c.base + shift, c.base - c.apex, radius_m);
  return hull_of(points);
}

Hull polytope(const Ellipsoid& e, bool outer) {
  // The corners of two thin-latitude spheres' polyhedron; its inradius is about cos^2 of half a step.
  const double inner = std::pow(std::cos(std::numbers::pi / kAround), 2);
  const double grow = outer ? (1 + 1e-9) / inner : 1 - 1e-9;
  std::vector<Vec3> points;
  for (int row = 0; row <= kAround / 2; ++row) {
    const double polar = std::numbers::pi * row / (kAround / 2);
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * std::numbers::pi * i / kAround;
      const Vec3 u(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar));
      points.push_back(e.center + e.axes * e.half_m.cwiseProduct(grow * u));
    }
  }
  return hull_of(points);
}

template <class Shape>
const Shape& polytope(const Shape& shape, bool) {
  return shape;
}

struct Tally {
  int yes = 0;
  int no = 0;
  int undecided = 0;
  double widest = 0;  // relative to the sizes
};

template <class Shape>
Shape moved(Shape shape, const Vec3& by) {
  return place(Frame{Mat3::Identity(), by}, shape);
}

/// Against polytopes inside and outside of the round ones, by rationals; and depths by carrying them out.
template <class A, class B>
void check_pair(const A& a, const B& b, double size_m, Tally& tally) {
  const ExactResult verdict = overlaps(a, b);
  ASSERT_EQ(verdict.decision, overlaps(b, a).decision);
  const auto by_rationals = [&](bool outer) {
    return kernel::polytopes_meet(kernel::Convex(polytope(a, outer)), kernel::Convex(polytope(b, outer)));
  };
  const char* names = typeid(std::pair<A, B>).name();
  if (by_rationals(false) == Decision::yes) { ASSERT_EQ(verdict.decision, Decision::yes) << names; }
  if (by_rationals(true) == Decision::no) { ASSERT_EQ(verdict.decision, Decision::no) << names; }
  if (verdict.decision != Decision::yes) {
    ++(verdict.decision == Decision::no ? tally.no : tally.undecided);
    return;
  }
  ++tally.yes;
  const Contact found = contact(a, b);
  ASSERT_NEAR(found.normal.norm(), 1, 1e-12);
  tally.widest = std::max(tally.widest, found.depth_error_m / size_m);
  const double slack_m = 1e-12 * size_m;
  const Vec3 out = (found.depth_m + found.depth_error_m + slack_m) * found.normal;
  ASSERT_NE(overlaps(a, moved(b, out)).decision, Decision::yes)
      << names << " depth " << found.depth_m << " +- " << found.depth_error_m;
  const Vec3 almost = (found.depth_m - found.depth_error_m - slack_m) * found.normal;
  if (found.depth_m - found.depth_error_m > 2 * slack_m) {
    ASSERT_NE(overlaps(a, moved(b, almost)).decision, Decision::no)
        << names << " depth " << found.depth_m << " +- " << found.depth_error_m << " normal "
        << found.normal.transpose();
  }
}

template <class General, class Make>
void check_against_all(Make&& make_one, RandomShapes& make, double size_m, Tally& tally) {
  const General one = make_one();
  check_pair(one, make.sphere(), size_m, tally);
  check_pair(one, make.box(), size_m, tally);
  check_pair(one, make.capsule(), size_m, tally);
  check_pair(one, make.triangle(), size_m, tally);
  check_pair(one, make.cylinder(), size_m, tally);
  check_pair(one, make.cone(), size_m, tally);
  check_pair(one, make.ellipsoid(), size_m, tally);
}

/// The search with certificates on kinds that have a closed form: the decision must be the same, and the depths' brackets
/// must overlap.
template <class A, class B>
void check_known(const A& a, const B& b, bool depths) {
  const ExactResult known = overlaps(a, b);
  ASSERT_EQ(overlaps_in_general(&a, &b).decision, known.decision) << typeid(std::pair<A, B>).name();
  if (!known.yes() || !depths) return;
  const Contact expected = contact(a, b);
  const Contact found = contact_in_general(&a, &b);
  ASSERT_LE(std::abs(found.depth_m - expected.depth_m), found.depth_error_m + expected.depth_error_m)
      << typeid(std::pair<A, B>).name() << " " << found.depth_m << " " << expected.depth_m;
}

void check_all_known(Family family, int rounds, bool depths) {
  std::mt19937_64 random = oracle::seeded(20261125);
  RandomShapes make(random, family);
  for (int i = 0; i < rounds && !testing::Test::HasFatalFailure(); ++i) {
    check_known(make.sphere(), make.sphere(), depths);
    check_known(make.sphere(), make.box(), depths);
    check_known(make.sphere(), make.capsule(), depths);
    check_known(make.sphere(), make.triangle(), depths);
    check_known(make.box(), make.box(), depths);
    check_known(make.box(), make.capsule(), depths);
    check_known(make.box(), make.triangle(), depths);
    check_known(make.capsule(), make.capsule(), depths);
    check_known(make.capsule(), make.triangle(), depths);
    check_known(make.triangle(), make.triangle(), depths);
  }
}

TEST(ExactConvex, AgreesWithClosedForms) {
  for (const Family family : oracle::kFamilies) {
    SCOPED_TRACE(oracle::name(family));
    check_all_known(family, 400, false);
  }
}

TEST(ExactConvex, BracketsHoldTheTruth) {
  for (const Family family : oracle::kFamilies) {
    SCOPED_TRACE(oracle::name(family));
    check_all_known(family, 400, true);
  }
}

class ExactGeneral : public ::testing::TestWithParam<Family> {};

double size_of(Family family) {
  return family == Family::tenths ? 0.5 : family == Family::tiny ? 0x1p-556 : family == Family::lattice ? 6 : 2;
}

TEST_P(ExactGeneral, PairsAgreeWithPolytopesAndDepthsPartThem) {
  std::mt19937_64 random = oracle::seeded(20261121);
  RandomShapes make(random, GetParam());
  Tally tally;
  for (int i = 0; i < 25 && !HasFatalFailure(); ++i) {
    check_against_all<Cylinder>([&] { return make.cylinder(); }, make, size_of(GetParam()), tally);
    check_against_all<Cone>([&] { return make.cone(); }, make, size_of(GetParam()), tally);
    check_against_all<Ellipsoid>([&] { return make.ellipsoid(); }, make, size_of(GetParam()), tally);
  }
  std::printf("%s: %d yes, %d no, %d undecided, widest bound %.3g of the size\n", oracle::name(GetParam()), tally.yes,
              tally.no, tally.undecided, tally.widest);
  EXPECT_GT(tally.yes, 20);
  EXPECT_GT(tally.no, 20);
  if (GetParam() == Family::random) {
    EXPECT_EQ(tally.undecided, 0);
    EXPECT_LT(tally.widest, 1e-7);
  }
}

template <class Shape>
void check_ray(const Ray& ray, const Shape& shape, Tally& tally) {
  RayHit hit;
  const ExactResult verdict = cast_ray(ray, shape, hit);
  const Vec3 d = ray.direction.normalized();
  const auto held = [&](double t) {
    return kernel::holds_point<Dyadic>(shape, Vec3(ray.origin + t * d)) == Decision::yes;
  };
  const double far = std::min(ray.length_m, 40.0);
  const char* name = typeid(Shape).name();
  if (!verdict.yes()) {
    ASSERT_EQ(verdict.decision, Decision::no) << name;
    ++tally.no;
    for (int i = 0; i < 200; ++i) ASSERT_FALSE(held(far * i / 200.0 * 0.9999999)) << name << " at " << i;
    return;
  }
  ++tally.yes;
  ASSERT_LE(hit.distance_m - hit.distance_error_m, ray.length_m);
  ASSERT_GE(hit.exit_m, hit.distance_m);
  const double apart = 1e-7 + hit.distance_error_m;
  if (hit.inside) {
    ASSERT_TRUE(held(0)) << name;
  } else if (hit.distance_m > apart) {
    ASSERT_FALSE(held(hit.distance_m - apart)) << name << " " << hit.distance_m;
  }
  const double middle = (hit.distance_m + hit.exit_m) / 2;
  if (hit.exit_m - hit.distance_m > 1e-6) {
    ASSERT_TRUE(held(middle)) << name << " " << hit.distance_m << " to " << hit.exit_m;
  }
  ASSERT_FALSE(held(hit.exit_m + 1e-6 + hit.exit_error_m)) << name;
}

TEST(ExactGeneralRay, EntriesAndExitsAreWhereMembershipChanges) {
  std::mt19937_64 random = oracle::seeded(20261123);
  for (const Family family : {Family::random, Family::lattice, Family::tenths}) {
    RandomShapes make(random, family);
    Tally tally;
    for (int i = 0; i < 400 && !HasFatalFailure(); ++i) {
      const Ray ray = make.ray(i % 2 == 0);
      check_ray(ray, make.cylinder(), tally);
      check_ray(ray, make.cone(), tally);
      check_ray(ray, make.ellipsoid(), tally);
    }
    std::printf("%s: %d hits, %d misses\n", oracle::name(family), tally.yes, tally.no);
    EXPECT_GT(tally.yes, 50);
    EXPECT_GT(tally.no, 200);
  }
}

template <class Shape>
void check_nearest(const Vec3& point, const Shape& shape) {
  const Closest nearest = closest(point, shape);
  const char* name = typeid(Shape).name();
  const double low = nearest.distance_m - nearest.distance_error_m;
  const double high = nearest.distance_m + nearest.distance_error_m;
  if (low > 0) { ASSERT_NE(overlaps(Sphere{point, low * (1 - 1e-15)}, shape).decision, Decision::yes) << name; }
  ASSERT_NE(overlaps(Sphere{point, high * (1 + 1e-15)}, shape).decision, Decision::no) << name;
  if (high > 0) {
    ASSERT_NEAR((point - nearest.point).norm(), nearest.distance_m, 1e-9 + nearest.distance_error_m) << name;
  }
  ASSERT_LE(nearest.distance_error_m, 1e-9) << name;
}

TEST(ExactGeneralNearest, BallsOfTheTwoBoundsMissAndMeet) {
  std::mt19937_64 random = oracle::seeded(20261124);
  for (const Family family : {Family::random, Family::lattice, Family::tenths}) {
    RandomShapes make(random, family);
    for (int i = 0; i < 500 && !HasFatalFailure(); ++i) {
      const Vec3 point = make.point() * 2;
      check_nearest(point, make.cylinder());
      check_nearest(point, make.cone());
      check_nearest(point, make.ellipsoid());
      check_nearest(point, make.hull());
    }
  }
}

/// Moves b out of a along the contact's normal to about where they part, then a millionth of a unit to either side.
template <class A, class B>
void check_near_touching(const A& a, const B& b, int& checked) {
  if (!overlaps(a, b).yes()) return;
  const Contact found = contact(a, b);
  const auto at = [&](double motion) { return overlaps(a, moved(b, Vec3(motion * found.normal))).decision; };
  double in = 0;
  double out = 2 * found.depth_m + 1;
  ASSERT_EQ(at(out), Decision::no);
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = (in + out) / 2;
    (at(middle) == Decision::no ? out : in) = middle;
  }
  ASSERT_EQ(at(out + 1e-6), Decision::no) << typeid(std::pair<A, B>).name();
  if (out > 2e-6) { ASSERT_EQ(at(out - 1e-6), Decision::yes) << typeid(std::pair<A, B>).name(); }
  ++checked;
}

TEST(ExactGeneralNearTouching, AMillionthFromTouchingIsDecided) {
  std::mt19937_64 random = oracle::seeded(20261126);
  RandomShapes make(random, Family::random);
  int checked = 0;
  for (int i = 0; i < 100 && !HasFatalFailure(); ++i) {
    check_near_touching(make.cylinder(), make.box(), checked);
    check_near_touching(make.cone(), make.sphere(), checked);
    check_near_touching(make.ellipsoid(), make.cylinder(), checked);
    check_near_touching(make.cone(), make.triangle(), checked);
    check_near_touching(make.cylinder(), make.capsule(), checked);
  }
  EXPECT_GT(checked, 100);
}

INSTANTIATE_TEST_SUITE_P(Families, ExactGeneral,
                         ::testing::Values(Family::random, Family::lattice, Family::tenths, Family::needles),
                         [](const auto& test) { return std::string(oracle::name(test.param)); });

}  // namespace
}  // namespace collided::engine::convex_test
