// Worlds that move, one thread: questions among movers, alone and over a mesh, sparse and dense; rays among many scenes;
// whole steps of several publishers, of leaps that are long beside the movers, and far from the origin. Rows of one scene
// are comparable with each other: the first of each is without what the others have.
// usage: moving_bench [--quick] [--csv FILE] [--only NAME] [--no-header]

#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "tests/oracle/seed.hpp"
#include "tests/studies/bench/asked_world.hpp"
#include "tests/studies/bench/rows.hpp"

namespace collided::bench {
namespace {

void run_questions(const Options& options, const Work& work, AskedWorld& world, QuestionKind kind, double side_m,
                   std::mt19937_64 random) {
  if (!options.wants(work.scene, work.name)) return;
  ObjectInfo mover;
  mover.primitives = {Box{.center = Vec3::Zero(), .half_m = Vec3::Constant(0.3)}};
  const std::size_t count = options.quick ? 200 : 2'000;
  const std::vector<double> numbers = questions_about(kind, side_m, count, random);
  const Questions asked{
      .kind = kind, .max_hits = kind == QuestionKind::near ? 1U : 1'000U, .numbers = numbers, .mover = &mover};
  Work row = work;
  row.questions = count;
  std::vector<Method> methods{{.name = "collided", .run = [&] { world.ask(asked); }}};
  measure(options, row, methods);
}

void run_crowds(const Options& options, const std::mt19937_64& seeded) {
  constexpr QuestionKind kKinds[] = {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box, QuestionKind::near,
                                     QuestionKind::sweep};
  for (const bool is_dense : {false, true}) {
    for (const bool has_hills : {false, true}) {
      const std::string scene = std::string(is_dense ? "dense" : "sparse") + (has_hills ? " movers, hills" : " movers");
      for (const std::size_t count : {0, 1, 100, 1'000, 10'000}) {
        if ((options.quick && count > 100) || (count == 0 && !has_hills)) continue;
        const double side_m = (is_dense ? 2 : 10) * std::cbrt(static_cast<double>(std::max<std::size_t>(count, 100)));
        std::mt19937_64 random = seeded;
        AskedCrowd crowd(count, side_m, has_hills ? (options.quick ? 50 : 400) : 0, random);
        for (const QuestionKind kind : kKinds)
          run_questions(options, {.scene = scene, .size = count, .name = std::string(name_of(kind))}, crowd, kind,
                        side_m, random);
      }
    }
  }
  for (const std::size_t count : {10, 100, 1'000, 4'000}) {
    if (options.quick && count > 100) continue;
    const double side_m = 4 * std::cbrt(static_cast<double>(count));
    std::mt19937_64 random = seeded;
    ManyScenes scenes(count, side_m, random);
    for (const QuestionKind kind : {QuestionKind::ray, QuestionKind::near})
      run_questions(options, {.scene = "many scenes", .size = count, .name = std::string(name_of(kind))}, scenes, kind,
                    side_m, random);
  }
}

struct MovingCrowdOptions {
  bool are_balls = true;
  std::uint64_t publishers = 1;
  double leap_m = 0.1;  // along each axis, at most
  double away_m = 0;    // from the origin
};

/// Movers that go there and back again, all in every step.
class MovingCrowd : public ChangingWorld {
 public:
  MovingCrowd(std::size_t count, const MovingCrowdOptions& of, std::mt19937_64 random)
      : ChangingWorld(count), publishers_(of.publishers), moved_(std::make_unique<bool[]>(count)) {
    const double side_m = 3 * std::cbrt(static_cast<double>(count));
    const Primitive shape = of.are_balls ? Primitive(Sphere{Vec3::Zero(), kRadius_m})
                                         : Primitive(Box{.center = Vec3::Zero(), .half_m = Vec3::Constant(kRadius_m)});
    for (std::size_t i = 0; i < count; ++i) {
      define(std::to_string(i), shape, in_cube(side_m, random) + Vec3::Constant(of.away_m),
             1 + i * publishers_ / count);
      leaps_.push_back(in_cube(2 * of.leap_m, random));
    }
    step(publishers_);
  }
  double frame() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      poses_[i].position += leaps_[i];
      leaps_[i] *= -1;
    }
    return seconds_of([&] {
      world_.move(ids_, poses_, time_ns_ + kPeriodNs, false, std::span(moved_.get(), ids_.size()));
      step(publishers_);
    });
  }

 private:
  std::uint64_t publishers_;
  std::unique_ptr<bool[]> moved_;
  std::vector<Vec3> leaps_;
};

void run_steps(const Options& options, const std::string& scene, const std::string& name, std::size_t count,
               const MovingCrowdOptions& of, const std::mt19937_64& random) {
  if (!options.wants(scene, name)) return;
  MovingCrowd crowd(count, of, random);
  const int frames = options.quick ? 2 : 10;
  std::vector<Method> methods{{.name = "collided", .own_ns = [&] {
                                 double seconds = 0;
                                 for (int i = 0; i < frames; ++i) seconds += crowd.frame();
                                 return 1e9 * seconds / (frames * static_cast<double>(count));
                               }}};
  measure(options, {.scene = scene, .size = count, .name = name}, methods);
}

void run_crowd_steps(const Options& options, const std::mt19937_64& random) {
  const std::size_t count = options.quick ? 500 : 10'000;
  for (const bool are_balls : {true, false}) {
    const std::string scene = are_balls ? "balls" : "boxes";
    for (const std::uint64_t publishers : {1, 2, 10})
      run_steps(options, scene, "step, publishers " + std::to_string(publishers), count,
                {.are_balls = are_balls, .publishers = publishers}, random);
    for (const int leap_m : {1, 10, 100})
      run_steps(options, scene, "step, leaps of " + std::to_string(leap_m) + " m", count,
                {.are_balls = are_balls, .leap_m = static_cast<double>(leap_m)}, random);
    run_steps(options, scene, "step, 10^9 m out", count, {.are_balls = are_balls, .away_m = 1e9}, random);
  }
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  const std::mt19937_64 random = oracle::seeded(20261141);
  bench::run_crowds(options, random);
  bench::run_crowd_steps(options, random);
  return 0;
}
