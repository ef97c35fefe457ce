#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/aabb.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/plane_reach.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

// Round solids that touch, or are one rounding short of it or past it, against a truth in rationals that shares no formula
// with the product: a solid against a plane by how far it reaches, against a segment by the highest value of a parabola.

namespace collided::engine::round_tangents_test {
namespace {

using namespace oracle;

/// So many times as many tangents as usual.
int times_asked() {
  const char* asked = std::getenv("COLLIDED_TANGENTS");
  return asked != nullptr ? std::atoi(asked) : 1;
}

/// f0 + f1 t + f2 t^2 >= 0 somewhere on [low, high].
bool is_somewhere_up(const Rational& f0, const Rational& f1, const Rational& f2, const Rational& low,
                     const Rational& high) {
  if (low > high) return false;
  const auto at = [&](const Rational& t) -> Rational { return f0 + t * (f1 + t * f2); };
  if (at(low) >= 0 || at(high) >= 0) return true;
  if (f2 >= 0) return false;
  const Rational top = -f1 / (2 * f2);
  return top > low && top < high && at(top) >= 0;
}

/// Whether the solid and the segment share a point, on the segment's own parameter.
bool meets_segment(const Primitive& solid, const Vec3& from, const Vec3& to) {
  const Point p = exact(from);
  const Point d = minus(exact(to), p);
  Rational low = 0;
  Rational high = 1;
  if (const auto* e = std::get_if<Ellipsoid>(&solid)) {
    Point axis[3];
    for (int i = 0; i < 3; ++i) axis[i] = times(Rational(e->half_m[i]), exact(e->axes.col(i)));
    const Rational volume = dot(axis[0], cross(axis[1], axis[2]));
    const Point w = minus(p, exact(e->center));
    Rational f0 = 1, f1 = 0, f2 = 0;
    for (int i = 0; i < 3; ++i) {
      const Point row = times(1 / volume, cross(axis[(i + 1) % 3], axis[(i + 2) % 3]));
      const Rational u = dot(row, w);
      const Rational v = dot(row, d);
      f0 -= u * u;
      f1 -= 2 * u * v;
      f2 -= v * v;
    }
    return is_somewhere_up(f0, f1, f2, low, high);
  }
  const auto* cylinder = std::get_if<Cylinder>(&solid);
  const auto* cone = std::get_if<Cone>(&solid);
  const Point begin = exact(cylinder != nullptr ? cylinder->a : cone->apex);
  const Point axis = minus(exact(cylinder != nullptr ? cylinder->b : cone->base), begin);
  const Rational length2 = dot(axis, axis);
  const Point w = minus(p, begin);
  // Share of the axis at t: s0 + s1 t in [0, 1].
  const Rational s0 = dot(w, axis) / length2;
  const Rational s1 = dot(d, axis) / length2;
  if (s1 == 0 && (s0 < 0 || s0 > 1)) return false;
  if (s1 != 0) {
    const Rational zero = -s0 / s1;
    const Rational one = (1 - s0) / s1;
    low = std::max(low, std::min(zero, one));
    high = std::min(high, std::max(zero, one));
  }
  const Point u = minus(w, times(s0, axis));
  const Point v = minus(d, times(s1, axis));
  const Rational r = cylinder != nullptr ? cylinder->radius_m : cone->radius_m;
  const bool tapers = cone != nullptr;
  const Rational r0 = tapers ? Rational(s0 * s0) : Rational(1);
  const Rational r1 = tapers ? Rational(2 * s0 * s1) : Rational(0);
  const Rational r2 = tapers ? Rational(s1 * s1) : Rational(0);
  return is_somewhere_up(r * r * r0 - dot(u, u), r * r * r1 - 2 * dot(u, v), r * r * r2 - dot(v, v), low, high);
}

/// Of decisions, all of them those of the truth.
struct Tally {
  int yes = 0;
  int no = 0;
  int exact = 0;

