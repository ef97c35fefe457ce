// U2: boxes with parallel edges make nine of the fifteen separating axes zero; FCL's signed distance aborts the process on
// such pairs.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"

namespace collided::engine::aligned_boxes_test {
namespace {

/// The 24 turns that map the axes to themselves; mirrored ones too, which make the same box.
std::vector<Mat3> axis_turns() {
  std::vector<Mat3> all;
  int order[3] = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 turn = Mat3::Zero();
      for (int i = 0; i < 3; ++i) turn(order[i], i) = signs >> i & 1 ? -1 : 1;
      all.push_back(turn);
    }
  } while (std::next_permutation(order, order + 3));
  return all;
}

TEST(ExtremeAlignedBoxes, EveryLatticeOffsetAndEveryTurn) {
  const Box fixed{.center = {0, 0, 0}, .half_m = {1, 1, 1}};
  for (const Mat3& turn : axis_turns()) {
    for (int place = 0; place < 7 * 7 * 7; ++place) {
      const Vec3 offset(place % 7 - 3, place / 7 % 7 - 3, place / 49 - 3);
      const Box other{.center = offset, .axes = turn, .half_m = {1, 1, 1}};
      const double reach = offset.cwiseAbs().maxCoeff();
      ASSERT_EQ(overlaps(fixed, other).yes(), reach <= 2) << offset.transpose();
      ASSERT_EQ(overlaps(other, fixed).yes(), reach <= 2) << offset.transpose();
      if (reach > 2) continue;
      const Contact found = contact(fixed, other);
      ASSERT_EQ(found.depth_m, 2 - reach) << offset.transpose();
      ASSERT_NEAR(found.normal.norm(), 1, 1e-15);
    }
  }
}

TEST(ExtremeAlignedBoxes, TenthsThatAreNotTenths) {
  // 0.1 + 0.2 > 0.3 in double: a box from 0.3 up and one of half 0.2 at 0.1 overlap by that.
  const Box low{.center = {0.1, 0, 0}, .half_m = {0.2, 1, 1}};
  const Box high{.center = {0.7, 0, 0}, .half_m = {0.4, 1, 1}};
  EXPECT_TRUE(overlaps(low, high).yes()) << "the exact sums: 0.1 + 0.2 = 0.3 + 1.7e-17, 0.7 - 0.4 = 0.3 - 6.7e-17";
  const Contact found = contact(low, high);
  EXPECT_GT(found.depth_m, 0);
  EXPECT_LT(found.depth_m, 1e-16);
}

TEST(ExtremeAlignedBoxes, StacksOfABillionMetres) {
  for (double z = 0x1p-30; z <= 0x1p30; z *= 0x1p10) {
    const Box below{.center = {0, 0, z}, .half_m = {1, 1, z}};
    const Box above{.center = {0, 0, 3 * z}, .half_m = {1, 1, z}};
    EXPECT_TRUE(overlaps(below, above).yes());
    EXPECT_EQ(contact(below, above).depth_m, 0);
    EXPECT_FALSE(overlaps(below, Box{.center = {0, 0, std::nextafter(3 * z, INFINITY)}, .half_m = {1, 1, z}}).yes());
  }
}

}  // namespace
}  // namespace collided::engine::aligned_boxes_test
