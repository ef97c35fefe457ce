#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/broad/bvh_walks.hpp"

// The walks that pass over triangles on their own account, against every triangle decided exactly.
namespace collided::engine {
namespace {

constexpr double kEndlessRay = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kNone = Bvh::kNoTriangle;

bool meets(const Ray& ray, const Triangle& triangle) {
  RayHit hit;
  return cast_ray(ray, triangle, hit).yes();
}

/// The nearest triangle, of several the first; by every triangle in turn.
std::uint32_t nearest_by_force(const TriangleMesh& mesh, const Ray& ray) {
  std::uint32_t best = kNone;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!meets(ray, mesh.triangle(i))) continue;
    if (best == kNone || compare_hits(ray, mesh.triangle(i), mesh.triangle(best)) < 0) best = i;
  }
  return best;
}

/// Keeps the nearest of what it is told, as the product does.
struct Nearest {
  const Ray& ray;
  const TriangleMesh& mesh;
  std::uint32_t best = kNone;

  double operator()(std::uint32_t number, const Triangle& corners, double limit) {
    EXPECT_TRUE(corners.a == mesh.triangle(number).a && corners.c == mesh.triangle(number).c);
    RayHit hit;
    if (!cast_ray(ray, corners, hit).yes()) return limit;
    const int order = best == kNone ? -1 : compare_hits(ray, corners, mesh.triangle(best));
    if (order < 0 || (order == 0 && number < best)) best = number;
    return std::min(limit, (hit.distance_m + hit.distance_error_m) / ray.direction.norm() * (1 + 0x1p-50));
  }
};

/// Says of what it is told whether the ray meets it.
struct Doubt {
  const Ray& ray;
  std::uint32_t told = 0;

  double operator()(std::uint32_t, const Triangle& corners, double limit) {
    ++told;
    return meets(ray, corners) ? -1 : limit;
  }
};

double limit_of(const Ray& ray) { return ray.length_m / ray.direction.stableNorm() * (1 + 0x1p-50); }

/// Through corners, edges, middles and nothing in particular; some from far away, some along an axis, some short, some
/// that end on what they aim at.
std::vector<Ray> hard_rays(const TriangleMesh& mesh, std::size_t count, std::mt19937_64& random) {
  std::vector<Ray> rays;
  Aabb bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  const double size = (bounds.high - bounds.low).maxCoeff();
  const Vec3 middle = (bounds.low + bounds.high) / 2;
  while (rays.size() < count) {
    const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const Vec3 targets[4] = {t.a, t.a / 2 + t.b / 2, t.a / 4 + t.b / 4 + t.c / 2, middle + size * in_cube(random)};
    const Vec3 target = targets[random() % 4];
    const double away = random() % 8 == 0 ? 1e4 : random() % 2 == 0 ? 1 : 0.01;
    Ray ray{middle + away * size * in_cube(random), Vec3::Zero()};
    if (random() % 6 == 0) ray.origin.head<2>() = target.head<2>();
    ray.direction = target - ray.origin;
    if (random() % 3 == 0) ray.direction *= std::ldexp(1.0, static_cast<int>(random() % 40) - 20);
    if (random() % 4 == 0) ray.length_m = (target - ray.origin).norm() * (random() % 2 == 0 ? 1 : 0.7);
    if (!ray.direction.isZero(0)) rays.push_back(ray);
  }
  return rays;
}

struct Named {
  const char* name;
  TriangleMesh mesh;
};

/// Corners that are floats in the tree's frame, and corners that are not.
std::vector<Named> meshes(std::mt19937_64& random) {
  std::vector<Named> all;
  all.push_back({"scattered", scenes::scattered(600, 0.4, random())});
  all.push_back({"degenerate", scenes::degenerate(400, random())});
  all.push_back({"sphere", scenes::icosphere(3, 1)});
  all.push_back({"terrain", scenes::terrain(20, 10, random())});
  all.push_back({"box", scenes::box({1, 2, 3})});
  const std::size_t count = all.size();
  for (std::size_t i = 0; i < count; ++i) {
    all.push_back(all[i]);
    for (Vec3& vertex : all.back().mesh.vertices) {
      for (double& x : vertex) x = static_cast<double>(static_cast<float>(x));
    }
    all.push_back(all[i]);
    for (Vec3& vertex : all.back().mesh.vertices) vertex += Vec3(1e5, -3e4, 7);
  }
  return all;
}

