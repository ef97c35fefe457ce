#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>

#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/motion/moving_features.hpp"
#include "server/exact_phase/motion/moving_solids.hpp"
#include "server/exact_phase/motion/part_motion.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/part.hpp"
#include "server/geometry/aabb.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::body_motion_test {
namespace {

using oracle::Family;
using oracle::RandomShapes;

/// Unit-sized parts and ways of a few units with any turn.
class Sweeps {
 public:
  explicit Sweeps(std::mt19937_64& generator) : generator_(generator), shapes_(generator, Family::random) {}

  BoundedPart part() {
    switch (std::uniform_int_distribution<int>(0, 7)(generator_)) {
      case 0: return shapes_.sphere();
      case 1: return shapes_.box();
      case 2: return shapes_.capsule();
      case 3: return shapes_.cylinder();
      case 4: return shapes_.cone();
      case 5: return shapes_.ellipsoid();
      case 6: return shapes_.hull();
      default: return shapes_.triangle();
    }
  }
  Frame frame() {
    const Quat turn(number(), number(), number(), number());
    return frame_of({.position = Vec3(number(), number(), number()) * 2, .rotation = turn.normalized()});
  }
  BodyMotion motion() {
    const Frame from = frame();
    Frame to = frame();
    const int kind = std::uniform_int_distribution<int>(0, 3)(generator_);
    if (kind == 0) return BodyMotion::resting(from);
    if (kind == 1) to.rotation = from.rotation;
    if (kind == 2) to.position = from.position;
    return {from, to};
  }
  double number() { return std::uniform_real_distribution<double>(-1, 1)(generator_); }

