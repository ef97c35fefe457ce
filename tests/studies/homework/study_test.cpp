#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <unistd.h>

#include "tests/studies/homework/homework_page.hpp"
#include "tests/studies/report/page/provenance.hpp"

namespace collided::homework {
using namespace engine;
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

void expect_from_to(const std::vector<double>& places, double first, double last) {
  ASSERT_GE(places.size(), 7u);
  EXPECT_EQ(places.front(), first);
  EXPECT_EQ(places.back(), last);
  EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
}

// B12, B13, B14: the ranges of the homework, 1 to 50 objects among them, and on to 100,000; what is not swept stands at
// 20 objects of 256 polygons and a relative size of 0.2. Times, repeats and pairs: the next test.
TEST(HomeworkStudy, SweepsTheRangesOfTheHomework) {
  expect_from_to(places_of(Sweep::objects, false), 1, 100'000);
  expect_from_to(places_of(Sweep::polygons, false), 16, 100'000);
  expect_from_to(places_of(Sweep::size, false), 0.05, 0.5);
  const std::vector<double> objects = places_of(Sweep::objects, false);
  EXPECT_GE(std::count_if(objects.begin(), objects.end(), [](double x) { return x <= 50; }), 7);
  for (const double x : objects) {
    const Problem problem = problem_at(Sweep::objects, x, 1, false);
    EXPECT_EQ(problem.objects, static_cast<std::size_t>(x));
    EXPECT_EQ(problem.polygons, 256u);
    EXPECT_TRUE(x > 50 || problem.relative_size == 0.2);
  }
  for (const double x : places_of(Sweep::polygons, false)) {
    const Problem problem = problem_at(Sweep::polygons, x, 1, false);
    EXPECT_EQ(problem.polygons, static_cast<std::size_t>(x));
    EXPECT_EQ(problem.objects, 20u);
    EXPECT_EQ(problem.relative_size, 0.2);
  }
  for (const double x : places_of(Sweep::size, false)) {
    const Problem problem = problem_at(Sweep::size, x, 1, false);
    EXPECT_EQ(problem.relative_size, x);
    EXPECT_EQ(problem.objects, 20u);
    EXPECT_EQ(problem.polygons, 256u);
  }
}

// B12, B13, B14, B20: every pair that one method has and another has not is somebody's error, and never ours.
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

Point made_up(Sweep sweep, double x, const std::string& method, double us) {
  Point point;
  point.sweep = sweep;
  point.x = x;
  point.polygons = sweep == Sweep::polygons ? static_cast<std::size_t>(x) : 256;
  point.method = method;
  point.repeats = 20;
  point.median_us = point.p95_us = point.mean_us = us;
  point.contacts = 1;
  point.candidates = 2;
  return point;
}

/// Exponents: objects, polygons, size below 0.2 and above.
void add_method(std::vector<Point>& points, const std::string& method, double objects, double polygons, double small,
                double large) {
  for (const double n : {1, 5, 20, 50}) points.push_back(made_up(Sweep::objects, n, method, std::pow(n, objects)));
  for (const double n : {16, 64, 256, 1024})
    points.push_back(made_up(Sweep::polygons, n, method, std::pow(n, polygons)));
  for (const double size : {0.05, 0.1, 0.2})
    points.push_back(made_up(Sweep::size, size, method, std::pow(size / 0.2, small)));
  for (const double size : {0.3, 0.5})
    points.push_back(made_up(Sweep::size, size, method, std::pow(size / 0.2, large)));
}

// B15, B21: verdicts follow from exponents, both ways.
TEST(HomeworkClaims, AreTrueOrFalseAsTheExponentsSay) {
  std::vector<Point> points;
  add_method(points, "Collided, all polygons", 1, 0.2, 1, 3);
  add_method(points, "simple prototype", 2, 2.5, 3, 1);
  std::map<std::string, std::string> verdict;
  for (const Claim& claim : claims(points)) verdict[claim.text + "/" + claim.method] = claim.verdict;
  EXPECT_EQ(verdict["more objects take more time (1 to 50)/simple prototype"], "true");
  EXPECT_EQ(verdict["polygons matter less than objects/Collided, all polygons"], "true");
  EXPECT_EQ(verdict["polygons matter less than objects/simple prototype"], "false");
  EXPECT_EQ(verdict["size bites from 0.2 on/Collided, all polygons"], "true");
  EXPECT_EQ(verdict["size bites from 0.2 on/simple prototype"], "false");
  EXPECT_EQ(verdict["V-COLLIDE grows more slowly than the simple prototype: objects/Collided, all polygons"], "true");
  EXPECT_EQ(verdict["V-COLLIDE grows more slowly than the simple prototype: polygons/Collided, all polygons"], "true");
  EXPECT_EQ(verdict["V-COLLIDE grows more slowly than the simple prototype: size/Collided, all polygons"],
            "not decided");
}

// B11: a figure without its machine, build, commit and seed cannot be judged.
TEST(HomeworkPage, EveryFigureSaysWhereItComesFrom) {
  std::vector<Point> points;
  add_method(points, "Collided", 1, 0.2, 1, 3);
  const report::Provenance from{.machine = "a machine", .commit = "c0ffee", .command = "homework_study", .seed = 2000};
  const auto file =
      std::filesystem::temp_directory_path() / ("collided_homework_" + std::to_string(::getpid()) + ".csv");
  write_points(file, points, from);
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  EXPECT_TRUE(line.ends_with("seed,machine,build,commit")) << line;
  std::size_t lines = 0;
  while (std::getline(in, line)) {
    ++lines;
    EXPECT_NE(line.find("\"a machine\",\""), std::string::npos) << line;
    EXPECT_NE(line.find("-ffp-contract=off"), std::string::npos) << "the flags of the build: " << line;
    EXPECT_TRUE(line.ends_with(",c0ffee")) << line;
  }
  std::filesystem::remove(file);
  EXPECT_EQ(lines, points.size());
  bool has_environment = false;
  for (const report::Figure& figure : homework_figures(points, measure_parts(1, true), from, "/nonexistent")) {
    has_environment = has_environment || (figure.body.find("a machine") != std::string::npos &&
                                          figure.body.find("c0ffee") != std::string::npos);
  }
  EXPECT_TRUE(has_environment);
  EXPECT_NE(report::machine().find("core"), std::string::npos) << report::machine();
}

// A42: detection, determination and response are asked for apart, and each has a time. B20: a curve for each sweep. B22: the page says that the homework's own figures have no values.
TEST(HomeworkPage, HasADrawingForEverySweepAndSaysWhatIsLost) {
  std::vector<Point> points;
  add_method(points, "Collided", 1, 0.2, 1, 3);
  const Parts parts = measure_parts(1, true);
  EXPECT_GT(parts.detection_us, 0);
  EXPECT_GT(parts.response_us, 0);
  int drawings = 0;
  bool lost = false;
  for (const report::Figure& figure : homework_figures(points, parts, {}, "/nonexistent")) {
    EXPECT_EQ(figure.body.find("nan"), std::string::npos) << figure.id;
    if (figure.body.find("<svg") != std::string::npos) ++drawings;
    lost = lost || figure.body.find("no values in its figures 2 to 7") != std::string::npos;
  }
  EXPECT_EQ(drawings, 4);
  EXPECT_TRUE(lost);
}

}  // namespace
}  // namespace collided::homework