  void print() const {
    std::printf("%d tangents: %d touching, %d apart, %d by rationals; 0 wrong, 0 undecided\n", yes + no, yes, no,
                exact);
  }
};

template <class Other>
void expect(const Primitive& solid, const Other& other, bool truth, const char* what, Tally& tally) {
  const Decision wanted = truth ? Decision::yes : Decision::no;
  const ExactResult verdict = overlaps(solid, other);
  ++(truth ? tally.yes : tally.no);
  tally.exact += verdict.level == Level::rational;
  ASSERT_EQ(verdict.decision, wanted) << what << ", solid " << solid.index();
  ASSERT_EQ(exactly::overlaps(solid, other), wanted) << what << " by rationals, solid " << solid.index();
  if constexpr (std::is_same_v<Other, Primitive>) {
    ASSERT_EQ(overlaps(other, solid).decision, wanted) << what << " turned round, solid " << solid.index();
  }
}

/// Every kind with a round side, of the family's numbers and never without extent.
Primitive round_solid(RandomShapes& shapes, int kind) {
  const auto positive = [&] {
    double size = 0;
    while (size == 0) size = shapes.size();
    return size;
  };
  Cylinder like = shapes.cylinder();
  like.radius_m = positive();
  switch (kind) {
    case 0: return Sphere{like.a, like.radius_m};
    case 1: return Capsule{like.a, like.b, like.radius_m};
    case 2: return like;
    case 3: return Cone{like.a, like.b, like.radius_m};
    default: return shapes.ellipsoid();
  }
}

/// The n to touch along: any, an axis of the world, along the solid's axis or across it.
Vec3 direction_for(const Primitive& solid, std::mt19937_64& generator) {
  std::normal_distribution<double> any;
  const Vec3 random = Vec3(any(generator), any(generator), any(generator)).normalized();
  const kernel::Convex set = convex_of(solid);
  const Vec3 axis = set.count() == 2 ? Vec3(set.carrier[1] - set.carrier[0]) : Vec3(set.axes.col(0));
  switch (std::uniform_int_distribution<int>(0, 4)(generator)) {
    case 0: return Vec3::Unit(std::uniform_int_distribution<int>(0, 2)(generator));
    case 1: return axis.isZero(0) ? random : Vec3(axis.normalized());
    case 2: return axis.cross(random).isZero(0) ? random : Vec3(axis.cross(random).normalized());
    default: return random;
  }
}

/// The solid on a triangle, a hull's face, a half-space and a box's face, all wide of where they touch.
void check_on_faces(const Primitive& solid, const Vec3& n, int ulps, Tally& tally) {
  const Vec3 foot = lowest(solid, n);
  const auto [u, v] = across(n);
  // What lies along the face may have its lowest point anywhere over it.
  const double wide_m = 40;
  const Triangle face{stepped(foot + wide_m * u, n, ulps), stepped(foot - wide_m * u + wide_m * v, n, ulps),
                      stepped(foot - wide_m * u - wide_m * v, n, ulps)};
  const Point corner = exact(face.a);
  Point normal = cross(minus(exact(face.b), corner), minus(exact(face.c), corner));
  if (dot(normal, exact(n)) < 0) normal = times(-1, normal);
  const Point down = times(-1, normal);
  const bool on_face = reaches_past(solid, down, dot(down, corner)) >= 0;
  expect(solid, face, on_face, "triangle", tally);
  expect(solid, tetrahedron(face, n, foot - 5 * n), on_face, "hull", tally);
  const HalfSpace ground{stepped(foot, n, ulps), n};
  const Point against = times(-1, exact(n));
  expect(solid, Primitive(ground), reaches_past(solid, against, dot(against, exact(ground.point))) >= 0, "half-space",
         tally);
  Mat3 axes;
  axes << u, v, n;
  const Box box{stepped(foot - n, n, ulps), axes, {wide_m, wide_m, 1}};
  const Point top = plus(exact(box.center), exact(box.axes.col(2)));
  Point up = cross(exact(box.axes.col(0)), exact(box.axes.col(1)));
  if (dot(up, exact(n)) < 0) up = times(-1, up);
  const Point below = times(-1, up);
  expect(solid, Primitive(box), reaches_past(solid, below, dot(below, top)) >= 0, "box", tally);
}

/// On the flat end of a cylinder as wide: its plane is across the axis, which no double normal has to the last digit.
void check_on_end(const Primitive& solid, const Vec3& n, int ulps, Tally& tally) {
  const Vec3 foot = stepped(lowest(solid, n), n, ulps);
  const Cylinder drum{foot - 3 * n, foot, 40};
  const Point down = minus(exact(drum.a), exact(drum.b));
  expect(solid, Primitive(drum), reaches_past(solid, down, dot(down, exact(drum.b))) >= 0, "end of a drum", tally);
}

TEST(ExactRoundTangents, OnAWideDrumEveryRoundSolidIsDecidedToTheLastDigit) {
  std::mt19937_64 generator = seeded(26);
  Tally tally;
  for (const Family family : {Family::random, Family::lattice, Family::tenths, Family::far_lattice}) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 400 * times_asked(); ++i) {
      const Primitive solid = round_solid(shapes, i % 5);
      const Vec3 n = direction_for(solid, generator);
      for (const int ulps : {-1, 0, 1}) check_on_end(solid, n, ulps, tally);
      if (HasFatalFailure()) return;
    }
  }
  tally.print();
  EXPECT_GT(tally.yes, 1500);
  EXPECT_GT(tally.no, 1000);
  EXPECT_GT(tally.exact, 1500);
}

