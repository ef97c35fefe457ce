#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <random>

#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/scene_answers.hpp"
#include "tests/studies/growth/engine_laws.hpp"

namespace collided::growth {
using namespace engine;
namespace {

constexpr double kSize_m = 100;
constexpr int kRepeats = 5;

/// Of all threads: an index is built by several.
double process_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Middles of triangles drawn at random.
std::vector<double> points_on(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const Vec3 middle = (t.a + t.b + t.c) / 3;
    points.insert(points.end(), {middle[0], middle[1], middle[2], std::numeric_limits<double>::infinity()});
  }
  return points;
}

struct TerrainQuestions {
  std::vector<double> rays;
  std::vector<double> points;
};

/// The same for all sizes: rays from above in all directions and points near the ground, none next to the one before.
TerrainQuestions questions(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(-0.48 * kSize_m, 0.48 * kSize_m), height(2, 12), turn(-1, 1);
  TerrainQuestions asked;
  for (std::size_t i = 0; i < count; ++i) {
    asked.rays.insert(asked.rays.end(), {along(random), along(random), height(random), turn(random), turn(random),
                                         -0.2 - 0.2 * turn(random), 2 * kSize_m});
    asked.points.insert(asked.points.end(),
                        {along(random), along(random), height(random), std::numeric_limits<double>::infinity()});
  }
  return asked;
}

template <class Ask>
Sample time_of(double x, std::size_t count, Ask&& ask) {
  std::vector<double> ns;
  ask();
  for (int i = 0; i < kRepeats; ++i) {
    const double started = bench::thread_seconds();
    ask();
    ns.push_back(1e9 * (bench::thread_seconds() - started) / static_cast<double>(count));
  }
  return sample_of(x, std::move(ns));
}

}  // namespace

std::vector<double> half_decades(double low, double high) {
  std::vector<double> sizes;
  for (int i = static_cast<int>(std::lround(2 * std::log10(low))); i <= 2 * std::log10(high) + 0.01; ++i)
    sizes.push_back(std::round(std::pow(10, i / 2.0)));
  return sizes;
}

std::vector<Law> triangle_laws(const GrowthSetting& setting) {
  const std::string caches =
      "the nodes it visits grow as theory says (their own row); each is fetched from farther away once the index is "
      "larger "
      "than a cache";
  std::vector<Law> laws{
      {.knob = "triangles",
       .what = "index: built",
       .unit = "ms",
       .theory = {1, true},
       .reason = "the tree is as deep as a logarithm, but most of its levels fit the caches; below some 10,000 a split "
                 "costs more "
                 "than its triangles"},
      {.knob = "triangles", .what = "index and mesh: memory", .unit = "bytes", .theory = {1}},
      {.knob = "triangles", .what = "ray, nearest hit", .unit = "ns", .theory = {0, true}, .reason = caches},
      {.knob = "triangles", .what = "ray, nearest hit: nodes", .unit = "nodes", .theory = {0, true}},
      {.knob = "triangles", .what = "ray, any hit", .unit = "ns", .theory = {0, true}, .reason = caches},
      {.knob = "triangles", .what = "nearest point, from on it", .unit = "ns", .theory = {0, true}, .reason = caches},
      {.knob = "triangles", .what = "nearest point, from on it: nodes", .unit = "nodes", .theory = {0, true}},
      // From a height h, boxes as thick as their triangles are wide, w, hide which is nearest within an area of h w.
      {.knob = "triangles", .what = "nearest point, from metres above", .unit = "ns", .theory = {0.5}}};
  const std::size_t count = setting.quick ? 500 : 10'000;
  const TerrainQuestions asked = questions(count, setting.seed);
  for (const double size : half_decades(1'000, setting.quick ? 100'000 : 1e7)) {
    const TriangleMesh mesh = scenes::terrain(static_cast<std::uint32_t>(std::sqrt(size / 2)), kSize_m, 7);
    const auto x = static_cast<double>(mesh.triangles.size());
    std::vector<double> build_ms;
    for (int i = 0; i < (size > 1e6 ? 1 : 3); ++i) {
      const double started = process_seconds();
      const bench::SceneAnswers built(mesh);
      build_ms.push_back(1e3 * (process_seconds() - started));
    }
    bench::SceneAnswers scene(mesh);
    double nodes = 0;
    const auto ask = [&](QuestionKind kind, HitMode mode, const std::vector<double>& numbers) {
      return time_of(x, count, [&] {
        const Answers& answers = scene.ask(kind, mode, numbers, 1);
        nodes = 0;
        for (const std::uint32_t visited : answers.nodes) nodes += visited;
      });
    };
    laws[0].samples.push_back(sample_of(x, build_ms));
    laws[1].samples.push_back(sample_of(x, {x * scene.bytes_a_triangle()}));
    laws[2].samples.push_back(ask(QuestionKind::ray, HitMode::closest, asked.rays));
    laws[3].samples.push_back(sample_of(x, {nodes / static_cast<double>(count)}));
    laws[4].samples.push_back(ask(QuestionKind::ray, HitMode::any, asked.rays));
    laws[5].samples.push_back(ask(QuestionKind::near, HitMode::closest, points_on(mesh, count, setting.seed)));
    laws[6].samples.push_back(sample_of(x, {nodes / static_cast<double>(count)}));
    laws[7].samples.push_back(ask(QuestionKind::near, HitMode::closest, asked.points));
    std::printf("%.0f triangles\n", x);
    std::fflush(stdout);
  }
  return laws;
}

}  // namespace collided::growth