bool same_corners(const Triangle& a, const Triangle& b) { return a.a == b.a && a.b == b.b && a.c == b.c; }

void on_every_instruction_set(const std::function<void(const char*)>& check) {
  for (std::int64_t rest = hwy::SupportedTargets() | HWY_EMU128; rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    check(hwy::TargetName(rest & -rest));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

TEST(BroadRayGoals, NearestAndAnyAgreeWithEveryTriangleDecidedExactly) {
  std::mt19937_64 random = oracle::seeded(20240701);
  std::size_t hits = 0;
  std::size_t undoubted = 0;
  for (const Named& scene : meshes(random)) {
    const TriangleMesh& mesh = scene.mesh;
    const Bvh tree = Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}});
    const std::vector<Ray> rays = hard_rays(mesh, 150, random);
    std::vector<std::uint32_t> expected;
    for (const Ray& ray : rays) expected.push_back(nearest_by_force(mesh, ray));
    std::vector<std::uint32_t> any(rays.size(), kNone);
    bool is_first = true;
    on_every_instruction_set([&](const char* target) {
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& ray = rays[i];
        WalkCost cost;
        Nearest nearest{ray, mesh};
        tree.walk_ray_nearest(ray, limit_of(ray), mesh, nearest, cost);
        EXPECT_EQ(nearest.best, expected[i]) << scene.name << " ray " << i << " " << target;
        Doubt doubt{ray};
        Triangle corners;
        const std::uint32_t met = tree.meet_ray(ray, limit_of(ray), mesh, doubt, cost, corners);
        EXPECT_EQ(met == kNone, expected[i] == kNone) << scene.name << " ray " << i << " " << target;
        if (met == kNone) continue;
        EXPECT_TRUE(same_corners(corners, mesh.triangle(met))) << scene.name << " ray " << i << " " << target;
        EXPECT_TRUE(meets(ray, mesh.triangle(met))) << scene.name << " ray " << i << " " << target;
        if (is_first) any[i] = met;
        EXPECT_EQ(met, any[i]) << scene.name << " ray " << i << " " << target;
        ++hits;
        undoubted += doubt.told == 0 ? 1 : 0;
      }
      is_first = false;
    });
  }
  // Else the walks would prove nothing about what floats may say alone.
  EXPECT_GT(hits, 5000U);
  EXPECT_GT(undoubted, hits / 5);
}

TEST(BroadRayGoals, ABatchHearsWhatEachRayHearsAlone) {
  std::mt19937_64 random = oracle::seeded(20240702);
  for (const Named& scene : meshes(random)) {
    const TriangleMesh& mesh = scene.mesh;
    const Bvh tree = Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}});
    const std::vector<Ray> rays = hard_rays(mesh, 100, random);
    std::vector<Nearest> nearest;
    std::vector<Doubt> doubts;
    for (const Ray& ray : rays) {
      nearest.push_back({ray, mesh});
      doubts.push_back({ray});
    }
    std::vector<WalkCost> costs(2 * rays.size());
    std::vector<Bvh::RayTask> to_nearest;
    std::vector<Bvh::RayTask> to_any;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      to_nearest.push_back({&rays[i], limit_of(rays[i]), nearest[i], &costs[2 * i]});
      to_any.push_back({&rays[i], limit_of(rays[i]), doubts[i], &costs[2 * i + 1]});
    }
    tree.walk_rays(to_nearest, mesh, Bvh::RayGoal::nearest);
    tree.walk_rays(to_any, mesh, Bvh::RayGoal::any);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      WalkCost alone[2];
      Nearest single{rays[i], mesh};
      tree.walk_ray_nearest(rays[i], limit_of(rays[i]), mesh, single, alone[0]);
      Doubt doubt{rays[i]};
      Triangle corners;
      const std::uint32_t met = tree.meet_ray(rays[i], limit_of(rays[i]), mesh, doubt, alone[1], corners);
      EXPECT_EQ(nearest[i].best, single.best) << scene.name << " ray " << i;
      EXPECT_EQ(to_any[i].met, met) << scene.name << " ray " << i;
      EXPECT_TRUE(met == kNone || same_corners(to_any[i].corners, mesh.triangle(met))) << scene.name << " ray " << i;
      for (int goal = 0; goal < 2; ++goal) {
        EXPECT_EQ(costs[2 * i + goal].nodes, alone[goal].nodes) << scene.name << " ray " << i;
        EXPECT_EQ(costs[2 * i + goal].candidates, alone[goal].candidates) << scene.name << " ray " << i;
      }
    }
  }
}