/// An ellipsoid of three equal halves is a ball, but goes the ellipsoids' way.
TEST(ExactRoundTangents, ABallShapedEllipsoidIsDecidedAsTheBall) {
  std::mt19937_64 generator = seeded(27);
  int exactly_decided = 0;
  for (const Family family : {Family::random, Family::lattice, Family::tenths}) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 400 * times_asked(); ++i) {
      const Primitive solid = round_solid(shapes, 1 + i % 2);
      const Vec3 n = direction_for(solid, generator);
      const double radius_m = 0.25 * (1 + i % 7);
      for (const int ulps : {-1, 0, 1}) {
        const Vec3 middle = stepped(lowest(solid, n) - radius_m * n, n, ulps);
        const Decision ball = overlaps(solid, Primitive(Sphere{middle, radius_m})).decision;
        const Ellipsoid like{.center = middle, .half_m = Vec3::Constant(radius_m)};
        const ExactResult verdict = overlaps(solid, Primitive(like));
        // Where the side ends double does not tell on which side of the end the touch is.
        if (verdict.decision == Decision::undecided) continue;
        ASSERT_EQ(verdict.decision, ball) << solid.index();
        exactly_decided += verdict.level == Level::rational;
      }
    }
  }
  EXPECT_GT(exactly_decided, 1000);
}

TEST(ExactRoundTangents, OnAFaceEveryRoundSolidIsDecidedToTheLastDigit) {
  std::mt19937_64 generator = seeded(20);
  Tally tally;
  for (const Family family : {Family::random, Family::lattice, Family::tenths, Family::far_lattice}) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 250 * times_asked(); ++i) {
      const Primitive solid = round_solid(shapes, i % 5);
      const Vec3 n = direction_for(solid, generator);
      for (const int ulps : {-1, 0, 1}) {
        check_on_faces(solid, n, ulps, tally);
        if (HasFatalFailure()) return;
      }
    }
  }
  tally.print();
  EXPECT_GT(tally.yes, 3000);
  EXPECT_GT(tally.no, 2500);
  EXPECT_GT(tally.exact, 2000);
}

