// What is odd but legal must be answered, not refused and not guessed: denormals, minus zero, rays without end, lengths
// of zero, the greatest coordinates.
#include <gtest/gtest.h>

#include "idl/question_rules.hpp"
#include "tests/extreme/mixed.hpp"

namespace collided::engine::odd_but_legal_test {
namespace {

constexpr double kGreatest = wire_contract::kMostCoordinate;
constexpr double kTiniest = std::numeric_limits<double>::denorm_min();

/// Numbers that a careful border accepts and careless arithmetic does not.
constexpr double kOdd[] = {0.0,        -0.0,  kTiniest, -kTiniest, 0x1p-1022, 1,         -1,
                           0x1p53 + 2, 1e150, -1e150,   1e289,     kGreatest, -kGreatest};

void fill(extreme::Stage& stage) {
  stage.ball("ball", {0, 0, 0}, 1);
  stage.ball("dot", {0, 0, 0}, 0);
  stage.ball("denormal", {kTiniest, 0, 0}, kTiniest);
  stage.ball("universe", {0, 0, 0}, 1e300);
  stage.block("box", {3, 0, 0}, {1, 1, 1});
  stage.block("plate", {-0.0, 5, 0}, {1, 0, 1});
  stage.block("far", {1e300, 1e300, -1e300}, {1e299, 1, kTiniest});
  stage.add("rod", {.primitives = {Capsule{{-1e150, 0, 0}, {1e150, 0, 0}, 0}}, .mesh = nullptr},
            extreme::at({0, 0, 9}));
  TriangleMesh odd;
  odd.vertices = {{-1, -1, -2}, {1, -1, -2}, {0, 1, -2}, {1e150, 0, 0}, {0, 1e150, 0}, {0, kTiniest, -0.0}};
  odd.triangles = {{0, 1, 2}, {2, 2, 2}, {0, 1, 1}, {3, 4, 5}, {0, 3, 5}};
  stage.load("odd", odd);
  stage.step();
}

TEST(ExtremeOddButLegal, RaysEqualTheOracle) {
  extreme::Stage stage;
  fill(stage);
  std::vector<double> rays;
  for (const double x : kOdd) {
    for (const double length : {extreme::kEndless, 0.0, kTiniest, 1.0, kGreatest}) {
      rays.insert(rays.end(), {x, 0, 0, 1, 0, -0.0, length});
      rays.insert(rays.end(), {0.25, x, 4, kTiniest, -0.0, -1, length});
      rays.insert(rays.end(), {0, 0.125, x, 0, 0, x < 0 ? kTiniest : -kTiniest, length});
      rays.insert(rays.end(), {-1, -1, -1, x == 0 ? 1 : x, 1, kGreatest, length});
    }
  }
  extreme::expect_like_brute_force(stage.world, QuestionKind::ray, rays, HitMode::closest);
  extreme::expect_like_brute_force(stage.world, QuestionKind::ray, rays, HitMode::all);
}

TEST(ExtremeOddButLegal, BallsBoxesAndDistancesEqualTheOracle) {
  extreme::Stage stage;
  fill(stage);
  std::vector<double> balls, boxes;
  for (const double x : kOdd) {
    for (const double size : {0.0, -0.0, kTiniest, 1.0, 1e150, kGreatest}) {
      balls.insert(balls.end(), {x, 0, 0, size});
      balls.insert(balls.end(), {0.5, x, -2, size});
      boxes.insert(boxes.end(), {x, 0, 0, size, 1, kTiniest, 1, 0, 0, -0.0});
      boxes.insert(boxes.end(), {0, 0, x, 1, size, size, 0.5, 0.5, 0.5, 0.5});
    }
  }
  extreme::expect_like_brute_force(stage.world, QuestionKind::sphere, balls);
  extreme::expect_like_brute_force(stage.world, QuestionKind::box, boxes);
  extreme::expect_like_brute_force(stage.world, QuestionKind::near, balls);
}

TEST(ExtremeOddButLegal, AnEndlessRayReachesTheLastDouble) {
  extreme::Stage stage;
  stage.block("edge_of_the_world", {kGreatest, 0, 0}, {0, 1, 1});
  stage.step();
  const Answers found = stage.ray({0, 0, 0}, {1, 0, 0});
  ASSERT_TRUE(extreme::is_hit(found));
  EXPECT_EQ(found.hits[0].distance_m, kGreatest);
  EXPECT_TRUE(extreme::is_hit(stage.ray({0, 0, 0}, {kTiniest, 0, 0})));
  EXPECT_TRUE(extreme::is_hit(stage.ray({0, 0, 0}, {1, 0, 0}, kGreatest)));
  EXPECT_TRUE(extreme::is_miss(stage.ray({0, 0, 0}, {1, 0, 0}, std::nextafter(kGreatest, 0))));
  EXPECT_TRUE(extreme::is_miss(stage.ray({0, 0, 0}, {-1, 0, 0})));
}

TEST(ExtremeOddButLegal, MinusZeroIsZeroToTheBit) {
  extreme::Stage plus, minus;
  for (auto* stage : {&plus, &minus}) {
    const double zero = stage == &plus ? 0.0 : -0.0;
    stage->ball("ball", {zero, zero, zero}, 1);
    stage->block("box", {4, zero, zero}, {1, 1, zero});
    stage->step();
  }
  const auto bits = [](const extreme::Stage& stage, double zero) {
    return std::pair(extreme::bits_of(stage.ray({-9, zero, zero}, {1, zero, zero}, 99, HitMode::all)).size(),
                     stage.ray({-9, zero, zero}, {1, zero, zero}, 99, HitMode::closest).hits.at(0).distance_m);
  };
  EXPECT_EQ(bits(plus, 0.0), bits(minus, -0.0));
  EXPECT_EQ(bits(plus, -0.0), bits(minus, 0.0));
  EXPECT_EQ(bits(plus, 0.0).second, 8);
}

}  // namespace
}  // namespace collided::engine::odd_but_legal_test
