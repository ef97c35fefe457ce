#include <cstdio>
#include <functional>

#include "tests/studies/bench/asked_world.hpp"
#include "tests/studies/growth/engine_laws.hpp"

namespace collided::growth {
namespace {

constexpr int kChanges = 200;
constexpr int kRepeats = 5;

/// Microseconds each, of many changes, several times.
std::vector<double> repeated(const std::function<double()>& change) {
  std::vector<double> us;
  for (int i = 0; i < kRepeats; ++i) {
    double seconds = 0;
    for (int k = 0; k < kChanges; ++k) seconds += change();
    us.push_back(1e6 * seconds / kChanges);
  }
  return us;
}

}  // namespace

std::vector<Law> change_laws(const GrowthSetting& setting) {
  const char* const kCaches = "names and poses of more than some 10,000 objects are larger than the caches";
  std::vector<Law> laws{
      {.knob = "objects", .what = "two patterns in turn, a ray each", .unit = "us", .theory = {0}, .reason = kCaches},
      {.knob = "objects", .what = "pattern's first ray after a join", .unit = "us", .theory = {0}, .reason = kCaches},
      {.knob = "objects",
       .what = "one joins: step and next ray",
       .unit = "us",
       .theory = {0},
       .reason = "a sixteenth of the index is copied as boxes; they are larger than the caches"},
      {.knob = "objects", .what = "one leaves: step and next ray", .unit = "us", .theory = {0}, .reason = kCaches},
      {.knob = "scenes",
       .what = "ray, nearest hit, one density",
       .unit = "us",
       .theory = {0},
       .reason = "trees of more than some 1,000 scenes are larger than the caches"},
      {.knob = "pile", .what = "one of them moves: step", .unit = "us", .theory = {1}}};
  for (const double size : half_decades(100, setting.quick ? 10'000 : 1e6)) {
    bench::JoiningCrowd crowd(static_cast<std::size_t>(size), std::mt19937_64(setting.seed));
    laws[0].samples.push_back(sample_of(size, repeated([&] { return crowd.ask_in_turn(); })));
    laws[1].samples.push_back(sample_of(size, repeated([&] { return crowd.ask_after_join(); })));
    laws[2].samples.push_back(sample_of(size, repeated([&] { return crowd.join(); })));
    laws[3].samples.push_back(sample_of(size, repeated([&] { return crowd.leave(); })));
    std::printf("%.0f objects\n", size);
    std::fflush(stdout);
  }
  for (const double size : half_decades(10, setting.quick ? 1'000 : 10'000)) {
    std::mt19937_64 random(setting.seed);
    const double side_m = 4 * std::cbrt(size);
    bench::ManyScenes scenes(static_cast<std::size_t>(size), side_m, random);
    const std::vector<double> rays = bench::questions_about(engine::QuestionKind::ray, side_m, kChanges, random);
    laws[4].samples.push_back(sample_of(size, repeated([&] {
                                          const double started = bench::thread_seconds();
                                          scenes.ask({.numbers = rays});
                                          return (bench::thread_seconds() - started) / kChanges;
                                        })));
    std::printf("%.0f scenes\n", size);
    std::fflush(stdout);
  }
  for (const double size : half_decades(10, setting.quick ? 1'000 : 3'000)) {
    bench::BoxPile pile(static_cast<std::size_t>(size), std::mt19937_64(setting.seed));
    laws[5].samples.push_back(sample_of(size, repeated([&] { return pile.move_one(); })));
    std::printf("pile of %.0f\n", size);
    std::fflush(stdout);
  }
  return laws;
}

}  // namespace collided::growth