/// A line of no thickness along the solid's side, the edge of a triangle there, and a point of it.
TEST(ExactRoundTangents, AlongAnEdgeAndInAPointEverySolidIsDecidedToTheLastDigit) {
  std::mt19937_64 generator = seeded(21);
  Tally tally;
  for (const Family family : {Family::random, Family::lattice, Family::tenths, Family::far_lattice}) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 300 * times_asked(); ++i) {
      const Primitive solid = round_solid(shapes, 2 + i % 3);
      const Vec3 n = direction_for(solid, generator);
      const Vec3 foot = lowest(solid, n);
      const auto [u, v] = across(n);
      const Vec3 displacement = i % 2 == 0 ? u : Vec3((0.6 * u + 0.8 * v).normalized());
      for (const int ulps : {-1, 0, 1}) {
        const Vec3 from = stepped(foot - 3 * displacement, n, ulps);
        const Vec3 to = stepped(foot + 2 * displacement, n, ulps);
        const bool truth = meets_segment(solid, from, to);
        expect(solid, Primitive(Capsule{from, to, 0}), truth, "segment", tally);
        // The point of a cone can dip into a triangle beside its edge.
        if (!std::holds_alternative<Cone>(solid))
          expect(solid, Triangle{from, to, foot - 3 * n}, truth, "edge of a triangle", tally);
        const Vec3 point = stepped(foot, n, ulps);
        expect(solid, Primitive(Sphere{point, 0}), meets_segment(solid, point, point), "point", tally);
        if (HasFatalFailure()) return;
      }
    }
  }
  tally.print();
  EXPECT_GT(tally.yes, 1500);
  EXPECT_GT(tally.no, 3000);
  EXPECT_GT(tally.exact, 500);
}

/// A segment from inside an ellipsoid to its outside on coordinates of two digits.
TEST(ExactRoundTangents, ALineFromInsideABallShapedEllipsoidIsNotLeftOpen) {
  const Ellipsoid ball{.center = Vec3::Zero(), .half_m = {1, 1, 1}};
  EXPECT_EQ(overlaps(ball, Capsule{{0.41, -0.36, 0.42}, {0.02, 0.22, -0.97}, 0}).decision, Decision::yes);
  std::mt19937_64 generator = seeded(22);
  std::uniform_int_distribution<int> hundredths(-99, 99);
  const auto point = [&] {
    return Vec3(hundredths(generator) / 100.0, hundredths(generator) / 100.0, hundredths(generator) / 100.0);
  };
  Tally tally;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 a = point();
    const Vec3 b = point();
    expect(Primitive(ball), Primitive(Capsule{a, b, 0}), meets_segment(Primitive(ball), a, b), "segment", tally);
    if (HasFatalFailure()) return;
  }
  tally.print();
  EXPECT_GT(tally.no, 50);
}

/// Ellipsoids alike in one linear map are balls seen through it: apart where their centres are farther than the sizes add up
/// to, in its coordinates.
TEST(ExactRoundTangents, AlikeEllipsoidsAreDecidedToTheLastDigit) {
  std::mt19937_64 generator = seeded(23);
  std::uniform_real_distribution<double> size(0.1, 2);
  Tally tally;
  for (int i = 0; i < 400 * times_asked(); ++i) {
    RandomShapes shapes(generator, i % 2 == 0 ? Family::random : Family::lattice);
    Ellipsoid a = shapes.ellipsoid();
    const double share = std::ldexp(1.0, i % 4 - 2);
    const Ellipsoid like{Vec3::Zero(), a.axes, share * a.half_m};
    const Vec3 displacement = direction_for(Primitive(a), generator);
    const Vec3 in_map = (a.axes.transpose() * displacement).cwiseQuotient(a.half_m);
    const Vec3 reach = displacement * ((1 + share) / in_map.norm());
    for (const int ulps : {-1, 0, 1}) {
      Ellipsoid b = like;
      b.center = stepped(a.center + reach, reach, ulps);
      // |M^-1 (b - a)| against 1 + share, M the half axes.
      Point axis[3];
      for (int k = 0; k < 3; ++k) axis[k] = times(Rational(a.half_m[k]), exact(a.axes.col(k)));
      const Rational volume = dot(axis[0], cross(axis[1], axis[2]));
      const Point w = minus(exact(b.center), exact(a.center));
      Rational apart2 = 0;
      for (int k = 0; k < 3; ++k) {
        const Rational along = dot(w, cross(axis[(k + 1) % 3], axis[(k + 2) % 3])) / volume;
        apart2 += along * along;
      }
      const Rational sizes = 1 + Rational(share);
      expect(Primitive(a), Primitive(b), apart2 <= sizes * sizes, "ellipsoid", tally);
      if (HasFatalFailure()) return;
    }
  }
  tally.print();
  EXPECT_GT(tally.yes, 200);
  EXPECT_GT(tally.no, 200);
  EXPECT_GT(tally.exact, 300);
}

