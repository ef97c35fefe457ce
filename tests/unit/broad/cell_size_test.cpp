// A54: finding the right size of a cell can be difficult. A plain grid is tried with cells from a quarter of a mean box to
// sixteen; the engine's grid, which chooses for itself, takes at most 1.3 times as long as the best of them, in five scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include "server/broad_phase/grid/grid.hpp"
#include "tests/oracle/box_pairs.hpp"
#include "tests/oracle/plain_grid.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using oracle::BoxPairs;

template <class Work>
double best_ms(int repeats, Work work) {
  double best = INFINITY;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
    best = std::min(best, taken.count());
  }
  return best;
}

class Scenes {
 public:
  explicit Scenes(std::mt19937_64& random) : random_(random) {}

  std::vector<Aabb> operator()(const std::string& kind) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < kCount; ++i) {
      Vec3 size = Vec3::Ones();
      Vec3 low = 32 * Vec3(unit(), unit(), unit());
      if (kind == "sizes 1/8 to 8") size *= std::exp2(6 * unit() - 3) / 2;
      if (kind == "clusters")
        low = 8 * ((low / 8).array().floor() + 0.3 * Vec3(unit(), unit(), unit()).array()).matrix();
      if (kind == "on a floor") low[2] = 0.01 * unit(), low[0] *= 4, low[1] *= 4;
      if (kind == "one giant" && i == 0) low = Vec3::Zero(), size *= 32;
      boxes.push_back({low, low + size});
    }
    return boxes;
  }

 private:
  static constexpr std::size_t kCount = 3'000;
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  std::mt19937_64& random_;
};

double mean_size_m(const std::vector<Aabb>& boxes) {
  double sum = 0;
  for (const Aabb& box : boxes) sum += (box.high - box.low).mean();
  return sum / static_cast<double>(boxes.size());
}

double ours_ms(const std::vector<Aabb>& boxes, std::size_t pair_count) {
  Grid grid;
  return best_ms(9, [&] {
    grid.rebuild(boxes);
    std::size_t found = 0;
    WalkCost cost;
    grid.pairs([&](std::uint32_t, std::uint32_t) { return ++found > 0; }, cost);
    EXPECT_EQ(found, pair_count);
  });
}

TEST(BroadCellSize, TheGridsOwnChoiceIsWithinAThirdOfTheBestOfManySizes) {
  std::mt19937_64 random = oracle::seeded(54);
  Scenes scenes(random);
  for (const char* kind : {"uniform", "sizes 1/8 to 8", "clusters", "on a floor", "one giant"}) {
    const std::vector<Aabb> boxes = scenes(kind);
    const BoxPairs truth = oracle::pairs_by_force(boxes);
    const double mean_m = mean_size_m(boxes);
    double best = INFINITY, worst = 0;
    std::printf("%s:", kind);
    for (const double factor : {0.25, 0.5, 1.0, 1.5, 2.0, 4.0, 8.0, 16.0}) {
      oracle::PlainGrid plain(factor * mean_m);
      BoxPairs found;
      const double ms = best_ms(2, [&] {
        found.clear();
        plain.pairs(boxes, [&](std::uint32_t i, std::uint32_t j) { found.emplace_back(i, j); });
      });
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, truth) << kind << ", cells of " << factor;
      std::printf(" %.2f ms at %g", ms, factor);
      best = std::min(best, ms), worst = std::max(worst, ms);
    }
    const double ours = ours_ms(boxes, truth.size());
    std::printf("; ours %.2f ms\n", ours);
    EXPECT_LE(ours, 1.3 * best) << kind;
    EXPECT_GT(worst, 3 * best) << kind << ": the size does not matter, and the scene shows nothing";
  }
}

}  // namespace
}  // namespace collided::engine
