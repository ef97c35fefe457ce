// A ray at a ball ten thousand kilometres away: the quadratic's discriminant is the difference of two numbers of 28
// digits, and Bullet's ray test is off by centimetres for a ball, by 45 m for a box.
#include <gtest/gtest.h>

#include "server/geometry/tolerance.hpp"
#include "tests/extreme/worlds.hpp"

namespace collided::engine::far_sphere_test {
namespace {

constexpr double kDistances[] = {1e4, 1e6, 1e7, 1e8, 1e12, 1e15};

/// `width` is the relative error that the engine declares: a few roundings, at a tangent what a square root leaves.
void expect_distance(const Answers& found, double distance_m, double width = 4e-15) {
  ASSERT_TRUE(extreme::is_hit(found));
  EXPECT_LE(std::abs(found.hits[0].distance_m - distance_m), found.hits[0].error_m);
  EXPECT_LE(found.hits[0].error_m, width * distance_m);
}

// 3-4-5: beside the centre by 3 the ball of 5 begins 4 before it.
TEST(ExtremeFarSphere, TheDistanceIsRightToItsLastDigits) {
  for (const double far : kDistances) {
    extreme::Stage at_ball, at_ray;
    at_ball.ball("ball", {0, 3, 0}, 5);
    at_ball.step();
    expect_distance(at_ball.ray({-far, 0, 0}, {1, 0, 0}), far - 4);
    at_ray.ball("ball", {far, 3, 0}, 5);
    at_ray.step();
    expect_distance(at_ray.ray({0, 0, 0}, {1, 0, 0}), far - 4);
  }
}

TEST(ExtremeFarSphere, TheTangentIsAHitAndOneStepMoreIsNot) {
  for (const double far : kDistances) {
    extreme::Stage stage;
    stage.ball("ball", {0, 5, 0}, 5);
    stage.step();
    expect_distance(stage.ray({-far, 0, 0}, {1, 0, 0}), far, kRefineRay);
    EXPECT_TRUE(extreme::is_miss(stage.ray({-far, -0x1p-1074, 0}, {1, 0, 0}))) << far;
  }
}

TEST(ExtremeFarSphere, BoxesCapsulesAndTrianglesToo) {
  for (const double far : kDistances) {
    extreme::Stage box, capsule, mesh;
    box.block("box", {0, 0, 0}, {4, 5, 6});
    box.step();
    expect_distance(box.ray({-far, 1, 2}, {1, 0, 0}), far - 4);
    capsule.add("capsule", {.primitives = {Capsule{{0, 3, -7}, {0, 3, 7}, 5}}, .mesh = nullptr},
                extreme::at({0, 0, 0}));
    capsule.step();
    expect_distance(capsule.ray({-far, 0, 0}, {1, 0, 0}), far - 4);
    TriangleMesh wall;
    wall.vertices = {{-4, -9, -9}, {-4, 9, -9}, {-4, 0, 9}};
    wall.triangles = {{0, 1, 2}};
    mesh.add("wall", extreme::mesh_shape(wall), extreme::at({0, 0, 0}));
    mesh.step();
    expect_distance(mesh.ray({-far, 0, 0}, {1, 0, 0}), far - 4);
  }
}

}  // namespace
}  // namespace collided::engine::far_sphere_test
