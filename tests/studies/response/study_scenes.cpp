#include "tests/studies/response/study_scenes.hpp"

#include <cmath>

#include "tests/studies/response/event_driven.hpp"
#include "tests/studies/response/reference.hpp"

namespace collided::response {
namespace {

constexpr double kGravity = 9.81;
constexpr double kRadius = 0.05;
constexpr std::size_t kStackSize = 10;
constexpr std::size_t kCradleSize = 5;

/// Dropped from about a metre, nothing lost: some four bounces.
StudyScene ball(double random) {
  StudyScene scene{.name = "ball", .line = {{1}, {kRadius}, -kGravity, 0}, .duration_s = 4};
  const double height_m = 0.9 + 0.2 * random;
  scene.start = {{kRadius + height_m}, {0}};
  scene.energy_scale_j = kGravity * height_m;
  scene.expected = [height_m](const Spring* spring, double seconds) -> Expected {
    if (spring == nullptr) {
      const RigidBall rigid{height_m, kGravity, 1};
      return {{{kRadius + rigid.height(seconds)}, {0}}, 0, rigid.impacts_until(seconds)};
    }
    const ReferenceState state = compliant_ball(*spring, 1, kGravity, height_m, 0, seconds);
    return {{{kRadius + state.position_m}, {state.velocity_m_s}}, state.deepest_m, state.contacts};
  };
  return scene;
}

/// Laid on the floor without a spring's depth; it sinks in, swings and must lie still.
StudyScene resting(double random) {
  StudyScene scene{.name = "resting",
                   .line = {{1}, {kRadius}, -kGravity, random},
                   .duration_s = 4,
                   .settling_s = 2,
                   .restitution = 0.5};
  scene.start = {{random + kRadius}, {0}};
  scene.energy_scale_j = kGravity;
  scene.expected = [random](const Spring* spring, double) -> Expected {
    const double depth_m = spring == nullptr ? 0 : kGravity / spring->stiffness_n_m;
    return {{{random + kRadius - depth_m}, {0}}, depth_m, 1};
  };
  return scene;
}

/// Ten bodies of a kilogram at rest, from the first moment on.
StudyScene stack(const Spring* spring, double random) {
  StudyScene scene{
      .name = "stack",
      .line = {std::vector<double>(kStackSize, 1), std::vector<double>(kStackSize, kRadius), -kGravity, random},
      .restitution = 0.5};
  double top_m = random;
  double deepest_m = 0;
  for (std::size_t body = 0; body < kStackSize; ++body) {
    const double borne_n = kGravity * static_cast<double>(kStackSize - body);
    const double depth_m = spring == nullptr ? 0 : borne_n / spring->stiffness_n_m;
    deepest_m = std::max(deepest_m, depth_m);
    scene.start.position_m.push_back(top_m - depth_m + kRadius);
    scene.start.velocity_m_s.push_back(0);
    top_m = scene.start.position_m.back() + kRadius;
  }
  scene.energy_scale_j = kGravity * static_cast<double>(kStackSize);
  scene.expected = [start = scene.start, deepest_m](const Spring*, double) -> Expected {
    return {start, deepest_m, kStackSize};
  };
  return scene;
}

/// A thousand tonnes to a kilogram, in space.
StudyScene pair(double random) {
  StudyScene scene{.name = "pair", .line = {{1e6, 1}, {kRadius, kRadius}}};
  scene.start = {{-0.1 - 0.1 * random, 2 * kRadius}, {1, 0}};
  scene.energy_scale_j = 0.5e6;
  scene.expected = [line = scene.line, start = scene.start](const Spring* spring, double seconds) -> Expected {
    if (spring != nullptr) {
      const double rate = -gap_rate(line, start.velocity_m_s, 1);
      return {compliant_pair(*spring, line, start, seconds),
              ContactPhase(*spring, line.reduced_mass(1), rate, 0).deepest(), 1};
    }
    EventDriven rigid(line, start, 1);
    rigid.advance(seconds);
    return {rigid.motion(), 0, rigid.impacts()};
  };
  return scene;
}

/// Five balls a millimetre apart, so that springs pass the blow on one by one. The rigid reference serves both: what
/// springs add, five times the time of a contact, is part of the error.
StudyScene cradle(double random) {
  StudyScene scene{.name = "cradle",
                   .line = {std::vector<double>(kCradleSize, 1), std::vector<double>(kCradleSize, kRadius)}};
  for (std::size_t body = 0; body < kCradleSize; ++body) {
    scene.start.position_m.push_back(static_cast<double>(body) * (2 * kRadius + 1e-3) -
                                     (body == 0 ? 0.1 * (1 + random) : 0));
    scene.start.velocity_m_s.push_back(body == 0 ? 1 : 0);
  }
  scene.energy_scale_j = 0.5;
  scene.expected = [line = scene.line, start = scene.start](const Spring* spring, double seconds) -> Expected {
    EventDriven rigid(line, start, 1);
    rigid.advance(seconds);
    const double deepest_m = spring == nullptr ? 0 : ContactPhase(*spring, 0.5, 1, 0).deepest();
    return {rigid.motion(), deepest_m, rigid.impacts()};
  };
  return scene;
}

}  // namespace

StudyScene study_scene(std::size_t index, const Spring* spring, double random) {
  switch (index) {
    case 0: return ball(random);
    case 1: return resting(random);
    case 2: return stack(spring, random);
    case 3: return pair(random);
    default: return cradle(random);
  }
}

}  // namespace collided::response
