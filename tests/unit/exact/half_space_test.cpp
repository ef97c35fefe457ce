#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/part.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/mesh.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

// Half-spaces against every kind, by rationals and 100 digits that share nothing with the product.  // A23 A25 A38
namespace collided::engine::half_space_test {
namespace {

using oracle::exact;
using oracle::Family;
using oracle::Point;
using oracle::RandomShapes;
using oracle::Rational;
using oracle::Wide;

Rational dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Wide wide(const Rational& x) { return Wide(numerator(x)) / Wide(denominator(x)); }

/// How far ahead of the plane a set's nearest point is, times |n|: a rational less a root.
struct Ahead {
  Rational least;
  Rational root2 = 0;  // >= 0
  bool touches() const { return least <= 0 || least * least <= root2; }
  Wide value() const { return wide(least) - sqrt(wide(root2)); }
};

class Oracle {
 public:
  explicit Oracle(const HalfSpace& h) : n_(exact(h.normal)), p_(exact(h.point)), nn_(dot(n_, n_)) {}

  Rational at(const Vec3& x) const { return dot(n_, minus(exact(x), p_)); }
  Wide length() const { return sqrt(wide(nn_)); }
  Rational along(const Vec3& v) const { return dot(n_, exact(v)); }

  Ahead of(const Sphere& s) const { return {at(s.center), Rational(s.radius_m) * Rational(s.radius_m) * nn_}; }
  Ahead of(const Capsule& c) const { return {std::min(at(c.a), at(c.b)), of(Sphere{c.a, c.radius_m}).root2}; }
  Ahead of(const Triangle& t) const { return {std::min({at(t.a), at(t.b), at(t.c)})}; }
  Ahead of(const Box& b) const {
    Rational least = at(b.center);
    for (int i = 0; i < 3; ++i) least -= abs(along(b.axes.col(i))) * Rational(b.half_m[i]);
    return {least};
  }
  Ahead of(const Ellipsoid& e) const {
    Rational root2 = 0;
    for (int i = 0; i < 3; ++i) {
      const Rational part = along(e.axes.col(i)) * Rational(e.half_m[i]);
      root2 += part * part;
    }
    return {at(e.center), root2};
  }
  Ahead of(const Cylinder& c) const { return {std::min(at(c.a), at(c.b)), disc2(c.a, c.b, c.radius_m)}; }
  Ahead of(const Cone& c) const {
    const Ahead base{at(c.base), disc2(c.apex, c.base, c.radius_m)};
    const Ahead apex{at(c.apex)};
    return base.value() < apex.value() ? base : apex;
  }
  Ahead of(const Hull& h) const {
    Rational least = at(vertex_of(h, 0));
    for (std::size_t i = 1; i < h.mesh->vertices.size(); ++i) least = std::min(least, at(vertex_of(h, i)));
    return {least};
  }

 private:
  /// r^2 |n x d|^2 / |d|^2, by Lagrange's identity.
  Rational disc2(const Vec3& a, const Vec3& b, double radius_m) const {
    const Point d = minus(exact(b), exact(a));
    const Rational along_d = dot(n_, d);
    return Rational(radius_m) * Rational(radius_m) * (nn_ - along_d * along_d / dot(d, d));
  }

