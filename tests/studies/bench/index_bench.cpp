// The static index's life outside the walks: how long until the first answer with and without a saved index, what a
// build takes in both forms, what they cost and bring.
// A ratio is of medians of kRepeats interleaved runs, with the range of the runs' own ratios.

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <random>

#include "server/intake/scene_file/scene_file.hpp"
#include "server/intake/scene_file/scene_index.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/closest_hit.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr int kRepeats = 5;

double wall_seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Repeats {
  std::array<double, kRepeats> s{};

  double median() const {
    auto sorted = s;
    std::sort(sorted.begin(), sorted.end());
    return sorted[kRepeats / 2];
  }
};

void print_ratio(const char* what, const Repeats& above, const Repeats& below) {
  std::array<double, kRepeats> each{};
  for (std::size_t i = 0; i < kRepeats; ++i) each[i] = above.s[i] / below.s[i];
  const auto [least, most] = std::minmax_element(each.begin(), each.end());
  std::printf("  %-58s %6.2f [%.2f, %.2f]\n", what, above.median() / below.median(), *least, *most);
}

std::vector<Ray> rays_through(const Aabb& bounds, std::size_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(0, 1);
  const auto point = [&] {
    const double x = part(random);
    const double y = part(random);
    return Vec3(bounds.low + Vec3(x, y, part(random)).cwiseProduct(bounds.high - bounds.low));
  };
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 from = point();
    rays.push_back({from, point() - from});
  }
  return rays;
}

/// The sum of all answers, so that trees can be compared.
double cast_all(const Bvh& tree, const TriangleMesh& mesh, const std::vector<Ray>& rays, WalkCost& cost) {
  double sum = 0;
  for (const Ray& ray : rays) {
    const ClosestHit closest = closest_hit(tree, mesh, ray, cost);
    if (closest.triangle != kNoTriangle) sum += closest.s;
  }
  return sum;
}

/// From a file on the disk to the first answer, as the server does it.
double first_answer(const std::string& path, IndexedScene& kept) {
  return wall_seconds([&] {
    LoadReport report;
    Scene scene = load_scene(path, {}, report);
    kept = World::index_scene(std::move(scene), {});
    WalkCost cost;
    const Vec3 middle = kept.geometry->tree.bounds().low / 2 + kept.geometry->tree.bounds().high / 2;
    cast_all(kept.geometry->tree, kept.geometry->mesh, {{middle + Vec3(0, 0, 1e3), Vec3(0, 0, -1)}}, cost);
  });
}

void print_tree(const char* name, const TriangleMesh& mesh, const BvhReport& report) {
  const auto count = static_cast<double>(mesh.triangles.size());
  const double mesh_bytes = static_cast<double>(mesh.vertices.size() * sizeof(Vec3)) / count + sizeof(TriangleCorners);
  std::printf(
      "  %-8s %5.0f ms, %.3f references, %.1f bytes + mesh %.1f = %.1f a triangle, peak of the build %.1f, depth %u\n",
      name, 1e3 * report.build_s, static_cast<double>(report.references) / count,
      static_cast<double>(report.bytes) / count, mesh_bytes, static_cast<double>(report.bytes) / count + mesh_bytes,
      static_cast<double>(report.peak_bytes) / count, report.depth);
}

void run_forms(const char* name, const TriangleMesh& mesh, std::size_t ray_count, std::mt19937_64& random) {
  std::printf("%s: %zu triangles\n", name, mesh.triangles.size());
  const Bvh fast = Bvh::build(mesh, {.progress = {}, .cancelled = {}});
  const Bvh best = Bvh::build(mesh, {.progress = {}, .cancelled = {}, .form = BvhForm::best});
  print_tree("fast", mesh, fast.report());
  print_tree("best", mesh, best.report());
  const std::vector<Ray> rays = rays_through(fast.bounds(), ray_count, random);
  Repeats fast_s;
  Repeats best_s;
  WalkCost fast_cost;
  WalkCost best_cost;
  for (std::size_t i = 0; i < kRepeats; ++i) {
    double fast_sum = 0;
    double best_sum = 0;
    double start = thread_seconds();
    fast_sum = cast_all(fast, mesh, rays, fast_cost);
    fast_s.s[i] = thread_seconds() - start;
    start = thread_seconds();
    best_sum = cast_all(best, mesh, rays, best_cost);
    best_s.s[i] = thread_seconds() - start;
    if (fast_sum != best_sum) std::printf("  ANSWERS DIFFER: %.17g, %.17g\n", fast_sum, best_sum);
  }
  const auto all = static_cast<double>(rays.size() * kRepeats);
  std::printf("  a ray: nodes %.2f fast, %.2f best; candidates %.2f fast, %.2f best\n", fast_cost.nodes / all,
              best_cost.nodes / all, fast_cost.candidates / all, best_cost.candidates / all);
  print_ratio("rays, time of fast over best", fast_s, best_s);
}

