// Filters for pairs of boxes in plain double: what they decide is so, and what they leave out is never the answer.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/facet_filter.hpp"
#include "server/exact_phase/motion/body_motion.hpp"
#include "server/exact_phase/motion/box_motion_filter.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/overlap/separation_filter.hpp"
#include "server/geometry/pose.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::box_filters_test {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(oracle::seeded(seed)) {}
  double part() { return std::uniform_real_distribution<double>(-1, 1)(bits_); }
  Vec3 point() {
    const double x = part(), y = part();
    return {x, y, part()};
  }
  Quat rotation() {
    const double w = part(), x = part(), y = part();
    return Quat(w, x, y, part()).normalized();
  }
  Frame frame(double spread_m) { return frame_of({.position = spread_m * point(), .rotation = rotation()}); }
  Box box() {
    return {.center = 0.1 * point(), .axes = Mat3::Identity(), .half_m = point().cwiseAbs() + Vec3::Constant(0.1)};
  }
  std::uint64_t number(std::uint64_t below) { return bits_() % below; }

 private:
  std::mt19937_64 bits_;
};

/// The least translation along an axis that parts the two, in long double: a relative error of 2^-60 or so.
long double depth_along(const kernel::FacetAxis& axis, const kernel::Core& a, const kernel::Core& b) {
  using Vec = Eigen::Matrix<long double, 3, 1>;
  const auto wide = [](const Vec3& v) { return Vec(v.cast<long double>()); };
  const Vec n = (wide(axis.u.to) - wide(axis.u.from)).cross(wide(axis.v.to) - wide(axis.v.from));
  long double largest = -std::numeric_limits<long double>::infinity();
  long double smallest = -largest;
  for (int i = 0; i < a.point_count; ++i) {
    for (int j = 0; j < b.point_count; ++j) {
      const long double along = n.dot(wide(a.point[i]) - wide(b.point[j]));
      largest = std::max(largest, along);
      smallest = std::min(smallest, along);
    }
  }
  long double reach = 0;
  for (const kernel::Core* core : {&a, &b}) {
    for (int i = 0; core->is_box && i < 3; ++i)
      reach += static_cast<long double>(core->half_m[i]) * std::abs(n.dot(wide(Vec3(core->axes.col(i)))));
  }
  return (reach + std::min(largest, -smallest)) / n.norm();
}

/// Every axis that is left out is deeper than another.
int expect_filter_right(const kernel::Core& a, const kernel::Core& b) {
  const kernel::FacetAxes axes = kernel::facet_axes(a, b);
  const std::uint32_t kept = kernel::axes_of_least_push(axes, a, b);
  long double least = std::numeric_limits<long double>::infinity();
  for (int i = 0; i < axes.count; ++i) {
    const long double depth = depth_along(axes.axis[i], a, b);
    if (depth < least) least = depth;
  }
  for (int i = 0; i < axes.count; ++i) {
    if ((kept >> i & 1) == 0) { EXPECT_GT(depth_along(axes.axis[i], a, b), least) << "axis " << i; }
  }
  EXPECT_NE(kept, 0u);
  return std::popcount(kept);
}

TEST(ExactContact, FilteredAxesGiveTheContactOfAllAxes) {
  Random random(20261124);
  int kept = 0;
  constexpr int kPairs = 20'000;
  for (int i = 0; i < kPairs; ++i) {
    const double far_m = i % 4 == 0 ? 1e6 : 1;
    const Frame frame_a = random.frame(far_m);
    Frame frame_b = random.frame(1);
    frame_b.position += frame_a.position;
    const kernel::Core a(place(frame_a, random.box()));
    const auto corner = [&] { return place(frame_b, random.point()); };
    if (i % 2 == 0) kept += expect_filter_right(a, kernel::Core(place(frame_b, random.box())));
    else if (i % 3 == 0) kept += expect_filter_right(a, kernel::Core(Capsule{corner(), corner(), 0.1}));
    else kept += expect_filter_right(a, kernel::Core(Triangle{corner(), corner(), corner()}));
  }
  EXPECT_LT(kept, 1.1 * kPairs) << "a filter that keeps everything would be right too";
}

