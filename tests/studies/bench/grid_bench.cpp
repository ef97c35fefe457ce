// A frame of moving boxes: the grid rebuilt and all overlapping pairs, one thread, beside the trees and the sweep of the
// distribution on the same frames; then the worst cases, and how a frame grows with the number of objects.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/broad_phase/sweep_and_prune/sweep_and_prune.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/movers.hpp"
#include "tests/studies/bench/peers/frame_peers.hpp"
#include "tests/studies/bench/rows.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using MakePeer = std::unique_ptr<FramePeer> (*)(std::span<const Aabb>);
const std::vector<MakePeer> kPeers{
#ifdef COLLIDED_BENCH_BULLET
    bullet_frames,
    bullet_sweep_frames,
#endif
#ifdef COLLIDED_BENCH_CGAL
    cgal_frames,
#endif
#ifdef COLLIDED_BENCH_FCL
    fcl_frames,
#endif
};

class OurFrames {
 public:
  /// At most so many pairs: the walk ends there.
  std::size_t frame(std::span<const Aabb> boxes, std::size_t most = SIZE_MAX) {
    grid_.rebuild(boxes);
    std::size_t pairs = 0;
    WalkCost cost;
    const auto found = [&](std::uint32_t, std::uint32_t) { return ++pairs < most; };
    grid_.pairs(found, cost);
    return pairs;
  }
  std::size_t bytes() const { return grid_.bytes(); }

 private:
  Grid grid_;
};

class OurSweeps {
 public:
  std::size_t frame(std::span<const Aabb> boxes) {
    sweep_.update(boxes);
    std::size_t pairs = 0;
    WalkCost cost;
    const auto found = [&](std::uint32_t, std::uint32_t) { return ++pairs > 0; };
    sweep_.pairs(found, cost);
    swaps_ += sweep_.report().swaps;
    ++frames_;
    return pairs;
  }
  double bytes() const { return static_cast<double>(sweep_.bytes()); }
  double swaps_a_frame() const { return static_cast<double>(swaps_) / static_cast<double>(frames_); }

 private:
  SweepAndPrune sweep_;
  std::uint64_t swaps_ = 0;
  std::uint64_t frames_ = 0;
};

/// Nanoseconds of a frame by number of objects.
using Growth = std::map<std::size_t, double>;

void run(const Options& options, std::size_t count, const std::string& kind, Motion motion, std::mt19937_64& random,
         Growth& growth) {
  const std::string work = motion == Motion::flight ? "frame" : "frame, teleported";
  if (!options.wants(kind, work)) return;
  Movers movers(count, kind, motion, random);
  OurFrames ours;
  std::vector<std::unique_ptr<FramePeer>> peers;
  for (const auto& make : kPeers) {
    if (auto peer = make(movers.boxes())) peers.push_back(std::move(peer));
  }
  movers.step();
  const std::size_t pairs = ours.frame(movers.boxes());
  std::vector<Method> methods{{.name = "collided",
                               .run = [&] { ours.frame(movers.boxes()); },
                               .bytes_each = static_cast<double>(ours.bytes()) / static_cast<double>(count),
                               .equal = pairs,
                               .of = pairs,
                               .prepare = [&] { movers.step(); }}};
  OurSweeps sweeps;
  // Most of a million boxes in a cube overlap a hundred others on any axis.
  if (count <= 100'000 || kind == "in a line") {
    const std::size_t found = sweeps.frame(movers.boxes());
    methods.push_back({.name = "collided, sweep",
                       .run = [&] { sweeps.frame(movers.boxes()); },
                       .bytes_each = sweeps.bytes() / static_cast<double>(count),
                       .equal = std::min(found, pairs),
                       .of = std::max(found, pairs)});
  }
  for (const auto& peer : peers) {
    const std::size_t found = peer->frame(movers.boxes());
    methods.push_back({.name = peer->name(),
                       .run = [&movers, p = peer.get()] { p->frame(movers.boxes()); },
                       .equal = std::min(found, pairs),
                       .of = std::max(found, pairs)});
  }
  measure(options, {kind, count, work, 1, std::to_string(pairs) + " pairs"}, methods);
  std::printf("%s, %zu: %.0f swaps a frame\n", kind.c_str(), count, sweeps.swaps_a_frame());
  std::sort(methods[0].ns.begin(), methods[0].ns.end());
  growth[count] = methods[0].ns[methods[0].ns.size() / 2];
}

/// Of the least-squares line through the logarithms.
double slope(const Growth& growth) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [size, ns] : growth) {
    const double x = std::log(static_cast<double>(size));
    const double y = std::log(ns);
    n += 1;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// A hundred thousand boxes in one cell, where a grid has nothing to go by: all of them compared, a bounded memory.
void run_crowd(const Options& options, const std::string& kind, std::size_t most, std::mt19937_64& random) {
  constexpr std::size_t kCount = 100'000;
  if (!options.wants(kind, "crowd")) return;
  const Movers movers(kCount, kind, Motion::flight, random);
  OurFrames ours;
  const std::size_t pairs = ours.frame(movers.boxes(), most);
  std::vector<Method> methods{{.name = "collided",
                               .run = [&] { ours.frame(movers.boxes(), most); },
                               .bytes_each = static_cast<double>(ours.bytes()) / kCount,
                               .equal = pairs,
                               .of = pairs}};
  measure(options, {kind, kCount, "crowd", 1, std::to_string(pairs) + " pairs told"}, methods);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(20240607);
  for (const bench::Motion motion : {bench::Motion::flight, bench::Motion::teleport}) {
    for (const char* kind : {"uniform", "clustered", "one giant", "sizes 1/8 to 8", "in a line"}) {
      bench::Growth growth;
      for (const std::size_t count : {50, 1'000, 10'000, 100'000, 1'000'000}) {
        if (options.quick && count > 100'000) continue;
        // Somewhere else in every frame, clusters and uniform are the same.
        if (motion == bench::Motion::teleport && kind != std::string("uniform")) continue;
        bench::run(options, count, kind, motion, random, growth);
      }
      if (growth.size() > 1)
        std::printf("%s: time grows with the objects to the power of %.3f\n", kind, bench::slope(growth));
    }
  }
  bench::run_crowd(options, "in one cell", SIZE_MAX, random);
  bench::run_crowd(options, "in one point", 10'000'000, random);
  return 0;
}
