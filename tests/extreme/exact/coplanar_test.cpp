// Faces in one plane: every orientation sign is zero, so a test that sorts by them sees neither side; stacked crates and
// tiled floors are made of nothing else.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::coplanar_test {
namespace {

/// (u, v) in the plane z = x + y, which no axis is parallel to; exact for small multiples of powers of two.
Vec3 slanted(double u, double v) { return {u, v, u + v}; }
Triangle in_plane(double u0, double v0, double u1, double v1, double u2, double v2) {
  return {slanted(u0, v0), slanted(u1, v1), slanted(u2, v2)};
}

void expect(const Triangle& a, const Triangle& b, bool touching) {
  for (const Triangle& x : {a, Triangle{a.b, a.c, a.a}, Triangle{a.c, a.b, a.a}}) {
    for (const Triangle& y : {b, Triangle{b.c, b.a, b.b}, Triangle{b.b, b.a, b.c}}) {
      ASSERT_EQ(overlaps(x, y).decision, touching ? Decision::yes : Decision::no);
      ASSERT_EQ(overlaps(y, x).decision, touching ? Decision::yes : Decision::no);
    }
  }
}

const Triangle kBase = in_plane(0, 0, 4, 0, 0, 4);

TEST(ExtremeCoplanar, TrianglesInOnePlane) {
  expect(kBase, in_plane(1, 1, 2, 1, 1, 2), true);        // inside
  expect(kBase, in_plane(-9, -9, 90, -9, -9, 90), true);  // around
  expect(kBase, in_plane(4, 0, 8, 0, 8, 4), true);        // a corner in common
  expect(kBase, in_plane(2, 2, 4, 4, 2, 4), true);        // a corner on the long edge
  expect(kBase, in_plane(4, 0, 0, 4, 4, 4), true);        // an edge in common
  expect(kBase, in_plane(1, -1, 1, 9, 2, 9), true);       // edges crossing, no corner inside
  expect(kBase, in_plane(2, 2 + 0x1p-50, 4, 4, 2, 4), false);
  expect(kBase, in_plane(4 + 0x1p-50, 0, 8, 0, 8, 4), false);
  expect(kBase, in_plane(-1, 0, -1, 4, -0x1p-1074, 2), false);
}

TEST(ExtremeCoplanar, ParallelPlanesOneStepApart) {
  Triangle lifted = kBase;
  for (Vec3* corner : {&lifted.a, &lifted.b, &lifted.c}) corner->z() += 0x1p-50;
  expect(kBase, lifted, false);
  const Triangle tilted{slanted(0, 0), slanted(4, 0), slanted(0, 4) + Vec3(0, 0, 0x1p-50)};
  expect(kBase, tilted, true);
}

TEST(ExtremeCoplanar, CratesFaceToFaceAndSideBySide) {
  const Box crate{.center = {0, 0, 0}, .half_m = {1, 1, 1}};
  const Box right{.center = {2, 1, 0}, .half_m = {1, 1, 1}};
  const Box above{.center = {0.5, 0.5, 2}, .half_m = {1, 1, 1}};
  EXPECT_TRUE(overlaps(crate, right).yes());
  EXPECT_TRUE(overlaps(crate, above).yes());
  EXPECT_EQ(contact(crate, above).depth_m, 0);
  EXPECT_NEAR(contact(crate, above).normal.z(), 1, 1e-15);
  const Vec3 point = contact(crate, above).point;
  EXPECT_EQ(point.z(), 1);
  EXPECT_TRUE(point.x() >= -0.5 && point.x() <= 1 && point.y() >= -0.5 && point.y() <= 1) << "in the common area";
}

TEST(ExtremeCoplanar, ATriangleInTheFaceOfABox) {
  const Box crate{.center = {0, 0, 0}, .half_m = {1, 1, 1}};
  const auto in_top = [](double z) { return Triangle{{-3, -3, z}, {3, -3, z}, {0, 3, z}}; };
  EXPECT_TRUE(overlaps(crate, in_top(1)).yes());
  EXPECT_EQ(overlaps(crate, in_top(extreme::up(1))).decision, Decision::no);
  EXPECT_TRUE(overlaps(crate, Triangle{{1, -3, 1}, {1, 3, 1}, {5, 0, 1}}).yes()) << "its edge along the box's";
  EXPECT_EQ(overlaps(crate, Triangle{{extreme::up(1), -3, 1}, {extreme::up(1), 3, 1}, {5, 0, 1}}).decision,
            Decision::no);
}

}  // namespace
}  // namespace collided::engine::coplanar_test