/// In the plane of axis and middle a cylinder is a rectangle and a cone a triangle, the ball a disc: a hundred digits tell
/// which is nearer than all but exact tangents.
Wide gap_to_profile(const std::vector<std::pair<Wide, Wide>>& corners, const Wide& z, const Wide& rho) {
  bool is_inside = true;
  Wide least = -1;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& [z0, q0] = corners[i];
    const auto& [z1, q1] = corners[(i + 1) % corners.size()];
    const Wide dz = z1 - z0;
    const Wide dq = q1 - q0;
    if (dz * (rho - q0) - dq * (z - z0) < 0) is_inside = false;
    Wide t = ((z - z0) * dz + (rho - q0) * dq) / (dz * dz + dq * dq);
    t = t < 0 ? Wide(0) : t > 1 ? Wide(1) : t;
    const Wide away2 = (z - z0 - t * dz) * (z - z0 - t * dz) + (rho - q0 - t * dq) * (rho - q0 - t * dq);
    if (least < 0 || away2 < least) least = away2;
  }
  return is_inside ? Wide(0) : sqrt(least);
}

TEST(ExactRoundTangents, ABallBesideACylinderOrConeIsDecidedToTheLastDigit) {
  std::mt19937_64 generator = seeded(24);
  Tally tally;
  for (const Family family : {Family::random, Family::lattice, Family::tenths, Family::far_lattice}) {
    RandomShapes shapes(generator, family);
    std::uniform_real_distribution<double> distance(0.05, 1.5);
    for (int i = 0; i < 300 * times_asked(); ++i) {
      const Primitive solid = round_solid(shapes, 2 + i % 2);
      const kernel::Convex set = convex_of(solid);
      const Vec3 n = direction_for(solid, generator);
      const double radius_m = distance(generator);
      // Pushed out along a normal of the side, the flat end or in the cone of directions at the rim.
      const Vec3 middle = lowest(solid, n) - radius_m * n;
      for (const int ulps : {-1, 0, 1}) {
        const Sphere ball{stepped(middle, n, ulps), radius_m};
        const Point axis = minus(exact(set.carrier[1]), exact(set.carrier[0]));
        const Point w = minus(exact(ball.center), exact(set.carrier[0]));
        const Point turn = cross(w, axis);
        const Wide length = sqrt(Wide(dot(axis, axis)));
        const Wide z = Wide(dot(w, axis)) / length;
        const Wide rho = sqrt(Wide(dot(turn, turn))) / length;
        const Wide radius = set.disc_m;
        std::vector<std::pair<Wide, Wide>> profile{{0, -radius}, {length, -radius}, {length, radius}, {0, radius}};
        if (set.first_disc > 0) profile = {{0, 0}, {length, -radius}, {length, radius}};
        const Wide gap = gap_to_profile(profile, z, rho) - Wide(radius_m);
        expect(solid, Primitive(ball), gap < Wide("1e-60"), "ball", tally);
        if (HasFatalFailure()) return;
      }
    }
  }
  tally.print();
  EXPECT_GT(tally.yes, 1000);
  EXPECT_GT(tally.no, 1000);
  EXPECT_GT(tally.exact, 500);
}

