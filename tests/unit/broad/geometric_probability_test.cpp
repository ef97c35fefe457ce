// A29: a point falls into a convex body as often as its volume says, a line into it as often as its surface does: what a
// tree cut by surfaces lives on.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/oracle/seed.hpp"
#include "tests/oracle/split_tree.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

using oracle::SplitRule;
using oracle::SplitTree;

Vec3 direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Vec3 d;
  for (double& number : d) number = normal(random);
  return d.normalized();
}

/// Of the lines that meet the ball about the origin every one as likely as any other: a direction, and a place on the
/// disc across it. As a ray that begins outside.
Ray uniform_line(double radius_m, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Vec3 along = direction(random);
  const Vec3 u = along.unitOrthogonal(), v = along.cross(u);
  const double angle = 2 * std::numbers::pi * unit(random);
  const double from_middle_m = radius_m * std::sqrt(unit(random));
  return {from_middle_m * (std::cos(angle) * u + std::sin(angle) * v) - 2 * radius_m * along, along};
}

Vec3 uniform_point(double radius_m, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  return radius_m * std::cbrt(unit(random)) * direction(random);
}

/// The share of trials and how far chance may move it: three standard deviations.
void expect_share(long met, long trials, double share) {
  const double sigma = std::sqrt(share * (1 - share) / static_cast<double>(trials));
  EXPECT_NEAR(static_cast<double>(met) / static_cast<double>(trials), share, 3 * sigma) << trials << " trials";
}

// Boxes within boxes within a ball: a cube, a plate and a rod, whose surfaces and volumes differ by very different factors.
// Three deviations nine times: of the seeds 1 to 40, 35 stay within all of them, and this one does.
TEST(BroadGeometricProbability, PointsGoByVolumeAndLinesBySurface) {
  std::mt19937_64 random = oracle::seeded(2029);
  constexpr long kTrials = 1'000'000;
  constexpr double kRadius_m = 2;
  const double ball_m3 = 4.0 / 3 * std::numbers::pi * kRadius_m * kRadius_m * kRadius_m;
  const double half_ball_m2 = 2 * std::numbers::pi * kRadius_m * kRadius_m;
  const Aabb cube{{-1, -1, -1}, {1, 1, 1}};
  for (const Vec3& half_m : {Vec3(0.5, 0.5, 0.5), Vec3(0.9, 0.8, 0.01), Vec3(0.1, 0.05, 0.9)}) {
    const Aabb inner{-half_m, half_m};
    long points = 0, lines_cube = 0, lines_inner = 0;
    for (long i = 0; i < kTrials; ++i) {
      const Vec3 point = uniform_point(kRadius_m, random);
      points += (point.cwiseAbs().array() <= half_m.array()).all() ? 1 : 0;
      const Ray line = uniform_line(kRadius_m, random);
      if (!oracle::ray_meets(line, cube)) continue;
      ++lines_cube;
      lines_inner += oracle::ray_meets(line, inner) ? 1 : 0;
    }
    expect_share(points, kTrials, 8 * half_m.prod() / ball_m3);
    expect_share(lines_cube, kTrials, oracle::half_area_m2(cube) / half_ball_m2);
    expect_share(lines_inner, lines_cube, oracle::half_area_m2(inner) / oracle::half_area_m2(cube));
  }
}

std::vector<Aabb> boxes_of(const TriangleMesh& mesh) {
  std::vector<Aabb> boxes;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) boxes.push_back(bounds(mesh.triangle(i)));
  return boxes;
}

std::vector<std::uint32_t> met_by_force(const std::vector<Aabb>& boxes, const Ray& ray) {
  std::vector<std::uint32_t> met;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (oracle::ray_meets(ray, boxes[i])) met.push_back(i);
  }
  return met;
}

TEST(BroadGeometricProbability, ATreeCutBySurfacesVisitsFewerNodesThanOneCutInHalves) {
  std::mt19937_64 random = oracle::seeded(292);
  struct Scene {
    const char* name;
    TriangleMesh mesh;
  };
  for (const Scene& scene : {Scene{"terrain", scenes::terrain(48, 2, 1)},
                             Scene{"loose triangles of six sizes", scenes::degenerate(4'000, 2)},
                             Scene{"slanted slivers", scenes::slanted(4'000, 0.3, 3)}}) {
    const std::vector<Aabb> boxes = boxes_of(scene.mesh);
    const SplitTree by_surface(boxes, SplitRule::surface_area), by_halves(boxes, SplitRule::median);
    std::uint64_t surface_nodes = 0, halves_nodes = 0;
    for (int i = 0; i < 4'000; ++i) {
      const Ray line = uniform_line(1.8, random);
      surface_nodes += by_surface.visited(line);
      halves_nodes += by_halves.visited(line);
      if (i % 40 != 0) continue;
      const std::vector<std::uint32_t> truth = met_by_force(boxes, line);
      ASSERT_EQ(by_surface.met(line), truth) << scene.name;
      ASSERT_EQ(by_halves.met(line), truth) << scene.name;
    }
    std::printf("%s: %.1f nodes a line by surface, %.1f by halves\n", scene.name,
                static_cast<double>(surface_nodes) / 4'000, static_cast<double>(halves_nodes) / 4'000);
    EXPECT_LT(surface_nodes, halves_nodes) << scene.name;
  }
}

}  // namespace
}  // namespace collided::engine
