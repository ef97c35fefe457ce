#pragma once

#include <functional>

#include "server/exact_phase/motion/time_of_contact.hpp"
#include "tests/studies/report/measure.hpp"

namespace collided::report {
using namespace engine;

/// First time in [0, 1] at which a convex function is not positive, in a hundred digits: its lowest place by ternary
/// search, then the crossing before it by bisection.
Truth first_time(const std::function<oracle::Wide(const oracle::Wide&)>& above);

/// When a moving sphere first meets a triangle.
Truth time_truth(const MovingSphere& mover, const Triangle& triangle);

}  // namespace collided::report
