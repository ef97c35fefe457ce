#pragma once

#include <cstdint>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// A ray that static scenes alone can stop, every part of which may answer, asked to the last bit and without a
/// deadline: most rays. Its answer is that of ask_ray, to the bit; it carries none of the state that other questions
/// need, and what it met is written into the answer once, at the end.
struct PlainRay {
  Ray ray;
  double limit = 0;  // in lengths of the direction; negative: the search is over
  WalkCost walk = {};
  std::uint32_t exact_tests = 0;
  Level level = Level::filter;
  bool is_undecided = false;
  // Of the nearest hit, or of the first one where any will do; met: in `scene`, kNoTriangle: nothing.
  std::uint32_t met = kNoTriangle;
  const StaticScene* scene = nullptr;
  RayHit hit;
};

}  // namespace collided::engine
