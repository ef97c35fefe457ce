#include <gtest/gtest.h>

#include <random>

#include "tests/oracle/plain_bvh.hpp"
#include "tests/oracle/polygon_bsp.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

/// At corners, edges, insides and past them; along axes, from triangles, in their planes.
Ray random_ray(const TriangleMesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-2, 2);
  const auto point = [&] {
    const double x = number(random);
    const double y = number(random);
    return Vec3(x, y, number(random));
  };
  const Triangle aim = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
  const Vec3 targets[] = {aim.a, (aim.a + aim.b) / 2, (aim.a + aim.b + aim.c) / 3, point()};
  const Vec3 target = targets[random() % 4];
  switch (random() % 6) {
    case 0: return {target, aim.b - aim.a};
    case 1: return {target + Vec3(0, 0, 3), {0, 0, -1}};
    case 2: return {aim.c + 3 * (aim.c - aim.a), aim.a - aim.c};
    default: break;
  }
  const Vec3 from = point();
  return {from, target - from};
}

TriangleMesh crossing(std::mt19937_64& random) {
  TriangleMesh mesh = scenes::scattered(60, 0.8, random());
  scenes::append(mesh, scenes::box({0.5, 0.25, 0.125}));
  return mesh;
}

template <class Tree>
void expect_first_hits(const Tree& tree, const TriangleMesh& mesh, int ray_count, std::mt19937_64& random) {
  int hits = 0;
  for (int i = 0; i < ray_count; ++i) {
    const Ray ray = random_ray(mesh, random);
    if (ray.direction.isZero(0)) continue;
    const oracle::FirstHit truth = oracle::first_hit(mesh, ray);
    oracle::PlainCost cost;
    const oracle::FirstHit found = tree.first_hit(ray, cost);
    EXPECT_EQ(found.s, truth.s) << i;
    EXPECT_EQ(found.triangle, truth.triangle) << i;
    hits += truth.triangle != oracle::kNoTriangle ? 1 : 0;
  }
  EXPECT_GT(hits, ray_count / 5);
}

TEST(BroadPlainForms, BothAnswerAsBruteForceDoes) {
  std::mt19937_64 random = oracle::seeded(20260614);
  for (const TriangleMesh& mesh : {scenes::terrain(12, 3, random()), scenes::icosphere(2, 1), crossing(random),
                                   scenes::scattered(400, 0.2, random()), scenes::degenerate(300, random())}) {
    expect_first_hits(oracle::PlainBvh(mesh), mesh, 400, random);
    expect_first_hits(oracle::PolygonBsp(mesh, random), mesh, 400, random);
  }
}

TEST(BroadPlainForms, AnAxisLeafHoldsThreeWhereThreeCanBeParted) {
  std::mt19937_64 random = oracle::seeded(2);
  const TriangleMesh loose = scenes::scattered(500, 0.01, random());
  EXPECT_LE(oracle::PlainBvh(loose).largest_leaf(), 3u);
  EXPECT_LE(oracle::PlainBvh(scenes::terrain(10, 2, 1)).largest_leaf(), 3u);
  TriangleMesh fivefold{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}}, .triangles = {}};
  fivefold.triangles.assign(5, {0, 1, 2});
  EXPECT_EQ(oracle::PlainBvh(fivefold).largest_leaf(), 5u);
}

// A face of a ball has the whole ball behind it: the tree is a list, cut off where it is deepest.
TEST(BroadPlainForms, AroundABallThePolygonsMakeAList) {
  std::mt19937_64 random = oracle::seeded(3);
  const TriangleMesh ball = scenes::icosphere(2, 1);
  const oracle::PolygonBsp tree(ball, random);
  EXPECT_EQ(tree.references(), ball.triangles.size());
  oracle::PlainCost cost;
  EXPECT_NE(tree.first_hit({{0, 0, 0}, {0.3, 0.4, 0.5}}, cost).triangle, oracle::kNoTriangle);
  EXPECT_GT(cost.nodes + cost.tests, ball.triangles.size() / 2);
}

}  // namespace
}  // namespace collided::engine
