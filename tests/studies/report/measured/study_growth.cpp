#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <random>
#include <thread>

#include "server/broad_phase/grid/grid.hpp"
#include "server/intake/scene.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/report/measured/studies.hpp"

namespace collided::report {
using namespace engine;
namespace {

constexpr double kSide_m = 100;
constexpr std::size_t kNumbers = 7;  // of a ray

double wall(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A terrain as the service holds it.
class Hills {
 public:
  Hills(std::uint32_t triangles, unsigned long long seed) {
    Scene scene;
    scene.name = "hills";
    scene.mesh = scenes::terrain(static_cast<std::uint32_t>(std::sqrt(triangles / 2.0)), kSide_m, seed);
    triangles_ = scene.mesh.triangles.size();
    scene.parts = {{.name = "hills", .first_triangle = 0, .triangle_count = static_cast<std::uint32_t>(triangles_)}};
    world_.add_scene(World::index_scene(std::move(scene), {}));
    world_.step(1, 1, {});
  }
  double triangles() const { return static_cast<double>(triangles_); }

  /// Asked in batches of so many, by so many threads that share them out; hit or miss and the distance of each.
  std::vector<double> ask(std::span<const double> rays, std::size_t batch, unsigned threads) const {
    std::vector<double> distances(rays.size() / kNumbers);
    const auto share = [&](unsigned thread) {
      const SnapshotRing::Lease lease = world_.newest();
      Answers answers;
      QueryScratch scratch;
      for (std::size_t first = thread * batch; first < distances.size(); first += threads * batch) {
        const std::size_t count = std::min(batch, distances.size() - first);
        answer(*lease, {.numbers = rays.subspan(kNumbers * first, kNumbers * count)}, answers, scratch);
        std::size_t hit = 0;
        for (std::size_t i = 0; i < count; ++i) {
          distances[first + i] = answers.hit_counts[i] > 0 ? answers.hits[hit].distance_m : -1;
          hit += answers.hit_counts[i];
        }
      }
    };
    std::vector<std::thread> others;
    for (unsigned thread = 1; thread < threads; ++thread) others.emplace_back(share, thread);
    share(0);
    for (std::thread& other : others) other.join();
    return distances;
  }

 private:
  World world_{WorldOptions{}};
  std::size_t triangles_ = 0;
};

/// Of no common direction, downwards from above the hills.
std::vector<double> rays(std::size_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> along(-0.48 * kSide_m, 0.48 * kSide_m), height(2, 12), turn(-1, 1);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    for (const double number : {along(random), along(random), height(random), turn(random), turn(random),
                                -0.2 - 0.2 * std::abs(turn(random)), 2 * kSide_m}) {
      numbers.push_back(number);
    }
  }
  return numbers;
}

/// A point of a line: what is done in one pass, and for how many answers the truth was another.
struct Point {
  std::string scene;
  double knob;
  std::size_t n;
  std::function<long()> pass;
};

/// Every point `repeats` times, in turn.
std::vector<Row> measure_points(const std::vector<Point>& points, int repeats) {
  std::vector<std::vector<double>> ns(points.size());
  std::vector<long> missed(points.size());
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (std::size_t p = 0; p < points.size(); ++p) {
      ns[p].push_back(1e9 * wall([&] { missed[p] += points[p].pass(); }) / static_cast<double>(points[p].n));
    }
  }
  std::vector<Row> rows;
  for (std::size_t p = 0; p < points.size(); ++p) {
    std::sort(ns[p].begin(), ns[p].end());
    rows.push_back({.study = "growth",
                    .scene = points[p].scene,
                    .series = "collided",
                    .label = short_number(points[p].knob, 3),
                    .knob = points[p].knob,
                    .ns = ns[p][ns[p].size() / 2],
                    .ns_low = ns[p].front(),
                    .ns_high = ns[p].back(),
                    .n = static_cast<long>(points[p].n),
                    .missed = missed[p]});
  }
  return rows;
}

long different(const std::vector<double>& a, const std::vector<double>& b) {
  long count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] == b[i] ? 0 : 1;
  return count;
}

std::vector<Row> over_triangles(const Setting& setting, const std::vector<double>& asked) {
  const std::uint32_t most = setting.quick ? 8'000 : setting.full ? 8'000'000 : 2'000'000;
  std::vector<std::unique_ptr<Hills>> hills;
  std::vector<Point> points;
  for (std::uint32_t triangles = 2'000; triangles <= most; triangles *= 4) {
    const Hills& h = *hills.emplace_back(std::make_unique<Hills>(triangles, setting.seed));
    points.push_back({"triangles", h.triangles(), asked.size() / kNumbers,
                      [&h, &asked, truth = h.ask(asked, 1, 1)] { return different(h.ask(asked, 256, 1), truth); }});
  }
  return measure_points(points, setting.repeats());
}