/// A fan from one place, its rays close together; some aimed at corners, some at nothing, a few of them short.
std::vector<Ray> fan(const TriangleMesh& mesh, std::size_t count, std::mt19937_64& random) {
  Aabb bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  const double size = (bounds.high - bounds.low).maxCoeff();
  const Vec3 middle = (bounds.low + bounds.high) / 2;
  const Vec3 eye = middle + (random() % 2 == 0 ? 1.5 : 0.1) * size * in_cube(random);
  const Vec3 aim = middle + 0.4 * size * in_cube(random);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    Ray ray{eye, aim - eye + 0.01 * (aim - eye).norm() * in_cube(random)};
    const Vec3& vertex = mesh.vertices[random() % mesh.vertices.size()];
    if (random() % 3 == 0 && (vertex - aim).norm() < 0.01 * size) ray.direction = vertex - eye;
    if (random() % 8 == 0) ray.length_m = 0.5 * size;
    if (random() % 50 == 0) ray.direction = -ray.direction;
    rays.push_back(ray);
  }
  return rays;
}

// Groups that agree on the order of children go as one, the others in turn; no answer tells which.
TEST(BroadRayGoals, CoherentRaysMeetTogetherWhatEachMeetsAlone) {
  std::mt19937_64 random = oracle::seeded(20240703);
  std::size_t hits = 0;
  std::size_t fewer_told = 0;
  for (const Named& scene : meshes(random)) {
    const TriangleMesh& mesh = scene.mesh;
    const Bvh tree = Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}});
    const std::vector<Ray> rays = fan(mesh, 203, random);
    on_every_instruction_set([&](const char* target) {
      std::vector<Nearest> nearest;
      std::vector<Doubt> doubts;
      for (const Ray& ray : rays) {
        nearest.push_back({ray, mesh});
        doubts.push_back({ray});
      }
      std::vector<Bvh::RayTask> to_nearest;
      std::vector<Bvh::RayTask> to_any;
      WalkCost cost;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        to_nearest.push_back({&rays[i], limit_of(rays[i]), nearest[i], &cost});
        to_any.push_back({&rays[i], limit_of(rays[i]), doubts[i], &cost});
      }
      tree.walk_rays(to_nearest, mesh, Bvh::RayGoal::nearest);
      tree.walk_rays(to_any, mesh, Bvh::RayGoal::any);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        WalkCost unread;
        Nearest single{rays[i], mesh};
        tree.walk_ray_nearest(rays[i], limit_of(rays[i]), mesh, single, unread);
        Doubt doubt{rays[i]};
        Triangle corners;
        const std::uint32_t met = tree.meet_ray(rays[i], limit_of(rays[i]), mesh, doubt, unread, corners);
        EXPECT_EQ(nearest[i].best, single.best) << scene.name << " ray " << i << " " << target;
        EXPECT_EQ(to_any[i].met, met) << scene.name << " ray " << i << " " << target;
        EXPECT_EQ(met == kNone, single.best == kNone) << scene.name << " ray " << i << " " << target;
        hits += met != kNone ? 1 : 0;
        fewer_told += met != kNone && doubts[i].told == 0 ? 1 : 0;
      }
    });
  }
  EXPECT_GT(hits, 2000U);
  EXPECT_GT(fewer_told, hits / 4);
}

}  // namespace
}  // namespace collided::engine
