// Sweeps of and against shapes with a pose: decided for the shapes and poses as given, where double has placed them up to a
// rounding elsewhere. The truth is worked out by rationals.
#include <gtest/gtest.h>

#include <random>

#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/motion/ground_motion.hpp"
#include "server/exact_phase/motion/part_motion.hpp"
#include "tests/oracle/plane_reach.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::given_sweep_test {
namespace {

using namespace oracle;

constexpr double kWidth = 1e-9;

class GivenSweep : public testing::Test {
 protected:
  double unit() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 vector(double size) { return size * Vec3(unit(), unit(), unit()); }
  Vec3 direction() { return vector(1).normalized(); }
  Pose pose() {
    const double far_m = std::pow(10, 2 * std::abs(unit()));
    return {.position = vector(far_m), .rotation = Quat(unit(), unit(), unit(), unit()).normalized()};
  }

  struct Mover {
    BoundedPart own;
    Pose from;
    Pose to;
  };

  /// Asks for the parts as given; counts those whose placed ones have another answer.
  ExactResult ask(const Mover& mover, const BoundedPart& other, const Pose& at, TimeBracket& bracket) {
    BodyMotion motion(frame_of(mover.from), frame_of(mover.to));
    BodyMotion rest = BodyMotion::resting(frame_of(at));
    const Decision placed = first_contact({mover.own, motion}, {other, rest}, {}, kWidth, bracket).decision;
    motion.given = &mover.from;
    rest.given = &at;
    const ExactResult verdict = first_contact({mover.own, motion}, {other, rest}, {}, kWidth, bracket);
    turned_ += placed != verdict.decision;
    TimeBracket reverse;
    EXPECT_EQ(first_contact({other, rest}, {mover.own, motion}, {}, kWidth, reverse).decision, verdict.decision);
    return verdict;
  }

  /// Against the twin, at the end of the way and at both ends of the bracket.
  void check(const Mover& mover, const BoundedPart& other, const Pose& at) {
    const Figure target = placed_figure(other, at);
    const Figure start = placed_figure(mover.own, mover.from);
    const Point way = minus(exact(mover.to.position), exact(mover.from.position));
    const auto is_met_by = [&](double t) { return overlaps(swept(start, times(Rational(t), way)), target); };
    TimeBracket bracket;
    const ExactResult verdict = ask(mover, other, at, bracket);
    ASSERT_EQ(verdict.decision, is_met_by(1) ? Decision::yes : Decision::no)
        << "kind " << mover.own.index() << " against " << other.index();
    if (!verdict.yes()) return;
    ++met_;
    ASSERT_LE(bracket.high - bracket.low, kWidth);
    ASSERT_TRUE(is_met_by(bracket.high));
    ASSERT_TRUE(bracket.low == 0 || !is_met_by(bracket.low));
  }

  static ConvexPart in_world(const BoundedPart& own, const Pose& pose) {
    const BodyMotion rest = BodyMotion::resting(frame_of(pose));
    return PartMotion(own, rest).placed_at(0);
  }

  /// A way on which the two, as placed, come to touch: at its end, or in its middle while they pass each other.
  Mover touching(const BoundedPart& own, const BoundedPart& other, const Pose& at, bool passes) {
    const Pose start{.position = at.position + 9 * direction(),
                     .rotation = Quat(unit(), unit(), unit(), unit()).normalized()};
    const ConvexPart resting = in_world(other, at);
    const Separation apart = separation(in_world(own, start), resting);
    Pose there = start;
    // To the last place in double at which the placed ones are apart, or the next one.
    double short_m = apart.distance_m * (1 - 1e-9);
    double far_m = apart.distance_m * (1 + 1e-9);
    for (double middle_m = apart.distance_m; short_m < middle_m && middle_m < far_m;
         middle_m = short_m + (far_m - short_m) / 2) {
      there.position = start.position + middle_m * apart.normal;
      (overlaps(in_world(own, there), resting).yes() ? far_m : short_m) = middle_m;
    }
    const Vec3 touch = start.position + (unit() < 0 ? short_m : far_m) * apart.normal;
    const Vec3 along = apart.normal.cross(direction());
    Mover mover{own, start, start};
    mover.from.position = passes ? Vec3(touch - 2 * along) : Vec3(touch - 2 * apart.normal + along);
    mover.to.position = passes ? Vec3(touch + 2 * along) : touch;
    return mover;
  }