/// Solids at rest as people write them: on each other, side by side, lying, with decimal places.
TEST(ExactRoundTangents, WhatRestsOrStandsSideBySideIsTouching) {
  const auto touching = [](const Primitive& a, const Primitive& b, const char* what) {
    EXPECT_EQ(overlaps(a, b).decision, Decision::yes) << what;
    EXPECT_EQ(overlaps(b, a).decision, Decision::yes) << what;
    EXPECT_EQ(exactly::overlaps(a, b), Decision::yes) << what;
  };
  const Box slab{.center = {0, 0, -1}, .half_m = {4, 4, 1}};
  const Cylinder lying{{-0.5, 0, 0.5}, {0.5, 0, 0.5}, 0.5};
  const Cylinder standing{{0, 0, 0}, {0, 0, 1}, 0.5};
  touching(slab, lying, "barrel on a slab");
  touching(slab, Cone{{-0.5, 0, 0.5}, {0.5, 0, 0.5}, 0.5}, "cone on its rim");
  touching(slab, Cone{{0, 0, 0}, {0, 0, 1}, 0.5}, "cone on its tip");
  touching(slab, Ellipsoid{.center = {0.3, 0.1, 0.7}, .half_m = {2, 1, 0.7}}, "ellipsoid on a slab");
  touching(standing, Cylinder{{0, 0, 1}, {0, 0, 2}, 0.5}, "drum on a drum");
  touching(standing, Cylinder{{1, 0, 0.25}, {1, 0, 2}, 0.5}, "drum beside a drum");
  touching(standing, Cylinder{{1, 0, 2}, {1, 0, 0.25}, 0.5}, "drum beside a drum upside down");
  touching(standing, Cylinder{{-2, 1, 0.5}, {2, 1, 0.5}, 0.5}, "lying drum beside a standing one");
  touching(standing, Cone{{0.75, 0, -1}, {0.75, 0, 1}, 0.25}, "a cone's rim beside a drum");
  touching(standing, Cone{{0, 0, 3}, {0, 0, 1}, 0.5}, "cone on a drum");
  touching(standing, Ellipsoid{.center = {0, 0, 1.5}, .half_m = {2, 2, 0.5}}, "ellipsoid on a drum");
  touching(standing, Ellipsoid{.center = {1.5, 0, 0.5}, .half_m = {1, 2, 0.25}}, "ellipsoid beside a drum");
  touching(standing, Capsule{{1, 0, -3}, {1, 0, 0.25}, 0.5}, "capsule beside a drum");
  touching(Capsule{{0, 0, 0}, {0, 0, 1}, 0.5}, Ellipsoid{.center = {1.5, 0, 0.5}, .half_m = {1, 2, 0.25}},
           "ellipsoid beside a capsule");
  touching(Sphere{{0, 0, 0}, 0.5}, Ellipsoid{.center = {1.5, 0, 0}, .half_m = {1, 2, 0.25}}, "ellipsoid beside a ball");
  const double just = std::nextafter(1.0, 2.0);
  EXPECT_EQ(overlaps(Primitive(standing), Primitive(Cylinder{{just, 0, 0.25}, {just, 0, 2}, 0.5})).decision,
            Decision::no);
  EXPECT_EQ(overlaps(Primitive(standing), Primitive(Cone{{0, 0, 3}, {0, 0, just}, 0.5})).decision, Decision::no);
}

/// The six kinds as they stand, or rolled by 90 degrees about an axis of the world, on tenths.
Primitive everyday_solid(std::mt19937_64& generator, int kind) {
  const auto tenths = [&] { return std::uniform_int_distribution<int>(1, 12)(generator) / 10.0; };
  const double radius_m = tenths();
  const Vec3 end(0, 0, tenths() / 2);
  switch (kind) {
    case 0: return Sphere{Vec3::Zero(), radius_m};
    case 1: return Box{.center = Vec3::Zero(), .half_m = {radius_m, tenths(), tenths()}};
    case 2: return Capsule{-end, end, radius_m};
    case 3: return Cylinder{-end, end, radius_m};
    case 4: return Cone{end, -end, radius_m};
    default: return Ellipsoid{.center = Vec3::Zero(), .half_m = {radius_m, tenths(), tenths()}};
  }
}