void run_saved(const TriangleMesh& mesh, std::mt19937_64& random) {
  const std::string stem = std::filesystem::temp_directory_path() / ("index_bench_" + std::to_string(::getpid()));
  const std::string with = stem + "_with.cscene";
  const std::string without = stem + "_without.cscene";
  Scene scene{.name = "s", .mesh = mesh, .parts = {{"s", 0, static_cast<std::uint32_t>(mesh.triangles.size()), {}}}};
  save_scene(without, scene);
  const auto bytes = std::make_shared<const std::vector<std::byte>>(Bvh::build(mesh).saved(mesh));
  scene.index = {*bytes, bytes};
  save_scene(with, scene);
  const auto count = static_cast<double>(mesh.triangles.size());
  std::printf("saved: %zu triangles, file %.1f bytes a triangle with index, %.1f without\n", mesh.triangles.size(),
              static_cast<double>(std::filesystem::file_size(with)) / count,
              static_cast<double>(std::filesystem::file_size(without)) / count);
  Repeats with_s;
  Repeats without_s;
  Repeats build_s;
  Repeats check_s;
  IndexedScene mapped;
  IndexedScene built;
  for (std::size_t i = 0; i < kRepeats; ++i) {
    without_s.s[i] = first_answer(without, built);
    with_s.s[i] = first_answer(with, mapped);
    build_s.s[i] = built.geometry->tree.report().build_s;
    check_s.s[i] = mapped.geometry->tree.report().build_s;
    if (!mapped.geometry->tree.report().is_loaded) std::printf("  NOT LOADED\n");
  }
  std::printf("  first answer after %.0f ms with, %.0f ms without; of that check %.0f ms, build %.0f ms\n",
              1e3 * with_s.median(), 1e3 * without_s.median(), 1e3 * check_s.median(), 1e3 * build_s.median());
  print_ratio("time until the first answer, without over with", without_s, with_s);
  print_ratio("build over check", build_s, check_s);
  Repeats mapped_s;
  Repeats built_s;
  const std::vector<Ray> rays = rays_through(built.geometry->tree.bounds(), 100'000, random);
  WalkCost cost;
  for (std::size_t i = 0; i < kRepeats; ++i) {
    double start = thread_seconds();
    const double a = cast_all(mapped.geometry->tree, mapped.geometry->mesh, rays, cost);
    mapped_s.s[i] = thread_seconds() - start;
    start = thread_seconds();
    const double b = cast_all(built.geometry->tree, built.geometry->mesh, rays, cost);
    built_s.s[i] = thread_seconds() - start;
    if (a != b) std::printf("  ANSWERS DIFFER\n");
  }
  print_ratio("rays, time on the mapped index over the built one", mapped_s, built_s);
  std::filesystem::remove(with);
  std::filesystem::remove(without);
}

/// Long slanted needles among small triangles.
TriangleMesh needles(std::uint32_t count, std::mt19937_64& random) {
  TriangleMesh mesh = scenes::scattered(count, 0.01, random());
  scenes::append(mesh, scenes::slanted(count / 50, 1, random()));
  return mesh;
}

/// Towers of two triangles a wall on a plain of two, turned against the axes.
TriangleMesh city(std::uint32_t side, std::mt19937_64& random) {
  std::uniform_real_distribution<double> height(0.5, 12);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const double half_z = height(random) / 2;
    scenes::append(mesh, scenes::box({0.4, 0.3, half_z}, {double(i % side), double(i / side), half_z}));
  }
  scenes::append(mesh, scenes::box({side / 2.0, side / 2.0, 0.1}, {side / 2.0, side / 2.0, -0.1}));
  const Mat3 turn = Quat(0.9, 0.1, 0.2, 0.37).normalized().toRotationMatrix();
  for (Vec3& vertex : mesh.vertices) vertex = turn * vertex;
  return mesh;
}

}  // namespace
}  // namespace collided::bench

int main() {
  using namespace collided::engine;
  using namespace collided;
  std::mt19937_64 random = oracle::seeded(20260611);
  const TriangleMesh terrain = scenes::terrain(707, 1000, 7);
  bench::run_saved(terrain, random);
  bench::run_forms("terrain", terrain, 50'000, random);
  bench::run_forms("needles", bench::needles(200'000, random), 50'000, random);
  bench::run_forms("city, turned", bench::city(130, random), 50'000, random);
  bench::run_forms("scattered", scenes::scattered(200'000, 0.05, 5), 50'000, random);
  return 0;
}