  static Figure placed_figure(const BoundedPart& own, const Pose& at) {
    return std::visit(
        [&](const auto& shape) {
          if constexpr (requires { figure(shape); }) return placed(figure(shape), at);
          else return Figure{};
        },
        own);
  }

  std::mt19937_64 random_ = seeded(491);
  int turned_ = 0;  // answers that are others for the shapes as given than for the placed ones
  int met_ = 0;
};

TEST_F(GivenSweep, BallsAgreeWithRationals) {
  RandomShapes shapes(random_, Family::random);
  for (int i = 0; i < 600; ++i) {
    const BoundedPart others[] = {shapes.sphere(), shapes.box(), shapes.capsule(), shapes.triangle()};
    const BoundedPart& other = others[i % 4];
    const Pose at = pose();
    check(touching(shapes.sphere(), other, at, i % 8 < 4), other, at);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(met_, 150);
  EXPECT_LT(met_, 450);
  EXPECT_GT(turned_, 40);
}

TEST_F(GivenSweep, BoxesAndCapsulesAgreeWithRationals) {
  RandomShapes shapes(random_, Family::random);
  for (int i = 0; i < 60; ++i) {
    const BoundedPart others[] = {shapes.sphere(), shapes.capsule(), shapes.triangle()};
    const BoundedPart& other = others[i % 3];
    const Pose at = pose();
    const BoundedPart own = i % 2 == 0 ? BoundedPart(shapes.box()) : BoundedPart(shapes.capsule());
    check(touching(own, other, at, i % 4 < 2), other, at);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(met_, 10);
  EXPECT_LT(met_, 50);
  EXPECT_GT(turned_, 2);
}

/// Of a solid in its own frame against a plane in the world: `up` and `height` as in up . x = height.
bool reaches_plane(const Primitive& own, const Pose& pose, const Point& up, const Rational& height) {
  const Point down = times(-1, turned_back(pose.rotation, up));
  return reaches_past(own, down, Rational(dot(up, exact(pose.position)) - height)) >= 0;
}

/// Every kind of solid that comes to a wide face, and the face to it.
TEST_F(GivenSweep, EveryKindComesToAFaceAsGiven) {
  int yes = 0;
  int no = 0;
  RandomShapes shapes(random_, Family::random);
  for (int i = 0; i < 350; ++i) {
    const Primitive own = shapes.solid(i % 7);
    Mover mover{part_of(own), pose(), {}};
    const Vec3 n = direction();
    const Vec3 foot = lowest(place(frame_of(mover.from), own), n);
    const auto [u, v] = across(n);
    // The face of a pose of its own; its plane is that of the corners as the pose has them.
    const Pose at = pose();
    const Quat back = at.rotation.conjugate();
    const auto seen = [&](const Vec3& p) { return Vec3(back * (p - at.position)); };
    const Triangle face{seen(foot + 40 * u), seen(foot - 40 * u + 40 * v), seen(foot - 40 * u - 40 * v)};
    const BoundedPart others[] = {face, std::get<Hull>(tetrahedron(face, back * n, seen(foot - 5 * n)))};
    const Point corner = exact(face.a);
    Point up = turned(at.rotation, cross(minus(exact(face.b), corner), minus(exact(face.c), corner)));
    if (dot(up, exact(n)) < 0) up = times(-1, up);
    const Rational height = dot(up, plus(turned(at.rotation, corner), exact(at.position)));
    mover.to = mover.from;
    mover.from.position += 3 * n + 0.7 * direction();
    for (const BoundedPart& other : others) {
      const bool truth = reaches_plane(own, mover.to, up, height);
      TimeBracket bracket;
      const ExactResult verdict = ask(mover, other, at, bracket);
      ASSERT_EQ(verdict.decision, truth ? Decision::yes : Decision::no) << "kind " << i % 7 << ", " << other.index();
      ++(truth ? yes : no);
      // The face on its way to the solid: the same motion of one against the other.
      const Vec3 way = mover.to.position - mover.from.position;
      const Mover face_mover{other, {Vec3(at.position + way), at.rotation}, at};
      TimeBracket of_face;
      ASSERT_EQ(ask(face_mover, mover.own, mover.to, of_face).decision, verdict.decision) << "kind " << i % 7;
      if (truth) {
        Pose then = mover.from;
        const auto reached_at = [&](double t) {
          const Point place = plus(exact(mover.from.position),
                                   times(Rational(t), minus(exact(mover.to.position), exact(mover.from.position))));
          then.position.setZero();
          return reaches_plane(own, then, up, Rational(height - dot(up, place)));
        };
        ASSERT_LE(bracket.high - bracket.low, kWidth);
        ASSERT_TRUE(reached_at(bracket.high));
        ASSERT_TRUE(bracket.low == 0 || !reached_at(bracket.low));
      }
    }
  }
  std::printf("%d reach, %d do not; %d others as placed\n", yes, no, turned_);
  EXPECT_GT(yes, 150);
  EXPECT_GT(no, 150);
  EXPECT_GT(turned_, 100);
}

/// A ball or capsule, whose border is smooth, that comes straight in is nearest to a solid in its last place.
TEST_F(GivenSweep, ABallOrCapsuleStopsBesideASolidAsGiven) {
  RandomShapes shapes(random_, Family::random);
  int left_open = 0;
  for (int i = 0; i < 1'000; ++i) {
    const Primitive solid = shapes.solid(3 + i % 4);
    const Primitive own = shapes.solid(i / 4 % 5 == 0 ? 2 : 0);
    const BoundedPart other = part_of(solid);
    const Pose at = pose();
    const Mover mover = touching(part_of(own), other, at, false);
    const GivenPart given_own{.own = &own, .pose = &mover.to, .frame = nullptr};
    const GivenPart given_solid{.own = &solid, .pose = &at, .frame = nullptr};
    const Decision truth =
        overlaps_as_given(place(frame_of(mover.to), own), place(frame_of(at), solid), {given_own, given_solid});
    if (truth == Decision::undecided) {
      ++left_open;
      continue;
    }
    TimeBracket bracket;
    ASSERT_EQ(ask(mover, other, at, bracket).decision, truth) << own.index() << " against " << solid.index();
    met_ += truth == Decision::yes;
  }
  EXPECT_LT(left_open, 10);  // capsules against the side of a cone
  EXPECT_GT(met_, 250);
  EXPECT_LT(met_, 750);
  EXPECT_GT(turned_, 100);
}

TEST_F(GivenSweep, AHalfSpaceIsComeToAsGiven) {
  RandomShapes shapes(random_, Family::random);
  for (int i = 0; i < 700; ++i) {
    const Primitive own = shapes.solid(i % 7);
    Mover mover{part_of(own), pose(), {}};
    mover.to = mover.from;
    const Pose at = pose();
    const Primitive ground = HalfSpace{vector(1), direction()};
    const Frame frame = frame_of(at);
    const HalfSpace placed_ground = place(frame, std::get<HalfSpace>(ground));
    const Vec3 foot = lowest(place(frame_of(mover.to), own), placed_ground.normal);
    mover.to.position -= placed_ground.normal * placed_ground.normal.dot(foot - placed_ground.point);
    mover.from.position = mover.to.position + 3 * placed_ground.normal + 0.7 * direction();
    const Point up = turned(at.rotation, exact(std::get<HalfSpace>(ground).normal));
    const Point corner = plus(turned(at.rotation, exact(std::get<HalfSpace>(ground).point)), exact(at.position));
    const bool truth = reaches_plane(own, mover.to, up, dot(up, corner));
    BodyMotion motion(frame_of(mover.from), frame_of(mover.to));
    TimeBracket bracket;
    const Decision placed = first_contact({mover.own, motion}, placed_ground, {}, kWidth, bracket).decision;
    motion.given = &mover.from;
    const GivenPart given{.own = &ground, .pose = &at, .frame = &frame};
    const Decision found = first_contact({mover.own, motion}, placed_ground, {}, kWidth, bracket, given).decision;
    ASSERT_EQ(found, truth ? Decision::yes : Decision::no) << "kind " << i % 7;
    turned_ += placed != found;
    met_ += truth;
  }
  EXPECT_GT(met_, 200);
  EXPECT_LT(met_, 500);
  EXPECT_GT(turned_, 100);
}

}  // namespace
}  // namespace collided::engine::given_sweep_test
