// Fences in a crowd: what they cost a step. Balls go about on a floor, one publisher for all, at 50 Hz; of the fences, boxes
// of 2 m, one in a hundred stands there and the others where nothing moves. Beside the same crowd without fences.
// usage: fence_bench [--fences N] [--movers N] [--frames N]
//
// Instructions rather than time, which depends on what else the machine does:
//   valgrind --tool=callgrind --toggle-collect='*Fences::decide*' fence_bench --frames 10
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "server/world/fences/fences.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/studies/bench/clock.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr std::int64_t kPeriodNs = 20'000'000;
constexpr double kPeriod_s = 0.02;
constexpr double kSpeed_mps = 2;
constexpr double kSpacing_m = 5;  // of movers, and of fences where nothing moves
constexpr std::size_t kAmongMovers = 100;

struct FenceCrowd {
  std::size_t fences = 100'000;
  std::size_t movers = 10'000;
  int frames = 50;
};

class Floor {
 public:
  Floor(const FenceCrowd& crowd, std::size_t fences, std::mt19937_64 random)
      : world_({.max_objects = static_cast<std::uint32_t>(crowd.movers + 10)}),
        side_m_(kSpacing_m * std::sqrt(static_cast<double>(crowd.movers))) {
    std::uniform_real_distribution<double> part(0, 1);
    const auto anywhere = [&] { return Vec3(side_m_ * part(random), side_m_ * part(random), 0); };
    for (std::size_t i = 0; i < crowd.movers; ++i) {
      poses_.push_back({.position = anywhere()});
      const double turn = 7 * part(random);
      velocities_.push_back(kSpeed_mps * Vec3(std::cos(turn), std::sin(turn), 0));
      ObjectDefinition definition{
          .name = "ball_" + std::to_string(i), .scene = "", .shape = {}, .pose = poses_.back(), .filter = {}};
      // They pass through each other: contacts are not what is measured.
      definition.filter = {.layers = 1, .mask = 0, .group = 0};
      definition.shape.primitives.emplace_back(Sphere{Vec3::Zero(), 0.3});
      definition.publisher = 1;
      ids_.push_back(std::get<ObjectId>(world_.define(definition)));
    }
    const auto far_side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(fences))));
    for (std::size_t i = 0; i < fences; ++i) {
      const Vec3 far_off(2 * side_m_ + kSpacing_m * static_cast<double>(i % far_side),
                         kSpacing_m * static_cast<double>(i / far_side), 0);
      add_fence(i, i % kAmongMovers == 0 ? anywhere() : far_off);
    }
    moved_ = std::make_unique<bool[]>(crowd.movers);
    frame();
    frame();
  }

  /// Seconds of a step in which every ball moves.
  double frame() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      for (int k = 0; k < 2; ++k) {
        const double next_m = poses_[i].position[k] + kPeriod_s * velocities_[i][k];
        if (next_m < 0 || next_m > side_m_) velocities_[i][k] *= -1;
      }
      poses_[i].position += kPeriod_s * velocities_[i];
    }
    const double started = thread_seconds();
    time_ns_ += kPeriodNs;
    world_.move(ids_, poses_, time_ns_, false, std::span(moved_.get(), ids_.size()));
    world_.advance(1, time_ns_);
    if (!world_.step(time_ns_, 1, {})) std::abort();
    if (world_.fences() != nullptr) events_ += world_.fences()->events().size();
    return thread_seconds() - started;
  }
  std::uint64_t take_events() { return std::exchange(events_, 0); }

 private:
  void add_fence(std::size_t number, const Vec3& center) {
    FenceDefinition fence{.name = "fence_" + std::to_string(number)};
    fence.shape.primitives.emplace_back(Box{.center = center, .half_m = Vec3(1, 1, 1)});
    if (!std::holds_alternative<ObjectId>(world_.add_fence(fence))) std::abort();
  }

  World world_;
  double side_m_;
  std::vector<ObjectId> ids_;
  std::vector<Pose> poses_;
  std::vector<Vec3> velocities_;
  std::unique_ptr<bool[]> moved_;
  std::int64_t time_ns_ = 1'000'000'000'000;
  std::uint64_t events_ = 0;
};

void report(const FenceCrowd& crowd, std::size_t fences, const std::mt19937_64& random) {
  Floor floor(crowd, fences, random);
  floor.take_events();
  double seconds = 0;
  for (int i = 0; i < crowd.frames; ++i) seconds += floor.frame();
  seconds /= crowd.frames;
  std::printf("%zu fences, %zu movers: %.2f ms a step, %.0f %% of a core at 50 Hz, %.1f events a step\n", fences,
              crowd.movers, 1e3 * seconds, 100 * seconds / kPeriod_s,
              static_cast<double>(floor.take_events()) / crowd.frames);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  bench::FenceCrowd crowd;
  for (int i = 1; i + 1 < argc; i += 2) {
    const long value = std::atol(argv[i + 1]);
    if (value < 0) return 2;
    if (std::strcmp(argv[i], "--fences") == 0) crowd.fences = static_cast<std::size_t>(value);
    else if (std::strcmp(argv[i], "--movers") == 0) crowd.movers = static_cast<std::size_t>(value);
    else if (std::strcmp(argv[i], "--frames") == 0) crowd.frames = static_cast<int>(value);
    else return 2;
  }
  const std::mt19937_64 random = oracle::seeded(20261127);
  bench::report(crowd, 0, random);
  bench::report(crowd, crowd.fences, random);
  return 0;
}
