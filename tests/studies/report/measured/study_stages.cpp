#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "server/world/world.hpp"
#include "tests/studies/report/measured/studies.hpp"

namespace collided::report {
using namespace engine;
namespace {

using Clock = std::chrono::steady_clock;

double ns_since(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

constexpr const char* kStages[] = {"poses in", "bounds", "pairs", "exact tests", "events and state"};

/// Spheres of a decimetre or two in a box, as many a cubic metre whatever their number, and what a step of them costs.
class Balls {
 public:
  Balls(std::size_t count, std::mt19937_64& random)
      : world_({.epoch = 1, .max_objects = static_cast<std::uint32_t>(count)}), places_(count), motions_(count) {
    const double edge_m = std::cbrt(static_cast<double>(count) / 4);
    std::uniform_real_distribution<double> place(0, edge_m), radius(0.1, 0.2), motion(-0.02, 0.02);
    for (std::size_t i = 0; i < count; ++i) {
      for (int axis = 0; axis < 3; ++axis) places_[i][axis] = place(random), motions_[i][axis] = motion(random);
      Shape shape;
      shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = radius(random)});
      ids_.push_back(std::get<ObjectId>(world_.define({.name = std::to_string(i),
                                                       .scene = {},
                                                       .shape = shape,
                                                       .pose = {.position = places_[i]},
                                                       .filter = {},
                                                       .moving = true,
                                                       .lost_policy = LostPolicy::remove,
                                                       .publisher = 1})));
    }
    step();
  }
  /// Nanoseconds of each stage, in the order of kStages.
  std::vector<double> step() {
    const auto begun = Clock::now();
    time_ns_ += 10'000'000;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      places_[i] += motions_[i];
      world_.move(ids_[i], {.position = places_[i]}, time_ns_, false);
    }
    const double taken = ns_since(begun);
    const auto stepping = Clock::now();
    world_.step(time_ns_, 1, {});
    const double whole = ns_since(stepping);
    const StepCost& cost = world_.cost();
    const auto update = static_cast<double>(cost.update_ns);
    const auto broad = static_cast<double>(cost.broad_ns);
    const auto exact = static_cast<double>(cost.exact_ns);
    contacts_ = cost.contacts;
    return {taken, update, broad, exact, std::max(0.0, whole - update - broad - exact)};
  }
  long contacts() const { return contacts_; }

 private:
  World world_;
  std::vector<ObjectId> ids_;
  std::vector<Vec3> places_;
  std::vector<Vec3> motions_;
  std::int64_t time_ns_ = 0;
  long contacts_ = 0;
};

}  // namespace

std::vector<Row> study_stages(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 11);
  std::vector<Row> rows;
  for (const std::size_t count : {std::size_t{100}, std::size_t{1'000}, std::size_t{10'000}, std::size_t{100'000}}) {
    if (setting.quick && count > 1'000) break;
    Balls balls(count, random);
    std::vector<std::vector<double>> stages(std::size(kStages));
    for (int repeat = 0; repeat < 2 * setting.repeats() + 1; ++repeat) {
      const std::vector<double> ns = balls.step();
      for (std::size_t stage = 0; stage < ns.size(); ++stage) stages[stage].push_back(ns[stage]);
    }
    for (std::size_t stage = 0; stage < stages.size(); ++stage) {
      std::sort(stages[stage].begin(), stages[stage].end());
      rows.push_back({.study = "stages",
                      .scene = std::to_string(count) + " balls",
                      .series = kStages[stage],
                      .knob = static_cast<double>(count),
                      .ns = stages[stage][stages[stage].size() / 2],
                      .ns_low = stages[stage].front(),
                      .ns_high = stages[stage].back(),
                      .n = balls.contacts()});
    }
  }
  return rows;
}

}  // namespace collided::report
