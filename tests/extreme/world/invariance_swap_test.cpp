// Which argument comes first, and which corner, is an accident of the caller: numbers may differ in their last bits,
// never beyond what their bounds say, and decisions not at all.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::invariance_swap_test {
namespace {

using oracle::RandomShapes;

/// |a - b| within both bounds, also where a bound is infinite.
void expect_agree(double a, double a_error, double b, double b_error, const char* what) {
  ASSERT_TRUE(std::abs(a - b) <= a_error + b_error)
      << what << ": " << a << " +- " << a_error << ", " << b << " +- " << b_error;
}

template <class A>
void expect_same_either_way(const A& a, const A& b, const char* family) {
  const ExactResult one = overlaps(a, b);
  const ExactResult other = overlaps(b, a);
  ASSERT_EQ(one.decision, other.decision) << family;
  if (!one.yes()) return;
  const Contact forth = contact(a, b);
  const Contact back = contact(b, a);
  expect_agree(forth.depth_m, forth.depth_error_m, back.depth_m, back.depth_error_m, family);
}

TEST(ExtremeInvarianceSwap, OverlapsAndDepths) {
  std::mt19937_64 generator = oracle::seeded(481);
  for (const oracle::Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 100 && !HasFatalFailure(); ++i) {
      expect_same_either_way(shapes.sphere(), shapes.sphere(), name(family));
      expect_same_either_way(shapes.box(), shapes.box(), name(family));
      expect_same_either_way(shapes.capsule(), shapes.capsule(), name(family));
      expect_same_either_way(shapes.triangle(), shapes.triangle(), name(family));
      expect_same_either_way(Primitive(shapes.sphere()), Primitive(shapes.box()), name(family));
      expect_same_either_way(Primitive(shapes.box()), Primitive(shapes.capsule()), name(family));
    }
  }
}

TEST(ExtremeInvarianceSwap, CornersInEveryOrder) {
  std::mt19937_64 generator = oracle::seeded(482);
  for (const oracle::Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 40; ++i) {
      const Triangle t = shapes.triangle();
      const Triangle other = shapes.triangle();
      const Box box = shapes.box();
      const Capsule capsule = shapes.capsule();
      const Sphere sphere = shapes.sphere();
      const Ray ray = shapes.ray(true);
      const Vec3 point = shapes.point();
      const Triangle orders[] = {{t.b, t.c, t.a}, {t.c, t.a, t.b}, {t.b, t.a, t.c}, {t.a, t.c, t.b}, {t.c, t.b, t.a}};
      RayHit hit, turned_hit;
      const Decision met = cast_ray(ray, t, hit).decision;
      const Closest near = closest(point, t);
      for (const Triangle& turned : orders) {
        ASSERT_EQ(overlaps(turned, other).decision, overlaps(t, other).decision) << name(family);
        ASSERT_EQ(overlaps(box, turned).decision, overlaps(box, t).decision) << name(family);
        ASSERT_EQ(overlaps(capsule, turned).decision, overlaps(capsule, t).decision) << name(family);
        ASSERT_EQ(overlaps(sphere, turned).decision, overlaps(sphere, t).decision) << name(family);
        ASSERT_EQ(cast_ray(ray, turned, turned_hit).decision, met) << name(family);
        if (met == Decision::yes) {
          expect_agree(hit.distance_m, hit.distance_error_m, turned_hit.distance_m, turned_hit.distance_error_m,
                       name(family));
        }
        const Closest turned_near = closest(point, turned);
        expect_agree(near.distance_m, near.distance_error_m, turned_near.distance_m, turned_near.distance_error_m,
                     name(family));
      }
      const Capsule reversed{capsule.b, capsule.a, capsule.radius_m};
      ASSERT_EQ(overlaps(capsule, box).decision, overlaps(reversed, box).decision) << name(family);
      ASSERT_EQ(overlaps(capsule, sphere).decision, overlaps(reversed, sphere).decision) << name(family);
    }
  }
}

// In the world the contact's normal points from the lower id to the higher, whoever was placed where.
TEST(ExtremeInvarianceSwap, TheWorldsNormalFollowsTheIds) {
  for (const bool swapped : {false, true}) {
    extreme::Stage stage;
    stage.ball("first", {swapped ? 1.5 : 0, 0, 0}, 1);
    stage.block("second", {swapped ? 0 : 1.5, 0, 0}, {1, 1, 1});
    stage.step();
    ASSERT_EQ(stage.world.contacts().size(), 1u);
    const OpenContact& found = stage.world.contacts()[0];
    EXPECT_LT(found.a, found.b);
    EXPECT_NEAR(found.contact.normal.x(), swapped ? -1 : 1, 1e-15);
    EXPECT_NEAR(found.contact.depth_m, 0.5, 1e-15);
  }
}

}  // namespace
}  // namespace collided::engine::invariance_swap_test
