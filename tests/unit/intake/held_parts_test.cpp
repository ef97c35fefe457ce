#include "server/intake/held_parts.hpp"

#include <gtest/gtest.h>

namespace collided::engine {
namespace {

/// Three parts of one triangle each, at x = -9, 0.5 and 9; the first two share a vertex that the third does not use.
Scene row() {
  Scene scene{.name = "row"};
  scene.mesh.vertices = {{-9, 0, 0},  {-9, 1, 0}, {0.5, 0, 0}, {0.5, 1, 0},
                         {0.5, 0, 1}, {9, 0, 0},  {9, 1, 0},   {9, 0, 1}};
  scene.mesh.triangles = {{0, 1, 0}, {2, 3, 4}, {5, 6, 7}};
  scene.parts = {{.name = "row/a", .first_triangle = 0, .triangle_count = 1},
                 {.name = "row/b", .first_triangle = 1, .triangle_count = 1},
                 {.name = "row/c", .first_triangle = 2, .triangle_count = 1}};
  return scene;
}

Aabb from_x(double low, double high) { return {.low = {low, -100, -100}, .high = {high, 100, 100}}; }

TEST(HeldParts, KeepsWhatTouchesTheBoxAsItIs) {
  Scene scene = row();
  const LeftOutOfScene left_out = leave_out_beyond(from_x(0.5, 10), scene, false);
  EXPECT_EQ(left_out.parts, 1u);
  ASSERT_EQ(scene.parts.size(), 2u);
  EXPECT_EQ(scene.parts[0].name, "row/b");
  EXPECT_EQ(scene.parts[1].first_triangle, 1u);
  EXPECT_EQ(scene.mesh.vertices.size(), 6u);
  for (std::uint32_t part = 0; part < 2; ++part) {
    const Triangle kept = scene.mesh.triangle(scene.parts[part].first_triangle);
    const Triangle given = row().mesh.triangle(part + 1);
    EXPECT_TRUE(kept.a == given.a && kept.b == given.b && kept.c == given.c);
  }
}

TEST(HeldParts, AllOfASceneThatLiesInsideStaysWithItsIndex) {
  Scene scene = row();
  const std::byte saved[4]{};
  scene.index.bytes = saved;
  EXPECT_EQ(leave_out_beyond(from_x(-10, 10), scene, false).parts, 0u);
  EXPECT_EQ(scene.mesh.vertices.size(), 8u);
  EXPECT_FALSE(scene.index.bytes.empty());
  EXPECT_EQ(leave_out_beyond(from_x(100, 110), scene, false).parts, 3u);
  EXPECT_TRUE(scene.mesh.vertices.empty());
  EXPECT_TRUE(scene.index.bytes.empty()) << "it was made for all of the triangles";
}

TEST(HeldParts, ObjectsGoByTheirPlaceUnlessTheyWillMove) {
  Scene scene{.name = "balls"};
  for (const double x : {-9.0, 3.0})
    scene.objects.push_back({.name = "ball",
                             .shape = {.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = 1}}, .mesh = {}},
                             .pose = {.position = {x, 0, 0}}});
  scene.objects.push_back(
      {.name = "ground", .shape = {.primitives = {HalfSpace{.point = Vec3::Zero(), .normal = {0, 0, 1}}}, .mesh = {}}});
  EXPECT_EQ(leave_out_beyond(from_x(2, 10), scene, true).objects, 0u);
  EXPECT_EQ(leave_out_beyond(from_x(4, 10), scene, false).objects, 1u) << "touching is holding";
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[1].name, "ground") << "it has no end";
}

}  // namespace
}  // namespace collided::engine
