#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "server/broad_phase/bsp_tree.hpp"
#include "tests/oracle/plain_ray.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/seed.hpp"

namespace collided {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Every candidate of a walk that never shortens.
std::set<std::uint32_t> candidates(const BspTree& tree, const Ray& ray, double limit = kInfinity,
                                   double slack_m = 0) {
  std::set<std::uint32_t> all;
  WalkCost cost;
  const auto collect = [](void* context, std::uint32_t triangle, double current) {
    static_cast<std::set<std::uint32_t>*>(context)->insert(triangle);
    return current;
  };
  tree.walk_ray(ray, limit, slack_m, collect, &all, cost);
  return all;
}

Vec3 in_cube(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

/// From around the scene through it: through points of triangles, their corners and edges, and at random; half of
/// them with one or two zero components.
Ray random_ray(const TriangleMesh& mesh, std::mt19937_64& random) {
  const auto number = static_cast<std::uint32_t>(random() % mesh.triangles.size());
  const Triangle triangle = mesh.triangle(number);
  Vec3 target = in_cube(random);
  switch (random() % 5) {
    case 0: target = triangle.a; break;
    case 1: target = (triangle.a + triangle.b) / 2; break;
    case 2: target = (triangle.a + triangle.b + triangle.c) / 3; break;
    case 3: target = triangle.c; break;
    default: break;
  }
  Vec3 origin = 2 * in_cube(random);
  const std::uint64_t zeros = random() % 8;
  if (zeros < 3) origin[static_cast<int>(zeros)] = target[static_cast<int>(zeros)];
  if (zeros == 3) origin[0] = target[0], origin[1] = target[1];
  if (zeros == 4) origin = target;
  Ray ray{origin, target - origin};
  if (ray.direction.isZero()) ray.direction = in_cube(random);
  return ray;
}

std::set<std::uint32_t> met(const TriangleMesh& mesh, const Ray& ray) {
  std::set<std::uint32_t> all;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (oracle::plain_ray(ray, mesh.triangle(i))) all.insert(i);
  }
  return all;
}

void expect_none_lost(const TriangleMesh& mesh, int ray_count, std::mt19937_64& random) {
  const BspTree tree = BspTree::build(mesh);
  std::size_t met_count = 0;
  std::size_t candidate_count = 0;
  for (int i = 0; i < ray_count; ++i) {
    const Ray ray = random_ray(mesh, random);
    const std::set<std::uint32_t> expected = met(mesh, ray);
    const std::set<std::uint32_t> found = candidates(tree, ray);
    ASSERT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end()))
        << "ray " << i << " from " << ray.origin.transpose() << " along " << ray.direction.transpose();
    met_count += expected.size();
    candidate_count += found.size();
  }
  EXPECT_GT(met_count, 0u);
  std::printf("%zu triangles: %zu met, %zu candidates\n", mesh.triangles.size(), met_count, candidate_count);
}

TEST(BroadBspRay, NoTriangleIsLost) {
  std::mt19937_64 random(scenes::seed());
  expect_none_lost(scenes::icosphere(4, 1), 500, random);
  expect_none_lost(scenes::terrain(60, 2, random()), 500, random);
  expect_none_lost(scenes::scattered(3000, 0.1, random()), 500, random);
  expect_none_lost(scenes::scattered(300, 1, random()), 500, random);
  expect_none_lost(scenes::box({1, 1, 1}), 500, random);
  expect_none_lost(scenes::degenerate(3000, random()), 1000, random);
}

TEST(BroadBspRay, EmptyMeshHasNoCandidates) {
  const BspTree tree = BspTree::build(TriangleMesh{});
  EXPECT_TRUE(candidates(tree, {Vec3::Zero(), Vec3::UnitX()}).empty());
  EXPECT_TRUE(tree.bounds().empty());
  EXPECT_TRUE(candidates(BspTree(), {Vec3::Zero(), Vec3::UnitX()}).empty());
}

}  // namespace
}  // namespace collided
