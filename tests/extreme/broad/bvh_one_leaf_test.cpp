// A hundred thousand identical triangles can't be parted by any plane: a build that insists never ends, and the leaf
// is as large as the mesh.
#include <gtest/gtest.h>

#include <chrono>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::bvh_one_leaf_test {
namespace {

TriangleMesh identical(std::uint32_t count) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  mesh.triangles.assign(count, {0, 1, 2});
  return mesh;
}

TEST(ExtremeBvhOneLeaf, TheBuildEndsWithinDepthAndMemory) {
  const Bvh tree = Bvh::build(identical(100'000));
  EXPECT_LT(tree.report().depth, 64u);
  EXPECT_LE(tree.report().references, 400'000u);
  EXPECT_LT(tree.report().bytes, 100'000u * 400);
}

TEST(ExtremeBvhOneLeaf, TheLowestNumberWinsAndAllAreCounted) {
  extreme::Stage stage;
  stage.load("pile", identical(100'000));
  stage.step();
  const auto started = std::chrono::steady_clock::now();
  const Answers closest = stage.ray({0.25, 0.25, 1}, {0, 0, -1});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  ASSERT_TRUE(extreme::is_hit(closest));
  EXPECT_EQ(closest.hits[0].triangle, 0u);
  EXPECT_EQ(closest.hits[0].distance_m, 1);
  EXPECT_LT(seconds, 1) << "a leaf of 100,000 exact tests and ties";
  Questions questions;
  questions.mode = HitMode::all;
  questions.max_hits = 200'000;
  const std::vector<double> down{0.25, 0.25, 1, 0, 0, -1, extreme::kEndless};
  questions.numbers = down;
  Answers all;
  QueryScratch scratch;
  answer(*stage.world.newest(), questions, all, scratch);
  ASSERT_EQ(all.hits.size(), 100'000u);
  EXPECT_EQ(all.hits[99'999].triangle, 99'999u) << "ties in order of number";
}

TEST(ExtremeBvhOneLeaf, BesideThePileNothingIsTested) {
  extreme::Stage stage;
  stage.load("pile", identical(100'000));
  stage.step();
  const Answers summand = stage.ray({2.25, 0.25, 1}, {0, 0, -1});
  EXPECT_TRUE(extreme::is_miss(summand));
  EXPECT_EQ(summand.exact_tests[0], 0u);
}

}  // namespace
}  // namespace collided::engine::bvh_one_leaf_test
