// Posed shapes that touch, or miss each other, by less than their placing rounds: yes and no are those for the shape and
// the pose that were given, for questions and for contacts alike.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "server/exact_phase/exactly.hpp"
#include "server/world/query/pair_report.hpp"
#include "tests/extreme/world/given_pairs.hpp"
#include "tests/oracle/exact_oracle.hpp"

namespace collided::engine::given_numbers_test {
namespace {

using oracle::Figure;
using oracle::Rational;

oracle::Point turned(const Quat& q, const oracle::Point& v) {
  const Rational w(q.w());
  const oracle::Point u{Rational(q.x()), Rational(q.y()), Rational(q.z())};
  const Rational uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
  const Rational uv = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  oracle::Point result;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    result[i] = ((w * w - uu) * v[i] + 2 * uv * u[i] + 2 * w * (u[j] * v[k] - u[k] * v[j])) / (w * w + uu);
  }
  return result;
}

/// The figure where the pose puts it, in rationals.
Figure posed(Figure own, const Pose& pose) {
  for (oracle::Face& face : own.faces) {
    face.origin = turned(pose.rotation, face.origin);
    for (std::size_t i = 0; i < 3; ++i) face.origin[i] += Rational(pose.position[static_cast<Eigen::Index>(i)]);
    for (oracle::Point& direction : face.directions) direction = turned(pose.rotation, direction);
  }
  return own;
}

/// A shape of one part whose oracle takes rationals.
struct FlatSample : GivenSample {
  Figure figure;
};

class ExtremeGivenNumbers : public GivenPairs {
 protected:
  template <class Solid>
  static FlatSample figured(const char* name, const Solid& own) {
    return {solid(name, own), oracle::figure(own)};
  }
  FlatSample sample(int kind) {
    switch (kind) {
      case 0: return figured("sphere", Sphere{point(1), any(0.1, 1)});
      case 1: return figured("box", Box{.center = point(1), .half_m = {any(0.1, 1), any(0.1, 1), any(0.1, 1)}});
      case 2: return figured("capsule", Capsule{point(1), point(1), any(0.1, 0.5)});
      default: {
        const Triangle own{point(1), point(1), point(1)};
        return {triangle(own), oracle::figure(own)};
      }
    }
  }
};

int pairs_asked() {
  const char* asked = std::getenv("COLLIDED_PAIRS");
  return asked != nullptr ? std::atoi(asked) : 160;
}

TEST_F(ExtremeGivenNumbers, APairIsDecidedForTheShapesAndPosesGiven) {
  int touching = 0;
  int apart = 0;
  int otherwise_as_placed = 0;
  const int pairs = pairs_asked();
  for (int i = 0; i < pairs; ++i) {
    const FlatSample a = sample(i % 4);
    const FlatSample b = sample(i / 4 % 4);
    const Pose a_pose = pose(std::pow(10.0, 3.0 * (i / 16 % 4)) - 1);
    Pose b_pose = pose(a_pose.position[0]);
    bring_together(a, a_pose, b, b_pose);
    const Figure exact_a = posed(a.figure, a_pose);
    const Figure exact_b = posed(b.figure, b_pose);
    const Rational distance2 = oracle::squared_distance(exact_a, exact_b);
    const Rational reach = exact_a.radius + exact_b.radius;
    const bool truth = distance2 <= reach * reach;
    (truth ? touching : apart) += 1;

    extreme::Stage stage;
    const ObjectId first = stage.add("a", a.shape, a_pose);
    const ObjectId second = stage.add("b", b.shape, b_pose);
    stage.step();
    const PairReport report = report_pair(*stage.world.newest(), first, second, {});
    const std::string what = a.name + " and " + b.name + ", case " + std::to_string(i);
    ASSERT_EQ(report.touches == Decision::yes, truth) << what;
    ASSERT_NE(report.touches, Decision::undecided) << what;
    if (!truth) {
      const oracle::Wide distance = sqrt(oracle::Wide(distance2)) - oracle::Wide(reach);
      ASSERT_LE(abs(distance - oracle::Wide(report.separation.distance_m)), oracle::Wide(report.separation.error_m))
          << what;
    }
    ASSERT_EQ(stage.world.contacts().size(), truth ? 1U : 0U) << what << ": the step says otherwise than the question";
    const auto placed = [](const ConvexPart& part, const Pose& pose) {
      return std::visit([&](const auto& own) -> ConvexPart { return place(frame_of(pose), own); }, part);
    };
    otherwise_as_placed += overlaps(placed(a.part, a_pose), placed(b.part, b_pose)).yes() != truth ? 1 : 0;
  }
  std::printf("%d pairs: %d touching, %d apart, %d of them decided otherwise as placed\n", pairs, touching, apart,
              otherwise_as_placed);
  EXPECT_GT(touching, pairs / 6);
  EXPECT_GT(apart, pairs / 6);
  EXPECT_GT(otherwise_as_placed, pairs / 10) << "the cases would pass without the given numbers";
}

/// A turned box asked about a ball that was placed where they touch.
TEST_F(ExtremeGivenNumbers, ATurnedBoxQuestionIsDecidedForItsOwnNumbers) {
  int differing = 0;
  for (int i = 0; i < 400; ++i) {
    const Pose asked = pose(i % 2 == 0 ? 0 : 1e6);
    const Vec3 half(any(0.1, 1), any(0.1, 1), any(0.1, 1));
    const Box placed{.center = asked.position, .axes = frame_of(asked).rotation, .half_m = half};
    // Beyond the middle of a face, by a radius.
    const double radius_m = any(0.1, 1);
    const Vec3 center = asked.position + (half[i % 3] + radius_m) * placed.axes.col(i % 3);
    const bool truth = oracle::overlaps(posed(oracle::figure(Box{.center = Vec3::Zero(), .half_m = half}), asked),
                                        oracle::figure(Sphere{center, radius_m}));
    extreme::Stage stage;
    stage.ball("ball", center, radius_m);
    stage.step();
    const Quat& q = asked.rotation;
    const Answers answers = stage.ask(QuestionKind::box, {asked.position.x(), asked.position.y(), asked.position.z(),
                                                          half.x(), half.y(), half.z(), q.w(), q.x(), q.y(), q.z()});
    ASSERT_EQ(extreme::is_hit(answers), truth) << "case " << i;
    differing +=
        exactly::overlaps(Primitive(placed), Primitive(Sphere{center, radius_m})) == Decision::yes ? !truth : truth;
  }
  EXPECT_GT(differing, 10);
}

}  // namespace
}  // namespace collided::engine::given_numbers_test