  Point n_;
  Point p_;
  Rational nn_;
};

struct Tally {
  int yes = 0;
  int no = 0;
  int touching = 0;
};

template <class Shape>
void check(const HalfSpace& h, const Shape& shape, Tally& tally) {
  const Oracle oracle(h);
  const Ahead ahead = oracle.of(shape);
  const Decision expected = ahead.touches() ? Decision::yes : Decision::no;
  ASSERT_EQ(overlaps(h, shape).decision, expected) << typeid(Shape).name();
  ASSERT_EQ(overlaps(shape, h).decision, expected) << typeid(Shape).name();
  if constexpr (!std::is_same_v<Shape, Triangle>) {
    ASSERT_EQ(exactly::overlaps(Primitive(h), Primitive(shape)), expected) << typeid(Shape).name();
  }
  ++(ahead.touches() ? tally.yes : tally.no);
  if (ahead.least >= 0 && ahead.least * ahead.least == ahead.root2) ++tally.touching;
  if (!ahead.touches()) return;
  const Contact found = contact(h, shape);
  const Wide truth = -ahead.value() / oracle.length();
  ASSERT_LE(abs(Wide(found.depth_m) - truth), Wide(found.depth_error_m))
      << typeid(Shape).name() << " " << found.depth_m;
  ASSERT_NEAR(found.normal.norm(), 1, 1e-14);
  // The point lies in the middle of the overlap: half the depth behind the plane.
  const double scale = 1 + found.depth_m + h.point.cwiseAbs().maxCoeff() + found.point.cwiseAbs().maxCoeff();
  ASSERT_NEAR(found.normal.dot(found.point - h.point), -found.depth_m / 2, 1e-12 * scale) << typeid(Shape).name();
}

void check_ray(const HalfSpace& h, const Ray& ray) {
  const Oracle oracle(h);
  const Rational start = oracle.at(ray.origin);
  const Rational slope = oracle.along(ray.direction);
  const Point d = exact(ray.direction);
  const bool ahead_hit = start > 0 && slope < 0 &&
                         (std::isinf(ray.length_m) ||
                          start * start * dot(d, d) <= slope * slope * Rational(ray.length_m) * Rational(ray.length_m));
  RayHit hit;
  ASSERT_EQ(cast_ray(ray, h, hit).yes(), start <= 0 || ahead_hit);
  RayHit again;
  ASSERT_EQ(exactly::cast_ray(ray, Primitive(h), again) == Decision::yes, start <= 0 || ahead_hit);
  if (start > 0 && !ahead_hit) return;
  ASSERT_EQ(hit.inside, start <= 0);
  const Wide passing = slope == 0 ? Wide(0) : Wide(-wide(start) / wide(slope) * sqrt(wide(dot(d, d))));
  if (start > 0) {
    ASSERT_LE(abs(Wide(hit.distance_m) - passing), Wide(hit.distance_error_m));
    ASSERT_TRUE(std::isinf(hit.exit_m)) << "it never leaves";
  } else if (slope > 0) {
    ASSERT_LE(abs(Wide(hit.exit_m) - passing), Wide(hit.exit_error_m));
  } else {
    ASSERT_TRUE(std::isinf(hit.exit_m));
  }
}

void check_point(const HalfSpace& h, const Vec3& point) {
  const Oracle oracle(h);
  const Wide truth = std::max(Wide(wide(oracle.at(point)) / oracle.length()), Wide(0));
  const Closest found = closest(point, h);
  ASSERT_LE(abs(Wide(found.distance_m) - truth), Wide(found.distance_error_m));
  const Wide off = wide(oracle.at(found.point)) / oracle.length();
  if (found.distance_m > 0) { ASSERT_LE(abs(off), Wide(found.point_error_m)) << "on the plane"; }
}

/// What bounds_within keeps holds every corner of the box that is behind the plane.
void check_bounds(const HalfSpace& h, const Box& box) {
  const Aabb whole = bounds(box);
  const Aabb rest = bounds_within(h, whole);
  const Oracle oracle(h);
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = corner >> k & 1 ? whole.high[k] : whole.low[k];
    if (oracle.at(x) > 0) continue;
    ASSERT_TRUE((rest.low.array() <= x.array()).all() && (x.array() <= rest.high.array()).all());
  }
}

class HalfSpaces : public ::testing::TestWithParam<Family> {};

TEST_P(HalfSpaces, EveryKindIsDecidedAsByRationals) {
  std::mt19937_64 random = oracle::seeded(31);
  RandomShapes make(random, GetParam());
  const char* asked = std::getenv("COLLIDED_HALF_SPACES");
  const long count = asked != nullptr ? std::atol(asked) : 300;
  Tally tally;
  for (long i = 0; i < count; ++i) {
    HalfSpace h{make.point(), make.point() - make.point()};
    // Normals of tiny length are refused when they are loaded.
    while (!(h.normal.stableNorm() >= 1e-30)) {
      h.normal =
          GetParam() == Family::tiny ? Vec3::Unit(static_cast<int>(random() % 3)) : Vec3(make.point() - make.point());
    }
    check(h, make.sphere(), tally);
    check(h, make.box(), tally);
    check(h, make.capsule(), tally);
    check(h, make.triangle(), tally);
    check(h, make.cylinder(), tally);
    check(h, make.cone(), tally);
    check(h, make.ellipsoid(), tally);
    if (GetParam() != Family::tiny) check(h, make.hull(), tally);
    check_ray(h, make.ray(i % 2 == 0));
    check_point(h, make.point());
    check_bounds(h, make.box());
    if (HasFatalFailure()) FAIL() << "case " << i;
  }
  EXPECT_GT(tally.yes, 0);
  EXPECT_GT(tally.no, 0);
  if (GetParam() == Family::lattice) { EXPECT_GT(tally.touching, 0); }
}

INSTANTIATE_TEST_SUITE_P(Families, HalfSpaces, ::testing::ValuesIn(oracle::kFamilies),
                         [](const auto& family) { return std::string(oracle::name(family.param)); });

TEST(HalfSpace, OppositeOnesWithAGapAreApart) {
  const HalfSpace below{{0, 0, 0}, {0, 0, 2}};
  EXPECT_FALSE(overlaps(below, HalfSpace{{5, 5, 0x1p-60}, {0, 0, -3}}).yes());
  EXPECT_TRUE(overlaps(below, HalfSpace{{5, 5, 0}, {0, 0, -3}}).yes()) << "touching";
  EXPECT_TRUE(overlaps(below, HalfSpace{{5, 5, 1}, {0, 0x1p-300, -3}}).yes()) << "they meet far out";
  EXPECT_EQ(exactly::overlaps(Primitive(below), Primitive(HalfSpace{{5, 5, 1}, {0, 0, -3}})), Decision::no);
}

TEST(HalfSpace, AFallingBallMeetsItInTime) {
  const HalfSpace floor{{0, 0, 0}, {0, 0, 1}};
  TimeBracket bracket;
  ASSERT_TRUE(first_contact(MovingSphere{{0, 0, 3}, {7, 0, -1}, 1}, floor, 1e-9, bracket).yes());
  EXPECT_LE(bracket.low, 0.5);
  EXPECT_GE(bracket.high, 0.5);
  EXPECT_LE(bracket.high - bracket.low, 1e-9);
  EXPECT_FALSE(first_contact(MovingSphere{{0, 0, 3}, {7, 0, 1 + 0x1p-50}, 1}, floor, 1e-9, bracket).yes());
}

TEST(HalfSpace, AnAlignedOneEndsAtItsPlane) {
  const Aabb box = bounds(HalfSpace{{1, 2, 3}, {0, 0, 4}});
  EXPECT_EQ(box.high.z(), 3);
  EXPECT_TRUE(std::isinf(box.low.z()) && std::isinf(box.high.x()));
  EXPECT_TRUE(std::isinf(bounds(HalfSpace{{1, 2, 3}, {0, 1e-9, 4}}).high.z()));
}

// Ground tilted by 3 4 5, and what stands 2 m above it: every field, and the same the other way round.
TEST(HalfSpace, TellsHowFarAboveItEachKindIs) {
  const Vec3 up(0, 0.6, 0.8);
  const Vec3 foot(1, 0, 0);
  const HalfSpace ground{.point = foot + 7 * up.cross(Vec3::UnitX()), .normal = 5 * up};
  const Vec3 along = up.cross(Vec3::UnitX());
  Mat3 axes;
  axes << Vec3::UnitX(), up, Vec3::UnitX().cross(up);
  for (const Primitive& primitive :
       {Primitive(Sphere{foot + 2.5 * up, 0.5}),
        Primitive(Box{.center = foot + 3 * up, .axes = axes, .half_m = {1, 1, 1}}),
        Primitive(Capsule{foot + 2.5 * up, foot + 9 * up, 0.5}), Primitive(Cone{foot + 2 * up, foot + 4 * up, 1}),
        Primitive(Ellipsoid{.center = foot + 5 * up, .axes = axes, .half_m = {1, 3, 2}}),
        Primitive(Cylinder{foot + 2 * up, foot + 5 * up, 0.5})}) {
    const Separation apart = separation(ConvexPart(Primitive(ground)), ConvexPart(primitive));
    EXPECT_NEAR(apart.distance_m, 2, 1e-12) << primitive.index();
    EXPECT_LE(std::abs(apart.distance_m - 2), apart.error_m + 1e-15);
    EXPECT_LT(apart.error_m, 1e-12);
    EXPECT_NEAR((apart.normal - up).norm(), 0, 1e-15) << primitive.index();
    EXPECT_NEAR(up.dot(apart.on_a - foot), 0, 1e-12) << "on the plane";
    EXPECT_NEAR(up.dot(apart.on_b - foot), 2, 1e-12) << "its lowest point";
    EXPECT_NEAR((apart.on_b - apart.on_a - 2 * up).norm(), 0, 1e-12);
    EXPECT_GT(apart.point_error_m, apart.error_m);
    EXPECT_LT(apart.point_error_m, 1e-9);
    const Separation turned = separation(ConvexPart(primitive), ConvexPart(Primitive(ground)));
    EXPECT_EQ(turned.distance_m, apart.distance_m);
    EXPECT_EQ(turned.error_m, apart.error_m);
    EXPECT_EQ(turned.normal, -apart.normal);
    EXPECT_EQ(turned.on_a, apart.on_b);
    EXPECT_EQ(turned.on_b, apart.on_a);
    EXPECT_EQ(turned.point_error_m, apart.point_error_m);
  }
  const Separation of_triangle = separation(
      ConvexPart(Primitive(ground)), ConvexPart(Triangle{foot + 2 * up, foot + 3 * up + along, foot + 3 * up - along}));
  EXPECT_NEAR(of_triangle.distance_m, 2, 1e-12);
  EXPECT_NEAR((of_triangle.normal - up).norm(), 0, 1e-15);
  EXPECT_NEAR((of_triangle.on_b - foot - 2 * up).norm(), 0, 1e-12);
}

// From -10 to 10 along x: a metre of radius meets the long axis' end, 2 m from the middle, at -3.
TEST(GeneralFirstContact, ABallMeetsRoundThingsWhereItsWaySays) {
  const MovingSphere mover{.start = {-10, 0, 0}, .end = {10, 0, 0}, .radius_m = 1};
  for (const Primitive& other :
       {Primitive(Ellipsoid{.center = Vec3::Zero(), .half_m = {2, 1, 0.5}}),
        Primitive(Cylinder{{-2, 0, 0}, {2, 0, 0}, 0.5}), Primitive(Cone{{-2, 0, 0}, {2, 0, 0}, 0.5}),
        Primitive(Cone{{2, 0, 0}, {-2, 0, 0}, 0.5})}) {
    TimeBracket bracket;
    const ExactResult verdict = first_contact(mover, other, 1e-9, bracket);
    EXPECT_TRUE(verdict.yes()) << other.index();
    EXPECT_LE(bracket.low, 0.35) << other.index();
    EXPECT_GE(bracket.high, 0.35) << other.index();
    EXPECT_LE(bracket.high - bracket.low, 1e-9) << other.index();
  }
}

// A convex set's nearest point is known as well as the distance is: within the root of the difference of the squares of
// both ends of its interval.
TEST(GeneralClosest, ThePointIsNoBetterKnownThanTheDistanceAllows) {
  for (const Primitive& shape :
       {Primitive(Ellipsoid{.center = Vec3::Zero(), .half_m = {1, 2, 3}}),
        Primitive(Cylinder{{0, 0, -3}, {0, 0, 3}, 1}), Primitive(Cone{{0, 0, 3}, {0, 0, -3}, 1})}) {
    for (const Vec3& point : {Vec3(0, 0, 7), Vec3(0.3, 0.2, 7), Vec3(5, 0.1, 1), Vec3(-40, 30, -20)}) {
      const Closest nearest = closest(point, shape);
      const Rational error(nearest.distance_error_m);
      const Rational distance(nearest.distance_m);
      const Rational low = error < distance ? Rational(distance - error) : Rational(0);
      const Rational least = (distance + error) * (distance + error) - low * low;
      EXPECT_GE(Rational(nearest.point_error_m) * Rational(nearest.point_error_m), least)
          << shape.index() << " from " << point.transpose();
      EXPECT_LT(nearest.point_error_m, 1e-3) << shape.index();
    }
    const Closest above = closest(Vec3(0, 0, 7), shape);
    EXPECT_LE(std::abs(above.distance_m - 4), above.distance_error_m + 1e-15) << shape.index();
    EXPECT_NEAR((above.normal - Vec3(0, 0, 1)).norm(), 0, 1e-5) << shape.index();
  }
}

}  // namespace
}  // namespace collided::engine::half_space_test
