#pragma once

#include <array>
#include <functional>
#include <string_view>

#include "client/cli/publish/response/damper.hpp"
#include "tests/studies/response/line.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {

/// What a run should have come to.
struct Expected {
  Motion motion;
  double deepest_m = 0;
  std::uint64_t contacts = 0;
};

/// One start of a scene of the study, with its reference for springs and for rigid contacts.
struct StudyScene {
  std::string_view name = {};
  Line line = {};
  Motion start = {};
  double duration_s = 1;
  double settling_s = 0;  // penetration counts from here on
  double restitution = 1;
  double lightest_kg = 1;
  double energy_scale_j = 1;                                     // what drift is relative to
  std::function<Expected(const Spring*, double)> expected = {};  // at a time; without a spring: rigid
};

inline constexpr std::size_t kSceneCount = 5;

/// Scene 0 to kSceneCount - 1: ball, resting, stack, pair, cradle. `random` in [0, 1) moves its start.
/// spring   of the run, whose equilibrium resting scenes start from; null for rigid methods
StudyScene study_scene(std::size_t index, const Spring* spring, double random);

}  // namespace collided::response
