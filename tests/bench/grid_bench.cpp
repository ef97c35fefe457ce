// Rebuild and all overlapping pairs of moving boxes, one thread.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "server/broad_phase/grid.hpp"
#include "tests/bench/clock.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::bench {
namespace {

constexpr int kRepeats = 7;

double milliseconds_since(double start_s) { return 1e3 * (thread_seconds() - start_s); }

/// Unit-sized boxes at a density of one in ten cubic metres, each with a velocity.
struct Movers {
  std::vector<Aabb> boxes;
  std::vector<Vec3> velocities;

  Movers(std::size_t count, double spread, std::mt19937_64& random) {
    std::uniform_real_distribution<double> place(0, std::cbrt(10.0 * static_cast<double>(count)));
    std::uniform_real_distribution<double> size(1 / spread, spread);
    std::uniform_real_distribution<double> speed(-0.1, 0.1);
    for (std::size_t i = 0; i < count; ++i) {
      const double x = place(random);
      const double y = place(random);
      const Vec3 low(x, y, place(random));
      const double edge = size(random);
      boxes.push_back({low, low + Vec3::Constant(edge)});
      const double vx = speed(random);
      const double vy = speed(random);
      velocities.emplace_back(vx, vy, speed(random));
    }
  }
  void step() {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      boxes[i].low += velocities[i];
      boxes[i].high += velocities[i];
    }
  }
};

void run(std::size_t count, double spread, std::mt19937_64& random) {
  Movers movers(count, spread, random);
  Grid grid;
  std::vector<double> rebuild_ms;
  std::vector<double> frame_ms;
  std::size_t pair_count = 0;
  WalkCost cost;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    movers.step();
    pair_count = 0;
    cost = {};
    const double start = thread_seconds();
    grid.rebuild(movers.boxes);
    rebuild_ms.push_back(milliseconds_since(start));
    const auto found = [](void* context, std::uint32_t, std::uint32_t) { ++*static_cast<std::size_t*>(context); };
    grid.pairs(found, &pair_count, cost);
    frame_ms.push_back(milliseconds_since(start));
  }
  std::sort(rebuild_ms.begin(), rebuild_ms.end());
  std::sort(frame_ms.begin(), frame_ms.end());
  std::printf("%8zu movers, sizes 1/%.0f to %.0f: frame %.2f ms [%.2f, %.2f], rebuild %.2f of it; %zu pairs, %.1f rows a mover, "
              "%.0f bytes a mover\n",
              count, spread, spread, frame_ms[kRepeats / 2], frame_ms.front(), frame_ms.back(), rebuild_ms[kRepeats / 2],
              pair_count, static_cast<double>(cost.nodes) / static_cast<double>(count),
              static_cast<double>(grid.bytes()) / static_cast<double>(count));
}

}  // namespace
}  // namespace collided::bench

int main() {
  using namespace collided;
  std::mt19937_64 random = oracle::seeded(20240607);
  for (const double spread : {1.0, 2.0, 8.0}) {
    for (const std::size_t count : {1000, 10'000, 100'000, 1'000'000}) bench::run(count, spread, random);
  }
  return 0;
}
