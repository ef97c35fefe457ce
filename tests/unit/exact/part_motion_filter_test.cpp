// The filter that spares most first contacts, beside them.
#include <gtest/gtest.h>

#include <random>

#include "server/exact_phase/motion/part_motion_filter.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::part_motion_filter_test {
namespace {

class PartMotionFilter : public testing::TestWithParam<oracle::Family> {
 protected:
  double any() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 vector() {
    const double x = any(), y = any();
    return {x, y, any()};
  }
  Quat rotation(double most) {
    const double x = most * any(), y = most * any();
    return Quat(1, x, y, most * any()).normalized();
  }
  BodyMotion motion(double away_m, double turn) {
    const Quat first = rotation(1);
    const Vec3 from = away_m * vector();
    return {frame_of({.position = from, .rotation = first}),
            frame_of({.position = from + vector(), .rotation = (rotation(turn) * first).normalized()})};
  }

  std::mt19937_64 random_ = oracle::seeded(20261202);
};

kernel::MovingCore moving(const PartMotion& part, const TimeSpan& span) {
  const kernel::MotionPiece piece(*part.motion, span);
  return std::visit(
      [&](const auto& own) {
        if constexpr (std::is_constructible_v<kernel::Core, decltype(own)>)
          return piece.moving(own, *part.motion, part.reach_m);
        else return kernel::MovingCore{kernel::Core(Sphere{}), kernel::Core(Sphere{})};
      },
      part.own);
}

INSTANTIATE_TEST_SUITE_P(Families, PartMotionFilter, testing::ValuesIn(oracle::kFamiliesOfUsualSize),
                         [](const auto& family) { return std::string(oracle::name(family.param)); });

TEST_P(PartMotionFilter, WhatItCallsApartHasNoContact) {
  oracle::RandomShapes shapes(random_, GetParam());
  int apart = 0;
  int found_apart = 0;
  for (int i = 0; i < 2000; ++i) {
    const double turn = i % 3 == 0 ? 0 : 0.4;
    const Triangle triangle = shapes.triangle();
    const BoundedPart others[] = {shapes.sphere(), shapes.box(), shapes.capsule(), shapes.triangle()};
    const BodyMotion of_a = motion(GetParam() == oracle::Family::random ? 2 : 0.5, turn);
    const BodyMotion of_b = i % 2 == 0 ? BodyMotion::resting(of_a.from) : motion(2, turn);
    const PartMotion a(others[i % 4], of_a);
    const PartMotion b(triangle, of_b);
    const TimeSpan span{0.3 * std::abs(any()), 1 - 0.6 * std::abs(any())};
    const bool is_sure = kernel::surely_apart(moving(a, span), moving(b, span));
    ASSERT_EQ(is_sure, kernel::surely_apart(moving(b, span), moving(a, span))) << i;
    TimeBracket bracket;
    const ExactResult verdict = first_contact(a, b, span, 1e-6, bracket);
    ASSERT_FALSE(is_sure && verdict.yes()) << i << " at " << bracket.low;
    apart += verdict.decision == Decision::no ? 1 : 0;
    found_apart += is_sure ? 1 : 0;
  }
  EXPECT_GT(found_apart, apart / 2) << "a filter that never says apart spares nothing";
}

// A small ball that stops where it touches a large face, oblique and far out on all sides, to the last digit: products
// with the face's normal have more digits than a double.
TEST(PartMotionFilters, ATouchOfALargeFaceIsNeverSurelyApart) {
  std::mt19937_64 random = oracle::seeded(20261204);
  std::uniform_int_distribution<int> far(-300'000, 300'000);
  const Vec3 out(2, 3, 6);  // of length 7
  const auto in_plane = [&] {
    const double along = far(random);
    return Vec3(along * Vec3(3, -2, 0) + static_cast<double>(far(random)) * Vec3(6, 0, -2));
  };
  const BodyMotion rest = BodyMotion::resting({});
  for (int i = 0; i < 500; ++i) {
    const Vec3 a = in_plane();
    const Vec3 b = in_plane();
    const PartMotion face(Triangle{a, b, -(a + b)}, rest);
    const Vec3 end = 0x1p-20 * out;
    const BodyMotion motion(frame_of({.position = 4 * end, .rotation = Quat::Identity()}),
                            frame_of({.position = end, .rotation = Quat::Identity()}));
    const PartMotion ball(Sphere{Vec3::Zero(), 7 * 0x1p-20}, motion);
    EXPECT_FALSE(kernel::surely_apart(moving(ball, {}), moving(face, {}))) << i;
  }
}

// A ball that stops where it touches a face, an edge or a corner, near the origin and far from it; a hair above, it is
// free, and the filter may say so.
TEST(PartMotionFilters, ATouchIsNeverSurelyApart) {
  const Triangle floor{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  const BodyMotion rest = BodyMotion::resting({});
  for (const double far_m : {0.0, 1.0, 1e3, 1e6, 1e9}) {
    for (const Vec3& touch : {Vec3(0, 0, 0.5), Vec3(0, -1.5, 0), Vec3(0, 1.5, 0)}) {
      const Vec3 way(0.25, 0.125, 1);
      for (const double off_m : {0.0, -0x1p-12}) {
        const Vec3 end = touch + (off_m * touch.normalized());
        const BodyMotion motion(frame_of({.position = end + way * far_m + touch, .rotation = Quat::Identity()}),
                                frame_of({.position = end, .rotation = Quat::Identity()}));
        const PartMotion ball(Sphere{Vec3::Zero(), 0.5}, motion);
        const PartMotion part(floor, rest);
        EXPECT_FALSE(kernel::surely_apart(moving(ball, {}), moving(part, {}))) << far_m << ' ' << touch.transpose();
      }
      const BodyMotion free(frame_of({.position = 1.5 * touch, .rotation = Quat::Identity()}),
                            frame_of({.position = 1.01 * touch, .rotation = Quat::Identity()}));
      EXPECT_TRUE(kernel::surely_apart(moving(PartMotion(Sphere{Vec3::Zero(), 0.5}, free), {}),
                                       moving(PartMotion(floor, rest), {})));
    }
  }
}

}  // namespace
}  // namespace collided::engine::part_motion_filter_test