 private:
  std::mt19937_64& generator_;
  RandomShapes shapes_;
};

/// The slow twin: pose by pose, no motion bounds. Parts whose bounds are apart are not tested.
bool touch_at(const PartMotion& a, const PartMotion& b, double t) {
  const BoundedPart x = a.at(t);
  const BoundedPart y = b.at(t);
  const auto box = [](const auto& shape) { return bounds(shape); };
  if (!overlaps(std::visit(box, x), std::visit(box, y))) return false;
  return std::visit([](const auto& p, const auto& q) { return overlaps(p, q).yes(); }, x, y);
}

/// How far the two are apart, at least, metres; 0 where they touch.
double gap_at(const PartMotion& a, const PartMotion& b, double t) {
  const auto whole = [](const BoundedPart& part) {
    return std::visit(
        [](const auto& shape) -> ConvexPart {
          if constexpr (std::is_same_v<decltype(shape), const Triangle&>) return shape;
          else return Primitive(shape);
        },
        part);
  };
  const Separation apart = separation(whole(a.at(t)), whole(b.at(t)));
  return std::max(0.0, apart.distance_m - apart.error_m);
}

/// A part, its motion: enough to ask again for this one alone.
std::string told(const PartMotion& moving) {
  static constexpr std::array kKinds{"sphere", "box", "capsule", "cylinder", "cone", "ellipsoid", "hull", "triangle"};
  std::ostringstream text;
  text << std::setprecision(17) << kKinds.at(moving.own.index()) << " of reach " << moving.reach_m << " from ["
       << moving.motion->from.position.transpose() << "] to [" << moving.motion->to.position.transpose() << "] turning "
       << moving.motion->turn_rad << " rad about [" << moving.motion->axis.transpose() << "]";
  return text.str();
}

int asked_sweeps(int fallback) {
  const char* asked = std::getenv("COLLIDED_SWEEPS");
  return asked != nullptr ? std::atoi(asked) : fallback;
}

TEST(ExactBodyMotion, TenThousandPosesOfAWayShowNoContactBeforeTheFirst) {
  constexpr int kSamples = 10'000;
  std::mt19937_64 generator = oracle::seeded(401);
  Sweeps make(generator);
  const int sweeps = asked_sweeps(300);
  constexpr double kWidth = 1e-6;
  int hits = 0, misses = 0, undecided = 0, grazes = 0;
  double widest = 0;
  for (int i = 0; i < sweeps; ++i) {
    const BodyMotion motion_a = make.motion();
    const BodyMotion motion_b = make.motion();
    const PartMotion a(make.part(), motion_a);
    const PartMotion b(make.part(), motion_b);
    TimeBracket bracket;
    const ExactResult verdict = first_contact(a, b, {0, 1}, kWidth, bracket);
    undecided += verdict.decision == Decision::undecided;
    EXPECT_NE(verdict.decision, Decision::undecided)
        << "sweep " << i << " from " << bracket.low << ": " << told(a) << " and " << told(b);
    (verdict.yes() ? hits : misses) += 1;
    if (verdict.yes()) {
      ASSERT_TRUE(touch_at(a, b, bracket.high)) << "sweep " << i;
      ASSERT_LE(bracket.low, bracket.high);
      widest = std::max(widest, bracket.high - bracket.low);
      if (bracket.high - bracket.low > kWidth) {
        ++grazes;
        EXPECT_LE(gap_at(a, b, bracket.low), 1e-12)
            << "sweep " << i << ", bracket " << bracket.low << " + " << bracket.high - bracket.low << ": " << told(a)
            << " and " << told(b);
      }
    }
    const double clear = verdict.yes() ? (bracket.high == 0 ? -1 : bracket.low) : 1;
    for (int sample = 0; sample <= clear * kSamples; ++sample) {
      if (verdict.decision == Decision::undecided) break;
      ASSERT_FALSE(touch_at(a, b, static_cast<double>(sample) / kSamples)) << "sweep " << i << " at " << sample;
    }
  }
  std::printf("%d sweeps, %d hits, %d undecided, %d grazes, widest bracket %.3g\n", sweeps, hits, undecided, grazes,
              widest);
  EXPECT_GT(hits, sweeps / 8);
  EXPECT_GT(misses, sweeps / 5);
  EXPECT_EQ(undecided, 0);
  EXPECT_LE(grazes, sweeps / 5'000);
  EXPECT_LE(widest, 1e-4);
}

// An arm swings a ball past the lid of a box, a few roundings above or below, a thousand kilometres out.
TEST(ExactBodyMotion, WhatIsFreeMeetsNothingAtAnyFrameOfTheWay) {
  std::mt19937_64 generator = oracle::seeded(402);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int free = 0, met = 0;
  for (int i = 0; i < 400; ++i) {
    const double far_m = std::exp2(20 * (1 + uniform(generator)));
    const Vec3 hub(far_m * uniform(generator), far_m * uniform(generator), far_m * uniform(generator));
    const double half_turn = 0.5 + 0.4 * uniform(generator);
    const auto turned = [&](double angle) { return frame_of({hub, Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()))}); };
    const BodyMotion motion(turned(M_PI / 2 - half_turn), turned(M_PI / 2 + half_turn));
    const PartMotion ball(Sphere{{1, 0, 0}, 0.25}, motion);
    const double gap = uniform(generator) * std::exp2(-46 + 4 * uniform(generator)) * far_m;
    const BodyMotion rest;
    const PartMotion lid(Box{.center = hub + Vec3(0, 2.25 + gap, 0), .half_m = {1, 1, 1}}, rest);
    TimeBracket bracket;
    const ExactResult verdict = first_contact(ball, lid, {0, 1}, 1e-9, bracket);
    met += verdict.yes();
    if (verdict.decision != Decision::no) continue;
    ++free;
    for (int sample = -500; sample <= 500; ++sample) {
      const double t = 0.5 + sample * 1e-10;
      ASSERT_FALSE(touch_at(ball, lid, t)) << i << " " << gap << " " << far_m;
    }
  }
  std::printf("%d free, %d met of 400\n", free, met);
  EXPECT_GT(met, 20);
  EXPECT_GT(free, 20);
}