// Depths that differ by rounding alone: the axis is chosen by a fixed order among all of them, so none may be left out.
TEST(ExactContact, AFilterKeepsEveryAxisOfATie) {
  Random random(20261125);
  for (int i = 0; i < 2'000; ++i) {
    const Frame frame = random.frame(1);
    const Box box{.center = Vec3::Zero(), .axes = Mat3::Identity(), .half_m = Vec3::Constant(1)};
    const double shift_m = 0.5 + 0.5 * std::abs(random.part());
    const Box one = place(frame, box);
    Box other = one;
    other.center += shift_m * (one.axes.col(0) + one.axes.col(1));
    const kernel::Core a(one), b(other);
    const std::uint32_t kept = kernel::axes_of_least_push(kernel::facet_axes(a, b), a, b);
    EXPECT_EQ(kept & 0b011011u, 0b011011u) << "the faces across the two shifts, of both boxes";
    EXPECT_EQ(kept & 0b100100u, 0u);
  }
}

TEST(ExactSeparationFilter, AnswersForBoxesThatAreOffHoldForSmallerAndLargerOnes) {
  Random random(20261126);
  int decided = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Box a = place(random.frame(1), random.box());
    const Box b = place(random.frame(1), random.box());
    const double off_m = std::abs(random.part()) * (i % 2 == 0 ? 0.1 : 1e-9);
    const Decision quick = kernel::quickly_overlaps(a, b, off_m);
    if (quick == Decision::undecided) continue;
    ++decided;
    // Half a percent less, since a grown box is also grown at its corners.
    Box grown = a, shrunk = a;
    grown.half_m.array() += 0.57 * off_m;
    shrunk.half_m.array() -= 0.57 * off_m;
    if (quick == Decision::no) {
      EXPECT_EQ(overlaps(grown, b).decision, Decision::no) << i;
    } else if (shrunk.half_m.minCoeff() >= 0) {
      EXPECT_EQ(overlaps(shrunk, b).decision, Decision::yes) << i;
    }
  }
  EXPECT_GT(decided, 15'000);
}

TEST(ExactBoxMotionFilter, WhatIsApartIsApartForTheRationals) {
  Random random(20261127);
  int apart = 0, met = 0, passed_by = 0;
  for (int i = 0; i < 5'000; ++i) {
    const auto motion_of = [&](const Frame& from) {
      Frame to = from;
      to.position += 0.4 * random.point();
      if (i % 3 != 0)
        to.rotation = Mat3(Eigen::AngleAxisd((i % 3 == 1 ? 0.05 : 3.0) * random.part(), random.point().normalized())) *
                      from.rotation;
      return BodyMotion(from, to);
    };
    const BodyMotion motion_a = motion_of(random.frame(1.5));
    const BodyMotion motion_b = motion_of(random.frame(1.5));
    const Box own_a = random.box(), own_b = random.box();
    const auto reach_of = [](const Box& box) { return (box.center.cwiseAbs() + box.half_m).norm() * (1 + 1e-12); };
    const bool stay_apart = kernel::surely_apart(kernel::MovingBox(own_a, motion_a.from, motion_a.to, reach_of(own_a)),
                                                 kernel::MovingBox(own_b, motion_b.from, motion_b.to, reach_of(own_b)));
    bool meet = false;
    for (int k = 0; k <= 40 && !meet; ++k)
      meet = overlaps(place(motion_a.at(k / 40.0), own_a), place(motion_b.at(k / 40.0), own_b)).yes();
    EXPECT_FALSE(stay_apart && meet) << i;
    apart += stay_apart ? 1 : 0;
    met += meet ? 1 : 0;
    passed_by += !stay_apart && !meet ? 1 : 0;
  }
  EXPECT_GT(apart, 500);
  EXPECT_GT(met, 500);
  EXPECT_LT(passed_by, apart) << "it must decide most of what is apart";
}

// Faces that touch exactly before both were turned: what rounding made of it is for exact arithmetic to say.
TEST(ExactBoxMotionFilter, ATouchIsNeverSurelyApart) {
  Random random(20261128);
  int touching = 0;
  for (int i = 0; i < 5'000; ++i) {
    const Frame frame = random.frame(i % 2 == 0 ? 1 : 1e6);
    const Box box = random.box();
    const int k = static_cast<int>(random.number(3));
    Frame other = frame;
    other.position += 2 * box.half_m[k] * frame.rotation.col(k);
    touching += overlaps(place(frame, box), place(other, box)).yes() ? 1 : 0;
    const kernel::MovingBox a(box, frame, frame, 2);
    EXPECT_FALSE(kernel::surely_apart(a, kernel::MovingBox(box, other, other, 2))) << i;
  }
  EXPECT_GT(touching, 500);
  EXPECT_LT(touching, 4'500) << "rounding parts some of them";
}

}  // namespace
}  // namespace collided::engine::box_filters_test
