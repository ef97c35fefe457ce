// Whole steps of the world, one thread: contacts, motions, events and the next snapshot. First beside peers
// (whole_steps.cpp); then crowds posed by one publisher in one flush and by four, a quarter each, at phases of their own.
// usage: step_bench [--quick] [--csv FILE] [--only NAME] [--no-header]

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/rows.hpp"
#include "tests/studies/bench/whole_steps.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr std::int64_t kPeriodNs = 10'000'000;  // 100 Hz
constexpr double kPeriod_s = 0.01;
constexpr double kSpeed_mps = 2;  // along each axis, at most
constexpr double kSpin_radps = 2;
constexpr double kHalf_m = 0.25;

struct Kind {
  const char* name;
  bool turns;
  bool over_hills;
};
constexpr Kind kKinds[] = {{"balls", false, false},
                           {"boxes", false, false},
                           {"boxes, turning", true, false},
                           {"boxes, turning, over hills", true, true},
                           {"meshes, turning", true, false}};

Shape shape_of(const std::string& kind) {
  Shape shape;
  if (kind == "balls") {
    shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = kHalf_m}};
  } else if (kind.starts_with("boxes")) {
    shape.primitives = {Box{.center = Vec3::Zero(), .half_m = Vec3(kHalf_m, 0.8 * kHalf_m, 0.6 * kHalf_m)}};
  } else {
    shape.mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(1, kHalf_m));
  }
  return shape;
}

/// One in a cubic metre, each straight on until it bounces off a wall. Over hills they keep within some metres of the ground.
class Crowd {
 public:
  Crowd(const Kind& kind, std::size_t count, std::uint64_t publishers, std::mt19937_64 random)
      : kind_(kind), publishers_(publishers), world_({.max_objects = static_cast<std::uint32_t>(count + 10)}) {
    const double number = static_cast<double>(count);
    size_m_ =
        kind.over_hills ? Vec3(std::sqrt(number / 4), std::sqrt(number / 4), 4) : Vec3::Constant(std::cbrt(number));
    if (kind.over_hills) add_hills();
    std::uniform_real_distribution<double> part(-1, 1);
    const auto any = [&] { return Vec3(part(random), part(random), part(random)); };
    for (std::size_t i = 0; i < count; ++i) {
      poses_.push_back({.position = size_m_.cwiseProduct(any()) / 2,
                        .rotation = Quat(1 + part(random), part(random), part(random), part(random)).normalized()});
      velocities_.push_back(kSpeed_mps * any());
      const Vec3 axis = any().normalized();
      turns_.push_back(kind.turns ? Quat(Eigen::AngleAxisd(kSpin_radps * kPeriod_s * std::abs(part(random)), axis))
                                  : Quat(Quat::Identity()));
      ObjectDefinition definition{
          .name = std::to_string(i), .scene = "", .shape = shape_of(kind.name), .pose = poses_.back(), .filter = {}};
      definition.publisher = 1 + i * publishers / count;
      ids_.push_back(std::get<ObjectId>(world_.define(definition)));
    }
    moved_ = std::make_unique<bool[]>(count);
    step();
  }

  /// Every mover once. Seconds of this thread, the way there not counted.
  double frame() {
    advance_poses();
    const double started = thread_seconds();
    const std::size_t share = ids_.size() / publishers_;
    for (std::size_t p = 0; p < publishers_; ++p) {
      const std::size_t first = p * share;
      const std::size_t count = p + 1 == publishers_ ? ids_.size() - first : share;
      time_ns_ += kPeriodNs / static_cast<std::int64_t>(publishers_);
      world_.move(std::span(ids_).subspan(first, count), std::span(poses_).subspan(first, count), time_ns_, false,
                  std::span(moved_.get(), count));
      world_.advance(p + 1, time_ns_);
      step();
    }
    return thread_seconds() - started;
  }

  const World& world() const { return world_; }
  std::uint64_t events() const { return events_; }

 private:
  void add_hills() {
    Scene scene;
    scene.name = "hills";
    scene.mesh = scenes::terrain(200, 1.1 * size_m_.x(), 7);
    scene.parts = {{.name = "hills",
                    .first_triangle = 0,
                    .triangle_count = static_cast<std::uint32_t>(scene.mesh.triangles.size())}};
    world_.add_scene(World::index_scene(std::move(scene), {}));
  }
  void advance_poses() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        if (std::abs(poses_[i].position[k] + kPeriod_s * velocities_[i][k]) > size_m_[k] / 2) velocities_[i][k] *= -1;
      }
      poses_[i].position += kPeriod_s * velocities_[i];
      poses_[i].rotation = (poses_[i].rotation * turns_[i]).normalized();
    }
  }
  void step() {
    if (!world_.step(time_ns_, 1, {.contacts = true})) std::abort();
    events_ += world_.events().size();
  }

  Kind kind_;
  std::uint64_t publishers_;
  World world_;
  Vec3 size_m_;
  std::vector<ObjectId> ids_;
  std::vector<Pose> poses_;
  std::vector<Vec3> velocities_;
  std::vector<Quat> turns_;
  std::unique_ptr<bool[]> moved_;
  std::int64_t time_ns_ = 1'000'000'000'000;
  std::uint64_t events_ = 0;
};

void run(const Options& options, const Kind& kind, std::size_t count, const std::mt19937_64& random) {
  if (!options.wants(kind.name, "whole step")) return;
  Crowd one(kind, count, 1, random);
  Crowd four(kind, count, 4, random);
  const int frames = options.quick ? 3 : 20;
  const auto timed = [frames, count](Crowd& crowd) {
    return [&crowd, frames, count] {
      double seconds = 0;
      for (int i = 0; i < frames; ++i) seconds += crowd.frame();
      return 1e9 * seconds / (frames * static_cast<double>(count));
    };
  };
  std::vector<Method> methods{{.name = "collided, one publisher", .own_ns = timed(one)},
                              {.name = "collided, four publishers", .own_ns = timed(four)}};
  measure(options, {.scene = kind.name, .size = count, .name = "whole step"}, methods);
  const StepCost& cost = one.world().cost();
  std::printf(
      "%s, %zu, last step of one publisher: %u candidates, %u exact tests, %u swept, %u skipped, %u contacts, update "
      "%.2f broad %.2f exact %.2f ms; "
      "%.1f events a frame, %.1f of four publishers\n",
      kind.name, count, cost.candidate_pairs, cost.exact_tests, cost.swept, cost.sweeps_skipped, cost.contacts,
      1e-6 * static_cast<double>(cost.update_ns), 1e-6 * static_cast<double>(cost.broad_ns),
      1e-6 * static_cast<double>(cost.exact_ns), static_cast<double>(one.events()) / (6.0 * frames),
      static_cast<double>(four.events()) / (6.0 * frames));
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(20261123);
  bench::run_whole_steps(options, random);
  for (const bench::Kind& kind : bench::kKinds) {
    for (const std::size_t count : {1'000, 10'000, 100'000}) {
      if (options.quick && count > 1'000) continue;
      bench::run(options, kind, count, random);
    }
  }
  return 0;
}
