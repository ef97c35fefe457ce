#pragma once

#include <gmpxx.h>

#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

#include "server/geometry/shapes.hpp"

namespace collided::oracle {

/// Where a body's centre is at that time; between two instants it goes straight.
struct Instant {
  std::int64_t time_ns = 0;
  Vec3 position = Vec3::Zero();
};

/// A ball (radius_m) or an upright box (half_m) that only translates.
struct MovingBody {
  std::variant<double, Vec3> form;  // radius, or half sizes
  std::vector<Instant> instants;    // in order; it exists from the first to the last
};

/// Closed: the two touch from begin_ns to end_ns. To 400 bits.
struct Meeting {
  mpf_class begin_ns;
  mpf_class end_ns;
};

/// All times at which two bodies of one form touch, from their poses alone: slow, by linear and quadratic equations in
/// rationals, each piece of time between two instants by itself. closest_m: how near they come in all to touching without
/// doing so, or to parting without: what is below 1e-9 is too near for doubles to be held to.
std::vector<Meeting> meetings(const MovingBody& a, const MovingBody& b, double& closest_m);

}  // namespace collided::oracle
