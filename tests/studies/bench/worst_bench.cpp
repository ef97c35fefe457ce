// Worst cases of the static index, each a row: what the build takes, what a question takes, whether the answer is
// complete by brute force over all triangles, and the stated bounds. Ends with 1 where a row is beyond its bounds.

#include <cstdio>
#include <random>

#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/closest_hit.hpp"

namespace collided::bench {
using namespace engine;
namespace {

struct Bounds {
  double build_us_each = 5;  // a triangle, of wall time
  double bytes_each = 100;   // a triangle, of the tree
  double peak_bytes_each = 400;
  double walked_ns = 400;      // a triangle of the scene, for a question whose candidates are only counted
  double decided_ns = 20'000;  // the same where each is decided and all are degenerate: exact arithmetic throughout
};

bool is_ok = true;

void expect(bool holds, const char* what) {
  if (holds) return;
  is_ok = false;
  std::printf("    BEYOND ITS BOUND: %s\n", what);
}

struct Question {
  const char* name;
  Ray ray;
};

std::vector<std::uint8_t> offered(const Bvh& tree, const TriangleMesh& mesh, const Ray& ray, WalkCost& cost) {
  std::vector<std::uint8_t> seen(mesh.triangles.size());
  const auto note = [&](std::uint32_t triangle, const Triangle&, double limit) {
    seen[triangle] = 1;
    return limit;
  };
  tree.walk_ray(ray, std::numeric_limits<double>::infinity(), 0, mesh, note, cost);
  return seen;
}

void ask(const Question& question, const Bvh& tree, const TriangleMesh& mesh) {
  WalkCost all_cost;
  double start = thread_seconds();
  const std::vector<std::uint8_t> seen = offered(tree, mesh, question.ray, all_cost);
  const double all_s = thread_seconds() - start;
  WalkCost closest_cost;
  start = thread_seconds();
  const ClosestHit closest = closest_hit(tree, mesh, question.ray, closest_cost);
  const double closest_s = thread_seconds() - start;
  std::size_t met = 0;
  std::size_t lost = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    RayHit hit;
    if (!cast_ray(question.ray, mesh.triangle(i), hit).yes()) continue;
    ++met;
    lost += seen[i] != 0 ? 0 : 1;
    nearest = std::min(nearest, hit.distance_m / question.ray.direction.norm());
  }
  std::printf(
      "    %-34s all %8.3f ms, %u nodes, %u candidates, %zu of %zu met offered; closest %8.3f ms, %u candidates\n",
      question.name, 1e3 * all_s, all_cost.nodes, all_cost.candidates, met - lost, met, 1e3 * closest_s,
      closest_cost.candidates);
  expect(lost == 0, "a triangle that the ray meets was not offered");
  expect(!(nearest < closest.s * (1 - 1e-12)), "the closest hit is not the closest");
  const double count = 1000 + static_cast<double>(mesh.triangles.size());
  expect(all_s < 1e-9 * Bounds{}.walked_ns * count, "time of the walk");
  expect(closest_s < 1e-9 * Bounds{}.decided_ns * count, "time of the closest hit");
}

void run(const char* name, const TriangleMesh& mesh, BvhForm form, const std::vector<Question>& questions) {
  const Bvh tree = Bvh::build(mesh, {.progress = {}, .cancelled = {}, .form = form});
  const BvhReport& report = tree.report();
  const auto count = static_cast<double>(mesh.triangles.size());
  const double bytes = static_cast<double>(report.bytes) / count;
  const double peak = static_cast<double>(report.peak_bytes) / count;
  std::printf(
      "  %s, %s: %.0f triangles, built in %.0f ms, depth %u, %.2f references, %.1f bytes a triangle, peak %.0f\n", name,
      form == BvhForm::fast ? "fast" : "best", count, 1e3 * report.build_s, report.depth,
      static_cast<double>(report.references) / count, bytes, peak);
  const Bounds bounds;
  expect(1e6 * report.build_s < bounds.build_us_each * count, "time of the build");
  expect(bytes < bounds.bytes_each, "memory of the tree");
  expect(peak < bounds.peak_bytes_each, "memory of the build");
  for (const Question& question : questions) ask(question, tree, mesh);
}

TriangleMesh identical(std::uint32_t count) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0.2}, {0, 1, 0.1}};
  mesh.triangles.assign(count, {0, 1, 2});
  return mesh;
}

/// All in one small box, none like another.
TriangleMesh overlapping(std::uint32_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(-1e-3, 1e-3);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& corner : {Vec3(-1, -1, -1), Vec3(1, -0.5, 0.5), Vec3(0, 1, 1)}) {
      const double x = part(random);
      const double y = part(random);
      mesh.vertices.push_back(corner + Vec3(x, y, part(random)));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// Squares of two triangles in the plane z = 0.3.
TriangleMesh coplanar(std::uint32_t cells) {
  TriangleMesh mesh = scenes::terrain(cells, 2, 1);
  for (Vec3& vertex : mesh.vertices) vertex[2] = 0.3;
  return mesh;
}

/// Around one vertex: the ends on a sphere, or needles through each other.
TriangleMesh star(std::uint32_t count, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  TriangleMesh mesh;
  mesh.vertices.push_back(Vec3::Zero());
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = normal(random);
    const double y = normal(random);
    const Vec3 end = Vec3(x, y, normal(random)).normalized();
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(end);
    mesh.vertices.push_back(end + 1e-3 * end.unitOrthogonal());
    mesh.triangles.push_back({0, first, first + 1});
  }
  return mesh;
}

}  // namespace
}  // namespace collided::bench

int main() {
  using namespace collided::engine;
  using namespace collided;
  using bench::Question;
  std::mt19937_64 random = oracle::seeded(20260613);
  for (const BvhForm form : {BvhForm::fast, BvhForm::best}) {
    bench::run("identical triangles", bench::identical(100'000), form,
               {{"through all", {{0.2, 0.2, 1}, {0, 0, -1}}},
                {"along an edge of all", {{-1, 0, -0.2}, {1, 0, 0.2}}},
                {"through a corner of all", {{0, 0, 1}, {0, 0, -1}}},
                {"past all", {{0.9, 0.9, 1}, {0, 0, -1}}}});
    bench::run("overlapping triangles", bench::overlapping(100'000, random), form,
               {{"through all", {{0, 0, 2}, {0.01, -0.1, -1}}}, {"past all", {{-1, 1, 2}, {0, 0, -1}}}});
    bench::run("coplanar triangles", bench::coplanar(707), form,
               {{"across", {{0.1234, 0.3, 1}, {0, 0, -1}}},
                {"in the plane, along the grid", {{-2, 0.00141, 0.3}, {1, 0, 0}}},
                {"in the plane, askew", {{-2, -1.5, 0.3}, {1, 0.77, 0}}},
                {"a little above", {{-2, -1.5, 0.3 + 1e-15}, {1, 0.77, 0}}}});
    bench::run("one vertex in all", bench::star(1'000'000, random), form,
               {{"to the vertex", {{2, 0.3, 0.1}, {-2, -0.3, -0.1}}},
                {"from the vertex", {{0, 0, 0}, {1, 1, 1}}},
                {"beside the vertex", {{2, 0.3, 0.1}, {-2, -0.3, -0.1 + 1e-3}}},
                {"past half", {{0.5, 0.5, 2}, {0, 0, -1}}}});
  }
  return bench::is_ok ? 0 : 1;
}
