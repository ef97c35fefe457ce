#include <algorithm>
#include <cmath>
#include <chrono>
#include <functional>
#include <memory>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "tests/oracle/plain_bvh.hpp"
#include "tests/oracle/polygon_bsp.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/report/measured/studies.hpp"

namespace collided::report {
using namespace engine;
namespace {

using oracle::FirstHit;
using oracle::PlainCost;

/// One index over a mesh, ready to be asked.
struct Form {
  std::string series;
  std::function<FirstHit(const Ray&, PlainCost&)> ask{};
  double references = 0;
  double bytes = 0;
  double build_ms = 0;
};

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

FirstHit ask_tree(const Bvh& tree, const TriangleMesh& mesh, const Ray& ray, PlainCost& cost) {
  FirstHit first{};
  const auto candidate = [&](std::uint32_t triangle, const Triangle&, double) {
    first.take(mesh, triangle, ray);
    return first.s * (1 + 1e-12);
  };
  WalkCost walk;
  tree.walk_ray(ray, std::numeric_limits<double>::infinity(), 0, mesh, candidate, walk);
  cost.nodes += walk.nodes;
  cost.tests += walk.candidates;
  return first;
}

Form wide(const TriangleMesh& mesh) {
  const auto start = std::chrono::steady_clock::now();
  const auto tree = std::make_shared<const Bvh>(Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}}));
  const BvhReport& report = tree->report();
  return {"ours: wide tree",
          [&mesh, tree](const Ray& ray, PlainCost& cost) { return ask_tree(*tree, mesh, ray, cost); },
          static_cast<double>(report.references), static_cast<double>(report.bytes), milliseconds_since(start)};
}

template <class Tree, class... More>
Form plain(const std::string& series, const TriangleMesh& mesh, More&... more) {
  const auto start = std::chrono::steady_clock::now();
  const auto tree = std::make_shared<const Tree>(mesh, more...);
  return {series, [tree](const Ray& ray, PlainCost& cost) { return tree->first_hit(ray, cost); },
          static_cast<double>(tree->references()), static_cast<double>(tree->bytes()), milliseconds_since(start)};
}

/// Through the scene, half of them at a triangle.
std::vector<Ray> rays_for(const TriangleMesh& mesh, int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const auto point = [&] {
    const double x = number(random);
    const double y = number(random);
    return Vec3(x, y, number(random));
  };
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Triangle aim = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const Vec3 from = 1.2 * point();
    const Vec3 to = i % 2 == 0 ? Vec3((aim.a + aim.b + aim.c) / 3) : point();
    rays.push_back({from, to - from});
  }
  return rays;
}

std::vector<Row> compare(const std::string& scene, const TriangleMesh& mesh, const Setting& setting,
                         std::mt19937_64& random) {
  const std::vector<Ray> rays = rays_for(mesh, setting.count(1000), random);
  const Form forms[] = {wide(mesh), plain<oracle::PlainBvh>("plain, across the axes", mesh),
                        plain<oracle::PolygonBsp>("plain, along the polygons", mesh, random)};
  std::vector<FirstHit> truth;
  for (const Ray& ray : rays) truth.push_back(oracle::first_hit(mesh, ray));
  const auto triangles = static_cast<double>(mesh.triangles.size());
  const auto questions = static_cast<double>(rays.size());
  std::vector<std::vector<double>> ns(std::size(forms));
  std::vector<Row> rows;
  for (int repeat = 0; repeat < setting.repeats(); ++repeat) {
    rows.clear();
    for (std::size_t f = 0; f < std::size(forms); ++f) {
      const Form& form = forms[f];
      std::vector<FirstHit> answers(rays.size());
      PlainCost cost;
      const double seconds = timed([&] {
        for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = form.ask(rays[i], cost);
      });
      ns[f].push_back(1e9 * seconds / questions);
      Row row{.study = "index",
              .scene = scene,
              .series = form.series,
              .label = short_number(triangles, 3),
              .knob = triangles,
              .n = static_cast<long>(rays.size())};
      for (std::size_t i = 0; i < rays.size(); ++i) row.missed += answers[i] == truth[i] ? 0 : 1;
      row.nodes = static_cast<double>(cost.nodes) / questions;
      row.tests = static_cast<double>(cost.tests) / questions;
      row.references = form.references / triangles;
      row.bytes = form.bytes / triangles;
      row.build_ms = form.build_ms;
      rows.push_back(row);
    }
  }
  for (std::size_t f = 0; f < std::size(forms); ++f) {
    std::sort(ns[f].begin(), ns[f].end());
    rows[f].ns_low = ns[f].front();
    rows[f].ns = ns[f][ns[f].size() / 2];
    rows[f].ns_high = ns[f].back();
  }
  return rows;
}

}  // namespace

std::vector<Row> study_index(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 9);
  const std::uint32_t most = setting.quick ? 2'000 : setting.full ? 128'000 : 32'000;
  std::vector<Row> rows;
  for (std::uint32_t triangles = 500; triangles <= most; triangles *= 4) {
    const auto cells = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0));
    const double gap = 1.5 / std::cbrt(triangles);
    for (const auto& found :
         {compare("terrain", scenes::terrain(cells, 2, setting.seed), setting, random),
          compare("loose triangles", scenes::scattered(triangles, gap, setting.seed), setting, random)}) {
      rows.insert(rows.end(), found.begin(), found.end());
    }
  }
  return rows;
}

}  // namespace collided::report
