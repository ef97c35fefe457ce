#include "tests/studies/response/response_study.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <ostream>
#include <random>

#include <fmt/format.h>

#include "tests/studies/response/event_driven.hpp"
#include "tests/studies/response/study_scenes.hpp"

namespace collided::response {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kExplosion = 10;
constexpr double kRestingSpeed_m_s = 1e-4;
constexpr Method kSpringMethods[]{Method::explicit_euler, Method::semi_implicit_euler, Method::implicit_euler,
                                  Method::compliant};

double nanoseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
}

double largest_distance(const Motion& one, const Motion& other) {
  double largest = 0;
  for (std::size_t body = 0; body < one.position_m.size(); ++body) {
    const double distance = std::abs(one.position_m[body] - other.position_m[body]);
    largest = distance <= largest ? largest : distance;  // not a number is the largest of all
  }
  return largest;
}

/// Counts, errors and bounds of one finished run, merged as the worst so far.
void merge(ResponseRow& row, const StudyScene& scene, const Spring* spring, const Motion& motion,
           std::uint64_t contacts, double deepest_m, double energy_change_j) {
  const double end_s = std::round(scene.duration_s / row.dt_s) * row.dt_s;
  const Expected expected = scene.expected(spring, end_s);
  row.energy_drift = std::max(row.energy_drift, std::abs(energy_change_j) / scene.energy_scale_j);
  row.penetration_m = std::max(row.penetration_m, deepest_m);
  row.penetration_bound_m = std::max(row.penetration_bound_m, expected.deepest_m);
  row.error_m = std::max(row.error_m, largest_distance(motion, expected.motion));
  row.missed = std::max(row.missed, expected.contacts - std::min(expected.contacts, contacts));
  row.spurious = std::max(row.spurious, contacts - std::min(expected.contacts, contacts));
}

void run_stepper(ResponseRow& row, const StudyScene& scene, const StepperOptions& options) {
  const bool has_springs = options.method != Method::impulse;
  Stepper stepper(scene.line, options);
  Motion motion = scene.start;
  const auto steps = static_cast<std::uint64_t>(std::round(scene.duration_s / row.dt_s));
  const auto settled = static_cast<std::uint64_t>(std::round(scene.settling_s / row.dt_s));
  const double energy_before = stepper.energy(motion);
  double deepest_m = 0;
  std::uint64_t made = 0;
  const auto start = std::chrono::steady_clock::now();
  for (; made < steps && !row.exploded; ++made) {
    if (made == settled) deepest_m = 0;
    stepper.step(motion, row.dt_s);
    if (scene.settling_s > 0) deepest_m = std::max(deepest_m, deepest_penetration(scene.line, motion));
    row.exploded = !(stepper.energy(motion) - energy_before < kExplosion * scene.energy_scale_j);
  }
  row.ns_per_step = std::min(row.ns_per_step, nanoseconds_since(start) / static_cast<double>(made));
  if (scene.settling_s == 0) deepest_m = stepper.counts().deepest_m;
  // A bounce that a resting body is meant to lose is no drift: there only a gain counts.
  double change = stepper.energy(motion) - energy_before;
  if (scene.settling_s > 0) change = std::max(change, 0.0);
  merge(row, scene, has_springs ? &options.spring : nullptr, motion, stepper.episodes().began(), deepest_m, change);
}

void run_event_driven(ResponseRow& row, const StudyScene& scene) {
  EventDriven world(scene.line, scene.start, scene.restitution, scene.restitution < 1 ? kRestingSpeed_m_s : 0);
  const double energy_before = kinetic_energy(scene.line, scene.start) + gravity_energy(scene.line, scene.start);
  const auto steps = static_cast<std::uint64_t>(std::round(scene.duration_s / row.dt_s));
  const auto start = std::chrono::steady_clock::now();
  for (std::uint64_t made = 0; made < steps; ++made) world.advance(row.dt_s);
  row.ns_per_step = std::min(row.ns_per_step, nanoseconds_since(start) / static_cast<double>(steps));
  const Motion& motion = world.motion();
  const double change = kinetic_energy(scene.line, motion) + gravity_energy(scene.line, motion) - energy_before;
  const std::uint64_t contacts = std::max<std::uint64_t>(world.impacts(), world.resting_count());
  merge(row, scene, nullptr, motion, contacts, deepest_penetration(scene.line, motion), change);
}

/// `stiffness` infinite: rigid, by `method` where it is impulse and event-driven where there is none.
ResponseRow make_row(std::size_t scene_index, const Method* method, double stiffness, double dt_s,
                     const StudyOptions& study) {
  ResponseRow row{.dt_s = dt_s, .ns_per_step = kInfinity};
  row.stiffness_n_m = stiffness;
  row.method = method == nullptr ? "event_driven" : std::string(name(*method));
  std::mt19937_64 random(study.seed);
  for (int start = 0; start < study.starts; ++start) {
    const double moved = static_cast<double>(random() >> 11) * 0x1p-53;
    Spring spring{.stiffness_n_m = stiffness};
    const bool has_springs = std::isfinite(stiffness);
    const StudyScene scene = study_scene(scene_index, has_springs ? &spring : nullptr, moved);
    spring.damping_ratio = damping_of_restitution(scene.restitution);
    row.scene = scene.name;
    row.stiffness_ratio = stiffness * dt_s * dt_s / scene.lightest_kg;
    if (method == nullptr) run_event_driven(row, scene);
    else run_stepper(row, scene, {.method = *method, .spring = spring, .restitution = scene.restitution});
  }
  return row;
}

}  // namespace

std::vector<ResponseRow> response_rows(const StudyOptions& options) {
  std::vector<ResponseRow> rows;
  constexpr Method kImpulse = Method::impulse;
  for (std::size_t scene = 0; scene < kSceneCount; ++scene) {
    for (const double dt_s : options.steps_s) {
      for (const Method method : kSpringMethods) {
        for (double stiffness = options.least_stiffness_n_m; stiffness <= options.largest_stiffness_n_m * 1.5;
             stiffness *= 10) {
          rows.push_back(make_row(scene, &method, stiffness, dt_s, options));
        }
      }
      rows.push_back(make_row(scene, &kImpulse, kInfinity, dt_s, options));
      rows.push_back(make_row(scene, nullptr, kInfinity, dt_s, options));
    }
  }
  return rows;
}

void write_csv(std::ostream& out, const std::vector<ResponseRow>& rows) {
  out << "scene,method,stiffness_n_m,dt_s,stiffness_ratio,energy_drift,penetration_m,penetration_bound_m,error_m,"
         "missed,spurious,ns_per_step,exploded\n";
  for (const ResponseRow& row : rows) {
    out << fmt::format("{},{},{},{},{},{},{},{},{},{},{},{:.1f},{}\n", row.scene, row.method, row.stiffness_n_m,
                       row.dt_s, row.stiffness_ratio, row.energy_drift, row.penetration_m, row.penetration_bound_m,
                       row.error_m, row.missed, row.spurious, row.ns_per_step, row.exploded ? 1 : 0);
  }
}

}  // namespace collided::response
