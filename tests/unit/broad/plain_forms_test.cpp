#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <random>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/exact_oracle.hpp"
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

// A47, A48: every ray's first hit, of both trees.
TEST(BroadPlainForms, BothAnswerAsBruteForceDoes) {
  std::mt19937_64 random = oracle::seeded(20260614);
  for (const TriangleMesh& mesh : {scenes::terrain(12, 3, random()), scenes::icosphere(2, 1), crossing(random),
                                   scenes::scattered(400, 0.2, random()), scenes::degenerate(300, random())}) {
    expect_first_hits(oracle::PlainBvh(mesh), mesh, 400, random);
    expect_first_hits(oracle::PolygonBsp(mesh, random), mesh, 400, random);
  }
}

// A47: a leaf holds three, or what no plane parts; the tree is as deep as that takes, and says what it is.
TEST(BroadPlainForms, AnAxisLeafHoldsThreeWhereThreeCanBeParted) {
  std::mt19937_64 random = oracle::seeded(2);
  const TriangleMesh loose = scenes::scattered(500, 0.01, random());
  const auto start = std::chrono::steady_clock::now();
  const oracle::PlainBvh tree(loose);
  const std::chrono::duration<double, std::milli> built = std::chrono::steady_clock::now() - start;
  std::printf("500 triangles: %zu nodes, depth %d, %zu references, %zu bytes, built in %.2f ms\n", tree.nodes(),
              tree.depth(), tree.references(), tree.bytes(), built.count());
  EXPECT_LE(tree.largest_leaf(), 3u);
  EXPECT_LT(tree.depth(), 20) << "2^9 triangles";
  EXPECT_GE(tree.references(), loose.triangles.size());
  EXPECT_LE(oracle::PlainBvh(scenes::terrain(10, 2, 1)).largest_leaf(), 3u);
  TriangleMesh fivefold{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}}, .triangles = {}};
  fivefold.triangles.assign(5, {0, 1, 2});
  EXPECT_EQ(oracle::PlainBvh(fivefold).largest_leaf(), 5u);
}

int exact_side(const Triangle& t, const Vec3& point) {
  using oracle::Rational;
  std::array<std::array<Rational, 3>, 3> rows;
  for (int axis = 0; axis < 3; ++axis) {
    rows[0][axis] = Rational(t.b[axis]) - Rational(t.a[axis]);
    rows[1][axis] = Rational(t.c[axis]) - Rational(t.a[axis]);
    rows[2][axis] = Rational(point[axis]) - Rational(t.a[axis]);
  }
  const Rational det = rows[0][0] * (rows[1][1] * rows[2][2] - rows[1][2] * rows[2][1]) -
                       rows[0][1] * (rows[1][0] * rows[2][2] - rows[1][2] * rows[2][0]) +
                       rows[0][2] * (rows[1][0] * rows[2][1] - rows[1][1] * rows[2][0]);
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}

// A48: the side on which a point lies, by rationals; only points as near as a rounding are left open.
TEST(BroadPlainForms, PointsAreOnTheSideOfAPolygonThatRationalsSay) {
  std::mt19937_64 random = oracle::seeded(48);
  const TriangleMesh mesh = crossing(random);
  const oracle::PolygonBsp tree(mesh, random);
  std::uniform_real_distribution<double> number(-1, 1);
  int open = 0;
  constexpr int kPoints = 20'000;
  for (int i = 0; i < kPoints; ++i) {
    const auto triangle = static_cast<std::uint32_t>(random() % mesh.triangles.size());
    const Triangle t = mesh.triangle(triangle);
    const Vec3 far(number(random), number(random), number(random));
    const double u = number(random);
    // Half of them a hair from the plane.
    const Vec3 point = i % 2 == 0 ? far : Vec3(t.a + u * (t.b - t.a) + number(random) * (t.c - t.a) + 1e-9 * far);
    const int side = tree.side_of(triangle, point);
    open += side == 0 ? 1 : 0;
    ASSERT_TRUE(side == 0 || side == exact_side(t, point)) << i;
  }
  EXPECT_LT(open, kPoints / 100);
}

// A48: nothing that a ray from the eye meets later comes before what it meets first; from ten thousand eyes.
TEST(BroadPlainForms, PolygonsComeFrontToBackFromEveryEye) {
  std::mt19937_64 random = oracle::seeded(481);
  std::uniform_real_distribution<double> number(-1.5, 1.5);
  int compared = 0, open = 0;
  for (const TriangleMesh& mesh : {scenes::terrain(6, 3, 1), crossing(random), scenes::scattered(120, 0.5, 7)}) {
    const oracle::PolygonBsp tree(mesh, random);
    std::printf("%zu triangles: %zu nodes, depth %d, %zu cut, %.1f references each\n", mesh.triangles.size(),
                tree.nodes(), tree.depth(), tree.references() - mesh.triangles.size(),
                static_cast<double>(tree.references()) / static_cast<double>(mesh.triangles.size()));
    for (int eye_number = 0; eye_number < 3'500; ++eye_number) {
      const Vec3 eye(number(random), number(random), number(random));
      std::vector<std::size_t> rank(tree.nodes());
      const std::vector<std::uint32_t> order = tree.front_to_back(eye);
      ASSERT_EQ(order.size(), tree.nodes());
      for (std::size_t place = 0; place < order.size(); ++place) rank[order[place]] = place;
      const Triangle aim = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
      const Ray ray{eye, (aim.a + aim.b + aim.c) / 3 - eye};
      std::vector<std::pair<double, std::size_t>> met;  // how far, and which place its cell has
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        RayHit hit;
        if (!cast_ray(ray, mesh.triangle(t), hit).yes()) continue;
        const std::uint32_t node = tree.node_of(t, hit.point);
        if (node == oracle::PolygonBsp::kNone) ++open;
        else met.emplace_back(hit.distance_m, rank[node]);
      }
      std::sort(met.begin(), met.end());
      for (std::size_t i = 1; i < met.size(); ++i) {
        ASSERT_LE(met[i - 1].second, met[i].second) << "eye " << eye_number;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 10'000);
  EXPECT_LT(open, compared / 100);
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
