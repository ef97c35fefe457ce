#pragma once

#include "server/exact_phase/ray/implicit_ray.hpp"

namespace collided::engine::kernel {

/// The first hit by rationals alone; undecided only if out of steps.
Decision first_meeting_exactly(const Ray& ray, const ImplicitSurface& surface, double relative_width, ImplicitHit& hit);

}  // namespace collided::engine::kernel