/// One on the other or beside it, moved as far as their bounds say, which rounding makes a touch, a gap or an overlap of the
/// last digits. For the numbers given nothing is left open. As placed, a roll leaves the axes 1e-17 off their right angles, and a
/// rim beside a round side then some 1e-33 m from touching it: too little to tell, of less than one in a hundred.
TEST(ExactRoundTangents, WhatIsStackedOrRolledBesideIsDecided) {
  std::mt19937_64 generator = seeded(28);
  const auto pick = [&](int most) { return std::uniform_int_distribution<int>(0, most)(generator); };
  const double h = 0.7071067811865476;
  const Quat rolls[] = {Quat::Identity(), Quat(h, h, 0, 0), Quat(h, 0, h, 0), Quat(h, 0, 0, h)};
  const auto bounds_of = [](const Primitive& solid) {
    return std::visit([](const auto& shape) { return bounds(shape); }, solid);
  };
  int open = 0;
  int asked = 0;
  for (int i = 0; i < 3000 * times_asked(); ++i) {
    const int kind_a = pick(5);
    const int kind_b = 3 + pick(2);
    const Primitive a = everyday_solid(generator, kind_a);
    const Primitive b = everyday_solid(generator, kind_b);
    const Quat roll_a = rolls[pick(3)].normalized();
    const Quat roll_b = rolls[pick(3)].normalized();
    const int up = pick(1) == 0 ? 2 : 0;
    const Vec3 at_a(pick(100) / 10.0 - 5, pick(100) / 10.0 - 5, 0);
    Vec3 at_b = at_a;
    const double rise_m = bounds_of(place(frame_of({Vec3::Zero(), roll_a}), a)).high[up] -
                          bounds_of(place(frame_of({Vec3::Zero(), roll_b}), b)).low[up];
    at_b[up] += std::round(rise_m * 1e6) / 1e6;
    const Pose pose_a{at_a, roll_a};
    const Pose pose_b{at_b, roll_b};
    const Frame frame_a = frame_of(pose_a);
    const Frame frame_b = frame_of(pose_b);
    const ConvexPart placed_a = place(frame_a, a);
    const ConvexPart placed_b = place(frame_b, b);
    const GivenPart given_a{.own = &a, .pose = &pose_a, .frame = &frame_a};
    const GivenPart given_b{.own = &b, .pose = &pose_b, .frame = &frame_b};
    ASSERT_NE(overlaps_as_given(placed_a, placed_b, {given_a, given_b}), Decision::undecided) << i;
    const Decision decision = overlaps(placed_a, placed_b).decision;
    ASSERT_TRUE(kind_a >= 2 || decision != Decision::undecided) << kind_a << " " << kind_b;
    asked += 1;
    open += decision == Decision::undecided;
  }
  std::printf("%d pairs at rest, 0 undecided; %d as placed\n", asked, open);
  EXPECT_LE(open * 100, asked);
}

/// A hull that a turn has bent: its placed corners are the truth, not its faces.
TEST(ExactRoundTangents, ABentHullIsTheHullOfItsPlacedCorners) {
  std::mt19937_64 generator = seeded(25);
  RandomShapes shapes(generator, Family::random);
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 3 : -3, i & 2 ? 3 : -3, i & 4 ? 0 : -1);
  const Hull block{std::make_shared<const TriangleMesh>(*convex_hull(corners))};
  int decided = 0;
  for (int i = 0; i < 300; ++i) {
    const Quat q =
        Quat(shapes.coordinate(), shapes.coordinate(), shapes.coordinate(), shapes.coordinate()).normalized();
    const Hull placed = place(frame_of({shapes.point(), q}), block);
    const Vec3 up = placed.rotation.col(2);
    const Cylinder lying{placed.position + 0.5 * up - 0.25 * Vec3(placed.rotation.col(0)),
                         placed.position + 0.5 * up + 0.75 * Vec3(placed.rotation.col(0)), 0.5};
    const ExactResult verdict = overlaps(Primitive(placed), Primitive(lying));
    ASSERT_NE(verdict.decision, Decision::undecided);
    ASSERT_EQ(overlaps(Primitive(lying), Primitive(placed)).decision, verdict.decision);
    decided += verdict.level == Level::rational;
    // By all tetrahedra of its corners: what one of them shares, the hull does.
    bool shares = false;
    for (std::size_t a = 0; a < 8; ++a) {
      for (std::size_t b = a + 1; b < 8; ++b) {
        for (std::size_t c = b + 1; c < 8; ++c) {
          const Triangle face{vertex_of(placed, a), vertex_of(placed, b), vertex_of(placed, c)};
          shares = shares || overlaps(Primitive(lying), face).yes();
        }
      }
    }
    ASSERT_EQ(verdict.yes(), shares);
  }
  EXPECT_GT(decided, 100);
}

}  // namespace
}  // namespace collided::engine::round_tangents_test