std::vector<Row> over_batches_and_threads(const Setting& setting, const std::vector<double>& asked) {
  const Hills hills(setting.quick ? 8'000 : 500'000, setting.seed);
  const std::vector<double> truth = hills.ask(asked, 1, 1);
  std::vector<Point> points;
  const std::size_t count = asked.size() / kNumbers;
  const auto point = [&](const char* scene, double knob, std::size_t batch, unsigned threads) {
    points.push_back(
        {scene, knob, count, [&, batch, threads] { return different(hills.ask(asked, batch, threads), truth); }});
  };
  for (std::size_t batch = 1; batch <= count; batch *= 4) point("rays a batch", static_cast<double>(batch), batch, 1);
  const unsigned most = std::max(1U, std::thread::hardware_concurrency());
  for (unsigned threads = 1; threads <= most; threads = threads < most ? std::min(2 * threads, most) : most + 1) {
    point("threads", threads, std::min<std::size_t>(1024, count / most), threads);
  }
  return measure_points(points, setting.repeats());
}

/// Boxes of half a metre to one and a half, one in ten cubic metres, all of them moving.
class Swarm {
 public:
  Swarm(std::size_t count, std::mt19937_64& random) : boxes_(count), velocities_(count) {
    const double edge_m = std::cbrt(10.0 * static_cast<double>(count));
    std::uniform_real_distribution<double> place(0, edge_m), half(0.25, 0.75), speed(-0.1, 0.1);
    for (std::size_t i = 0; i < count; ++i) {
      Vec3 at;
      for (int axis = 0; axis < 3; ++axis) at[axis] = place(random), velocities_[i][axis] = speed(random);
      const Vec3 size = Vec3::Constant(half(random));
      boxes_[i] = {at - size, at + size};
    }
  }
  /// All overlapping pairs after a move.
  std::size_t frame() {
    for (std::size_t i = 0; i < boxes_.size(); ++i)
      boxes_[i] = {boxes_[i].low + velocities_[i], boxes_[i].high + velocities_[i]};
    grid_.rebuild(boxes_);
    return pairs_of_grid();
  }
  std::size_t pairs_of_grid() const {
    std::size_t pairs = 0;
    WalkCost cost;
    grid_.pairs([&](std::uint32_t, std::uint32_t) { return ++pairs > 0; }, cost);
    return pairs;
  }
  std::size_t pairs_one_by_one() const {
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      for (std::size_t k = i + 1; k < boxes_.size(); ++k) pairs += overlaps(boxes_[i], boxes_[k]) ? 1 : 0;
    }
    return pairs;
  }
  std::size_t size() const { return boxes_.size(); }

 private:
  std::vector<Aabb> boxes_;
  std::vector<Vec3> velocities_;
  Grid grid_;
};

std::vector<Row> over_objects(const Setting& setting, std::mt19937_64& random) {
  const std::size_t most = setting.quick ? 4'000 : 1'024'000;
  constexpr std::size_t kChecked = 4'000;  // up to so many, all pairs are compared one by one
  std::vector<Swarm> swarms;
  for (std::size_t count = 1'000; count <= most; count *= 4) swarms.emplace_back(count, random);
  std::vector<Point> points;
  for (Swarm& swarm : swarms) {
    swarm.frame();
    const bool wrong = swarm.size() <= kChecked && swarm.pairs_of_grid() != swarm.pairs_one_by_one();
    points.push_back({"moving objects", static_cast<double>(swarm.size()), swarm.size(), [&swarm, wrong] {
                        swarm.frame();
                        return wrong ? 1L : 0L;
                      }});
  }
  return measure_points(points, setting.repeats());
}

}  // namespace

std::vector<Row> study_growth(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 10);
  const std::vector<double> asked = rays(static_cast<std::size_t>(setting.count(16'384)), random);
  std::vector<Row> rows = over_triangles(setting, asked);
  for (const auto& more : {over_batches_and_threads(setting, asked), over_objects(setting, random)}) {
    rows.insert(rows.end(), more.begin(), more.end());
  }
  return rows;
}

}  // namespace collided::report