// What goes straight past a triangle has an exact answer of its own.
TEST(ExactBodyMotion, StraightWaysAgreeWithTheExactTimes) {
  std::mt19937_64 generator = oracle::seeded(403);
  Sweeps make(generator);
  RandomShapes shapes(generator, Family::random);
  int hits = 0;
  for (int i = 0; i < 600; ++i) {
    const Frame from{Mat3::Identity(), Vec3::Zero()};
    const Frame to{Mat3::Identity(), Vec3(make.number(), make.number(), make.number()) * 4};
    const BodyMotion motion(from, to);
    const BodyMotion rest;
    const Triangle other = shapes.triangle();
    const PartMotion resting(other, rest);
    TimeBracket exact, found;
    ExactResult truth, verdict;
    if (i % 3 == 0) {
      const Box own = shapes.box();
      truth = first_contact(Translated<Box>{own, from.position, to.position}, other, 1e-9, exact);
      verdict = first_contact(PartMotion(own, motion), resting, {0, 1}, 1e-9, found);
    } else if (i % 3 == 1) {
      const Capsule own = shapes.capsule();
      truth = first_contact(Translated<Capsule>{own, from.position, to.position}, other, 1e-9, exact);
      verdict = first_contact(PartMotion(own, motion), resting, {0, 1}, 1e-9, found);
    } else {
      const Triangle own = shapes.triangle();
      const Vec3& d = to.position;
      truth = first_contact(MovingTriangle{{own.a, own.a + d}, {own.b, own.b + d}, {own.c, own.c + d}},
                            MovingTriangle{{other.a, other.a}, {other.b, other.b}, {other.c, other.c}}, 1e-9, exact);
      verdict = first_contact(PartMotion(own, motion), resting, {0, 1}, 1e-9, found);
    }
    ASSERT_EQ(verdict.decision, truth.decision) << i;
    if (!truth.yes()) continue;
    ++hits;
    ASSERT_LE(found.low, exact.high + 1e-14);
    ASSERT_GE(found.high + 1e-14, exact.low);
  }
  EXPECT_GT(hits, 100);
}

TEST(ExactBodyMotion, TheSpanIsRespectedAndATouchingStartIsItsOwnBracket) {
  const BodyMotion motion(Frame{}, {Mat3::Identity(), {8, 0, 0}});
  const BodyMotion rest;
  const PartMotion cube(Box{.center = Vec3::Zero(), .half_m = {1, 1, 1}}, motion);
  const PartMotion post(Cylinder{{5, 0, -4}, {5, 0, 4}, 0.5}, rest);
  TimeBracket bracket;
  ASSERT_TRUE(first_contact(cube, post, {0, 1}, 1e-9, bracket).yes());
  EXPECT_LE(bracket.low, 3.5 / 8);
  EXPECT_GE(bracket.high, 3.5 / 8);
  EXPECT_LE(bracket.high - bracket.low, 1e-9);
  EXPECT_EQ(first_contact(cube, post, {0, 0.4375 - 1e-6}, 1e-9, bracket).decision, Decision::no);
  ASSERT_TRUE(first_contact(cube, post, {0.5, 1}, 1e-9, bracket).yes());
  EXPECT_EQ(bracket.low, 0.5);
  EXPECT_EQ(bracket.high, 0.5);
}

// A wheel that turns a hundredth of its radius above the ground and nearer: each step of a bound by the speed of its points
// would be tiny, but the wheel as a whole stays where it is.
TEST(ExactBodyMotion, ATurningWheelNearTheGroundIsFree) {
  const Mat3 turned = Eigen::AngleAxisd(3, Vec3::UnitY()).toRotationMatrix();
  const BodyMotion motion(Frame{}, {turned, {1, 0, 0}});
  const BodyMotion rest;
  const PartMotion wheel(Cylinder{{0, -0.1, 0}, {0, 0.1, 0}, 0.3}, motion);
  for (const double gap : {1e-2, 1e-3, 1e-5, 1e-8, 1e-12}) {
    const PartMotion ground(Box{.center = {0, 0, -1.3 - gap}, .half_m = {9, 9, 1}}, rest);
    TimeBracket bracket;
    EXPECT_EQ(first_contact(wheel, ground, {0, 1}, 1e-6, bracket).decision, Decision::no) << gap;
  }
}

