// U2: rods of 1 : 10,000 and sheets of a micrometre: the iteration of a general solver converges along the long axis and
// never sees the short one; FCL is 12 % off on such rods.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::rods_slabs_test {
namespace {

void expect_depth(const Contact& found, double depth_m) {
  EXPECT_LE(std::abs(found.depth_m - depth_m), found.depth_error_m);
  EXPECT_LE(found.depth_error_m, 1e-12 * depth_m);
}

const Box kRod{.center = {0, 0, 0}, .half_m = {8192, 0.5, 0.5}};

TEST(ExtremeRodsSlabs, RodsCrossAtTheirMiddleAndAtTheirEnds) {
  for (const double x : {0.0, 8000.0, -8192.0}) {
    for (const double y : {0.0, 8000.0}) {
      const Box across{.center = {x, y, 0.75}, .half_m = {0.5, 8192, 0.5}};
      ASSERT_TRUE(overlaps(kRod, across).yes());
      expect_depth(contact(kRod, across), 0.25);
      EXPECT_EQ(overlaps(kRod, Box{.center = {x, y, extreme::up(1)}, .half_m = {0.5, 8192, 0.5}}).decision,
                Decision::no);
    }
  }
}

TEST(ExtremeRodsSlabs, SheetsThroughEachOther) {
  const Box sheet{.center = {0, 0, 0}, .half_m = {1, 1, 0x1p-20}};
  expect_depth(contact(sheet, Box{.center = {0.5, 0.5, 0x1p-20}, .half_m = {1, 1, 0x1p-20}}), 0x1p-20);
  EXPECT_TRUE(overlaps(sheet, Box{.center = {0, 0, 0x1p-19}, .half_m = {1, 1, 0x1p-20}}).yes());
  EXPECT_EQ(overlaps(sheet, Box{.center = {0, 0, extreme::up(0x1p-19)}, .half_m = {1, 1, 0x1p-20}}).decision,
            Decision::no);
  const Box upright{.center = {0, 0, 1}, .half_m = {0x1p-20, 1, 1}};
  EXPECT_TRUE(overlaps(sheet, upright).yes());
}

TEST(ExtremeRodsSlabs, ABallOnARodAndAThread) {
  expect_depth(contact(Sphere{{8000, 0, 1.25}, 1}, kRod), 0.25);
  const Capsule thread{{-1e6, 0, 0}, {1e6, 0, 0}, 0x1p-20};
  EXPECT_TRUE(overlaps(Sphere{{999'999, 0, 1 + 0x1p-20}, 1}, thread).yes());
  EXPECT_EQ(overlaps(Sphere{{999'999, 0, 1 + 0x1p-20 + 0x1p-52}, 1}, thread).decision, Decision::no);
  RayHit hit;
  ASSERT_TRUE(cast_ray({{123'456, 0, 1}, {0, 0, -1}}, thread, hit).yes());
  EXPECT_EQ(hit.distance_m, 1 - 0x1p-20);
  EXPECT_FALSE(cast_ray({{123'456, extreme::up(0x1p-20), 1}, {0, 0, -1}}, thread, hit).yes());
}

}  // namespace
}  // namespace collided::engine::rods_slabs_test
