// Nothing at all: no object, no triangle, no shape. Minimum over nothing, division by a count of zero, the first of an
// empty list.
#include <gtest/gtest.h>

#include "tests/extreme/mixed.hpp"

namespace collided::engine::empty_test {
namespace {

void expect_nothing(const extreme::Stage& stage) {
  EXPECT_TRUE(extreme::is_miss(stage.ray({0, 0, 0}, {1, 0, 0})));
  EXPECT_TRUE(extreme::is_miss(stage.ray({0, 0, 0}, {1, 0, 0}, 0, HitMode::all)));
  EXPECT_TRUE(extreme::is_miss(stage.ask(QuestionKind::sphere, {0, 0, 0, 1e290})));
  EXPECT_TRUE(extreme::is_miss(stage.ask(QuestionKind::box, {0, 0, 0, 1, 1, 1, 1, 0, 0, 0})));
  EXPECT_TRUE(extreme::is_miss(stage.ask(QuestionKind::near, {0, 0, 0, extreme::kEndless})));
  EXPECT_EQ(stage.ask(QuestionKind::ray, {}).answers.size(), 0u);
}

TEST(ExtremeEmpty, AWorldBeforeAndAfterItsFirstStep) {
  extreme::Stage stage;
  expect_nothing(stage);
  EXPECT_TRUE(stage.step().empty());
  expect_nothing(stage);
}

TEST(ExtremeEmpty, AMeshWithoutTriangles) {
  TriangleMesh points;
  points.vertices = {{0, 0, 0}, {1, 1, 1}};
  extreme::Stage stage;
  stage.load("scene", points);
  stage.add("mesh", extreme::mesh_shape(points), extreme::at({0, 0, 0}));
  stage.add("none", Shape{}, extreme::at({0, 0, 0}));
  stage.add("mesh2", extreme::mesh_shape({}), extreme::at({0, 0, 0}));
  EXPECT_TRUE(stage.step().empty());
  expect_nothing(stage);
}

TEST(ExtremeEmpty, AWorldThatHasBeenEmptied) {
  extreme::Stage stage;
  std::vector<ObjectId> balls;
  for (int i = 0; i < 100; ++i) balls.push_back(stage.ball("ball" + std::to_string(i), {0, 0, 0}, 1));
  stage.step();
  for (const ObjectId ball : balls) stage.world.remove(ball, EndReason::removed);
  EXPECT_EQ(stage.step().size(), 4'950u) << "each contact ends";
  expect_nothing(stage);
  EXPECT_TRUE(stage.step().empty());
}

TEST(ExtremeEmpty, OneTriangle) {
  TriangleMesh one;
  one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}};
  extreme::Stage stage;
  stage.load("one", one);
  stage.step();
  EXPECT_TRUE(extreme::is_hit(stage.ray({0.25, 0.25, 1}, {0, 0, -1})));
  EXPECT_TRUE(extreme::is_hit(stage.ray({0, 0, 1}, {0, 0, -1})));
  EXPECT_TRUE(extreme::is_miss(stage.ray({-0x1p-1074, 0, 1}, {0, 0, -1})));
}

}  // namespace
}  // namespace collided::engine::empty_test
