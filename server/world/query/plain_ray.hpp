#pragma once

#include <cstdint>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// A ray without deadline or allowed error, in a world in which every part of the static scenes may answer: most rays
/// are such. Its answer equals that of ask_ray to the bit; it carries no state for other questions, and its hit is
/// written into the answer once, at the end.
struct PlainRay {
  Ray ray;
  double limit = 0;  // in lengths of the direction; negative: the search is over
  WalkCost walk = {};
  std::uint32_t exact_tests = 0;
  Level level = Level::filter;
  bool is_undecided = false;
  // The nearest hit, or the first one in mode `any`. met: triangle in `scene`; kNoTriangle: nothing.
  std::uint32_t met = kNoTriangle;
  const StaticScene* scene = nullptr;
  RayHit hit;
};

}  // namespace collided::engine