// Barrels that lean and roll on, balls off their hub: what of them the rotation does not move may not hide what it does.
TEST(ExactBodyMotion, ARollingSolidTouchesTheGroundWhereItsLowestPointDoes) {
  std::mt19937_64 generator = oracle::seeded(404);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int free = 0, met = 0;
  for (int i = 0; i < 600; ++i) {
    // A hundredth of a radian off the axis of the rotation, or anywhere.
    const double off = i % 2 == 0 ? 0.01 : 1;
    const Vec3 along(off * uniform(generator), 0.5, off * uniform(generator));
    const Vec3 hub = Vec3(uniform(generator), uniform(generator), uniform(generator)) * (i % 4 == 0 ? 0.1 : 0);
    const BoundedPart part = i % 3 == 0   ? BoundedPart(Cylinder{hub - along, hub + along, 0.5})
                             : i % 3 == 1 ? BoundedPart(Cone{hub - along, hub + along, 0.5})
                                          : BoundedPart(Capsule{hub, hub + along * off, 0.25});
    const Frame from = frame_of({Vec3::Zero(), Quat(Eigen::AngleAxisd(3 * uniform(generator), Vec3::UnitY()))});
    const Frame to{
        Eigen::AngleAxisd(1 + 2 * std::abs(uniform(generator)), Vec3::UnitY()).toRotationMatrix() * from.rotation,
        {1, 0, 0}};
    const BodyMotion motion(from, to);
    const PartMotion mover(part, motion);
    double lowest = std::numeric_limits<double>::infinity();
    constexpr int kSamples = 1500;
    for (int k = 0; k <= kSamples; ++k) {
      const BoundedPart at = mover.at(static_cast<double>(k) / kSamples);
      lowest = std::min(lowest, std::visit([](const auto& shape) { return bounds(shape).low.z(); }, at));
    }
    // Samples are two thousandths of a radian apart: the lowest place is missed by less than a millionth of a metre.
    const double gap = (i % 5 == 0 ? -1 : 1) * 1e-5;
    const BodyMotion rest;
    const PartMotion ground(Box{.center = {0, 0, lowest - gap - 1}, .half_m = {9, 9, 1}}, rest);
    TimeBracket bracket;
    const ExactResult verdict = first_contact(mover, ground, {0, 1}, 1e-6, bracket);
    ASSERT_EQ(verdict.decision, gap < 0 ? Decision::yes : Decision::no) << i;
    ++(gap < 0 ? met : free);
  }
  EXPECT_EQ(met, 120);
  EXPECT_EQ(free, 480);
}

// By differences of places in between: a body that turns and goes, and a point whose time is known to a hundredth of the way.
TEST(BodyMotion, TheVelocityOfAPointIsWithinItsBound) {
  std::mt19937_64 random = oracle::seeded(14);
  std::uniform_real_distribution<double> part(-1, 1);
  const auto vector = [&] { return Vec3(part(random), part(random), part(random)); };
  for (int i = 0; i < 2'000; ++i) {
    const Frame from{Eigen::AngleAxisd(3 * part(random), vector().normalized()).toRotationMatrix(), 10 * vector()};
    const Frame to{
        Mat3(Eigen::AngleAxisd(1.5 * part(random), vector().normalized()).toRotationMatrix() * from.rotation),
        from.position + vector()};
    const BodyMotion motion(from, to);
    const double time = 0.2 + 0.3 * (1 + part(random)), motion_s = 0.01;
    const Vec3 own = vector();
    const Vec3 told_at = place(motion.at(time), own);
    const double slack = i % 2 == 0 ? 0 : 0.01;
    const BodyMotion::PointVelocity velocity = motion.velocity(told_at, time, motion_s, slack * motion_s);
    for (const double off : {-1.0, 0.0, 1.0}) {
      // The same point of space at another time within the slack: another point of the body is there.
      const double then = time + off * slack;
      constexpr double kStep = 1e-4;
      const Frame at = motion.at(then);
      const Vec3 body_point = at.rotation.transpose() * (told_at - at.position);
      const Vec3 truth = (place(motion.at(then + kStep), body_point) - place(motion.at(then - kStep), body_point)) /
                         (2 * kStep * motion_s);
      // The differences are off by a square of their step, and by the roundings of places over it.
      const double differences = 20 * kStep * kStep / motion_s + 1e-13 / (kStep * motion_s);
      ASSERT_LE((velocity.mps - truth).norm(), velocity.error_mps + differences) << i;
    }
    if (slack == 0) {
      EXPECT_LE(velocity.error_mps, 1e-10) << "a bound that tells nothing";
    } else {
      EXPECT_LE(velocity.error_mps, 0.03 * 3 * 6 / motion_s) << i;
    }
  }
}

}  // namespace
}  // namespace collided::engine::body_motion_test
