#include <gtest/gtest.h>

#include "tests/homework/study.hpp"

namespace collided::homework {
namespace {

TEST(HomeworkSlope, FindsAnExponentAndHowSureItIs) {
  std::vector<double> x, exact, rough;
  for (int i = 1; i <= 8; ++i) {
    x.push_back(i);
    exact.push_back(3 * i * i);
    rough.push_back(3 * i * i * (i % 2 == 0 ? 1.2 : 1 / 1.2));
  }
  EXPECT_NEAR(fit(x, exact).exponent, 2, 1e-12);
  EXPECT_NEAR(fit(x, exact).half, 0, 1e-6);
  const Slope slope = fit(x, rough);
  EXPECT_GT(slope.half, 0.1);
  EXPECT_LT(slope.low(), 2);
  EXPECT_GT(slope.high(), 2);
  EXPECT_FALSE(fit({1, 2}, {1, 2}).known());
}

// B6, B7: same problem, same bits; another seed, others.
TEST(HomeworkRecording, IsTheSameForTheSameSeed) {
  const Problem problem{.objects = 12, .polygons = 64, .frames = 20, .seed = 3};
  const Recording one = record(problem), two = record(problem);
  Problem other = problem;
  other.seed = 4;
  const Recording third = record(other);
  bool differs = false;
  for (std::size_t f = 0; f < one.poses.size(); ++f) {
    for (std::size_t i = 0; i < 12; ++i) {
      EXPECT_EQ(one.poses[f][i].position, two.poses[f][i].position);
      EXPECT_EQ(one.poses[f][i].rotation.coeffs(), two.poses[f][i].rotation.coeffs());
      differs = differs || one.poses[f][i].position != third.poses[f][i].position;
    }
  }
  EXPECT_TRUE(differs);
}

// B20: every pair that one method has and another has not is somebody's error, and never ours.
TEST(HomeworkStudy, ShortFormFindsTheSamePairsByEveryMethod) {
  const std::vector<Point> points =
      run_study({.seed = 2000, .quick = true, .methods = {collided_world, collided_polygons, simple_prototype}});
  double contacts = 0;
  for (const Point& point : points) {
    EXPECT_EQ(point.first_wrong, 0u) << name(point.sweep) << " " << point.x << " " << point.method;
    EXPECT_EQ(point.wrong, 0u) << name(point.sweep) << " " << point.x << " " << point.method;
    EXPECT_GE(point.repeats, 20u);
    EXPECT_GE(point.p95_us, point.median_us);
    EXPECT_GE(point.candidates, point.contacts);
    contacts += point.contacts;
  }
  EXPECT_GE(points.size(), 18u);
  EXPECT_GT(contacts, 10);
}

// The judge itself: a pair withheld and a pair invented are both found out.
TEST(HomeworkStudy, TheJudgeKnowsWhoIsWrong) {
  const Recording recording = record({.objects = 20, .polygons = 64, .relative_size = 0.4, .frames = 1, .seed = 1});
  CollidedWorld world(recording);
  world.frame(recording.poses[0]);
  const ObjectPairs truth = world.pairs();
  ASSERT_GT(truth.size(), 2u);
  ObjectPairs lacking(truth.begin() + 1, truth.end());
  EXPECT_EQ(judge(recording, recording.poses[0], truth, lacking).wrong, 1u);
  EXPECT_EQ(judge(recording, recording.poses[0], lacking, truth).first_wrong, 1u);
  ObjectPairs all;
  for (std::uint32_t i = 0; i < 20; ++i) {
    for (std::uint32_t j = i + 1; j < 20; ++j) all.push_back({i, j});
  }
  EXPECT_EQ(judge(recording, recording.poses[0], truth, all).wrong, all.size() - truth.size());
}

}  // namespace
}  // namespace collided::homework
