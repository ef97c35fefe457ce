#include "server/broad_phase/hierarchy/bvh_ray.hpp"

#include <limits>

#include "server/geometry/tolerance.hpp"

// Slack of the leaf test. u = 2^-24; D, C, E, s: largest components of the direction, of any vertex relative to the
// start, of the triangle's edges, and the requested slack; h: error of the start. The test computes R = c x d, U =
// R.e2, V = -R.e1, N = e1 x e2, det = N.d, W = det - U - V, T = N.c with c = corner - start. For a ray that meets the
// triangle, U, V, W are zero or have the sign of det, and T = t det.
//   c     u (stored) + h + s + 1.01 u C (subtraction)
//   U, V  6 D E (error of c + 7 u C) + 12 D s (C + 1)     = E K0 + S0,  K0 = 6 D (h + s + u + 8.5 u C)
//   det   48 u D E^2 + 24 D s (E + s)
//   W     twice U's + det's + sums: 26 u C D E; E <= 2    = E (2 K0 + 26 u C D + 96 u D) + 24 D s (C + 4)
//   T     E^2 (6 (h + s + u) + 49 u C) + 24 s C (E + s)
// T is compared with t |det| for t in [0, C] (the largest component of d is at least 1), which adds C times det's error
// and one rounding: E^2 u C (48 D + 12) and 24 s C D (E + s). Second-order terms and the roundings of the slack itself
// are below one percent (kRaise); products that underflow are below kTiny.
namespace collided::engine::bvh::ray_detail {
namespace {

/// Beyond this, products of coordinates could overflow: nothing is known about the axis.
constexpr double kFar = 0x1p400;

/// x - y = difference + rest exactly (Knuth, The Art of Computer Programming 2, 4.2.2, theorem B).
void two_difference(double x, double y, double& difference, double& rest) {
  difference = x - y;
  const double y_virtual = x - difference;
  const double x_virtual = difference + y_virtual;
  rest = (x - x_virtual) + (y_virtual - y);
}

/// A ray with a start far out, where the subtraction of the frame's origin may round.
struct FarRay : LocalRay {
  double origin_rest[3];  // the rounding error of subtracting the frame's origin
  bool is_known = true;
};

/// Sets start and direction in local coordinates; false if the direction is zero.
bool localize(const LocalFrame& frame, const Ray& ray, FarRay& local, RayFrame& out) {
  const double largest = ray.direction.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return false;
  const int exponent = std::ilogb(largest);
  // Two factors, because neither 2^1074 nor 2^-1074 and its inverse fit one double.
  const int half = -exponent / 2;
  const double scale_1 = std::ldexp(1.0, half);
  const double scale_2 = std::ldexp(1.0, -exponent - half);
  for (int axis = 0; axis < 3; ++axis) {
    local.direction[axis] = ray.direction[axis] * scale_1 * scale_2;
    two_difference(ray.origin[axis], frame.origin[axis], local.origin[axis], local.origin_rest[axis]);
    local.origin[axis] *= frame.scale;
    local.origin_rest[axis] *= frame.scale;
    local.origin_error[axis] = kLeastSlack;
    local.is_known = local.is_known && std::abs(local.origin[axis]) < kFar;
  }
  const int to_local = exponent + frame.scale_exponent;
  out.to_local_1 = std::ldexp(1.0, to_local / 2);
  out.to_local_2 = std::ldexp(1.0, to_local - to_local / 2);
  return true;
}

/// A parameter at or before the ray's entry into the root box, with both grown by their rounding; NaN for a certain
/// miss.
double entry_of(const Layout& layout, const FarRay& local) {
  constexpr double kMiss = std::numeric_limits<double>::quiet_NaN();
  constexpr double kRelative = 0x1p-48;
  double entry = 0;
  double exit = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double o = local.origin[axis];
    const double d = local.direction[axis];
    // Grown by the rounding of the start, so that a start beside a face does not count as behind it.
    const double grown = local.slack + local.origin_error[axis] + kRelative * (1 + std::abs(o));
    const double low = static_cast<double>(layout.root_low[axis]) - grown;
    const double high = static_cast<double>(layout.root_high[axis]) + grown;
    if (d == 0) {
      if (o < low || o > high) return kMiss;
      continue;
    }
    const double to_near = ((d > 0 ? low : high) - o) / d;
    const double to_far = ((d > 0 ? high : low) - o) / d;
    entry = std::max(entry, to_near - kRelative * std::abs(to_near));
    exit = std::min(exit, to_far + kRelative * std::abs(to_far));
  }
  return entry <= exit ? entry : kMiss;
}

bool is_near(const LocalRay& local) {
  return std::abs(local.origin[0]) <= kNear && std::abs(local.origin[1]) <= kNear && std::abs(local.origin[2]) <= kNear;
}

/// Moves the start forward, repeatedly while the parameter's own rounding leaves it far out. False for a certain miss.
bool move_to_scene(const Layout& layout, FarRay& local, double (&moved)[3]) {
  for (double& move : moved) {
    if (is_near(local)) break;
    const double entry = entry_of(layout, local);
    if (std::isnan(entry)) return false;
    move = entry;
    for (int axis = 0; axis < 3; ++axis) {
      // One rounding for product and sum together: a start a million scenes away still lands precisely.
      const double arrived = std::fma(entry, local.direction[axis], local.origin[axis]);
      local.origin[axis] = arrived + local.origin_rest[axis];
      local.origin_error[axis] += kRoundoff * (std::abs(arrived) + std::abs(local.origin[axis]));
      local.origin_rest[axis] = 0;
    }
  }
  return true;
}

/// For a start about which nothing is known: every box and triangle passes.
void accept_everything(RayFrame& out) {
  for (int axis = 0; axis < 3; ++axis) {
    out.origin[axis] = 0;
    out.inverse[axis] = 1;
    out.direction[axis] = 1;
    out.near_offset[axis] = static_cast<float>(kEverything);
    out.far_offset[axis] = static_cast<float>(-kEverything);
    out.moved[axis] = 0;
  }
  set_planes(out);
  accept_triangles(out);
  // Makes every limit that is not negative infinite.
  out.to_local_1 = out.to_local_2 = std::numeric_limits<double>::infinity();
}

}  // namespace

bool prepare_any_ray(const Layout& layout, const Ray& ray, double slack_m, RayFrame& frame) {
  FarRay local;
  frame.is_moved = true;
  for (double& move : frame.moved) move = 0;
  local.slack = slack_m * layout.frame.scale * (1 + kFewSlack);
  const bool has_direction = localize(layout.frame, ray, local, frame);
  if (!has_direction || !local.is_known || !(local.slack < 1)) {
    accept_everything(frame);
    return true;
  }
  if (!move_to_scene(layout, local, frame.moved)) return false;
  if (!is_near(local)) {
    accept_everything(frame);
    return true;
  }
  for (int axis = 0; axis < 3; ++axis) local.origin_error[axis] += std::abs(local.origin_rest[axis]);
  finish(local, frame);
  return true;
}

}  // namespace collided::engine::bvh::ray_detail
