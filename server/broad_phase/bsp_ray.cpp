#include "server/broad_phase/bsp_ray.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

// Slack of the leaf test. u = 2^-24; D, C, E, s: largest components of the direction, of any vertex seen from the
// start, of the triangle's edges, and the asked slack; h: error of the start. The test forms R = c x d, U = R.e2,
// V = R.e1, N = e1 x e2, det = N.d, W = det - U - V, T = N.c with c = corner - start. For a ray that meets the
// triangle U, V, W have the sign of det or are zero, and T = t det.
//   c     u (stored) + h + s + 1.01 u C (subtraction)
//   U, V  6 D E (error of c + 7 u C) + 12 D s (C + 1)                       = E K0 + S0,  K0 = 6 D (h + s + u + 8.5 u C)
//   det   48 u D E^2 + 24 D s (E + s)
//   W     twice U's + det's + sums: 26 u C D E; E <= 2                      = E (2 K0 + 26 u C D + 96 u D) + 24 D s (C + 4)
//   T     E^2 (6 (h + s + u) + 49 u C) + 24 s C (E + s)
// T is compared with t |det| for t in [0, C] (the largest component of d is at least 1), which adds C times det's
// error and one rounding: E^2 u C (48 D + 12) and 24 s C D (E + s). Second orders and the roundings of the slack
// itself are below a hundredth (kRaise); products that underflow are below kTiny.
namespace collided::bsp {
namespace {

constexpr double kUnit = 0x1p-24;
constexpr double kRaise = 1.01;
constexpr double kTiny = 0x1p-120;
/// Slabs of an axis across which the direction is smaller than this are as good as parallel: over the longest
/// path (parameter 16) the ray drifts by 2^-56, a quarter of kLeastSlack.
constexpr double kLeastDirection = 0x1p-60;
constexpr double kLeastSlack = 0x1p-54;
/// A start farther out than this is moved up to the scene first, so that floats resolve the scene, not the way.
constexpr double kNear = 4;
/// Beyond it products of coordinates could overflow: nothing is known about the axis.
constexpr double kFar = 0x1p400;
constexpr double kEverything = 0x1p40;

struct LocalRay {
  double origin[3];
  double origin_rest[3];  // what the subtraction of the frame's origin rounded away
  double direction[3];
  double origin_error[3];  // by which the moved start may be off
  bool unknown[3] = {false, false, false};
};

/// x - y = difference + rest exactly (Knuth, The Art of Computer Programming 2, 4.2.2, theorem B).
void two_difference(double x, double y, double& difference, double& rest) {
  difference = x - y;
  const double y_virtual = x - difference;
  const double x_virtual = difference + y_virtual;
  rest = (x - x_virtual) + (y_virtual - y);
}

/// Start and direction in local coordinates; false when the direction is zero.
bool localize(const LocalFrame& frame, const Ray& ray, LocalRay& local, RayFrame& out) {
  const double largest = ray.direction.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return false;
  const int exponent = std::ilogb(largest);
  // Two factors, since neither 2^1074 nor 2^-1074 and its inverse fit one double.
  const int half = -exponent / 2;
  const double scale_1 = std::ldexp(1.0, half);
  const double scale_2 = std::ldexp(1.0, -exponent - half);
  for (int axis = 0; axis < 3; ++axis) {
    local.direction[axis] = ray.direction[axis] * scale_1 * scale_2;
    double rest = 0;
    two_difference(ray.origin[axis], frame.origin[axis], local.origin[axis], rest);
    local.origin[axis] *= frame.scale;
    local.origin_rest[axis] = rest * frame.scale;
    local.unknown[axis] = !(std::abs(local.origin[axis]) < kFar);
  }
  const int to_local = exponent + frame.scale_exponent;
  out.to_local_1 = std::ldexp(1.0, to_local / 2);
  out.to_local_2 = std::ldexp(1.0, to_local - to_local / 2);
  return true;
}

/// A parameter at or before the ray's entry into the root box, both grown by their rounding; NaN on a sure miss.
double entry_of(const Layout& layout, const LocalRay& local, double slack) {
  constexpr double kMiss = std::numeric_limits<double>::quiet_NaN();
  constexpr double kRelative = 0x1p-48;
  double entry = 0;
  double exit = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double o = local.origin[axis];
    const double d = local.direction[axis];
    // Grown by the rounding of the start, so that a start beside a face is not taken for one behind it.
    const double grown = slack + local.origin_error[axis] + kRelative * (1 + std::abs(o));
    const double low = layout.root_low[axis] - grown;
    const double high = layout.root_high[axis] + grown;
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

/// Moves the start forward, again while the parameter's own rounding leaves it far out. False on a sure miss.
bool move_to_scene(const Layout& layout, double slack, LocalRay& local, double (&moved)[3]) {
  for (double& move : moved) {
    if (is_near(local)) break;
    const double entry = entry_of(layout, local, slack);
    if (std::isnan(entry)) return false;
    move = entry;
    for (int axis = 0; axis < 3; ++axis) {
      // One rounding for product and sum together: a start a million scenes away still lands sharply.
      const double arrived = std::fma(entry, local.direction[axis], local.origin[axis]);
      local.origin[axis] = arrived + local.origin_rest[axis];
      local.origin_error[axis] += 0x1p-53 * (std::abs(arrived) + std::abs(local.origin[axis]));
      local.origin_rest[axis] = 0;
    }
  }
  return true;
}

/// worst_error: of any axis; it lengthens the path along which a clamped direction drifts.
void set_axis(const LocalRay& local, double slack, double worst_error, int axis, RayFrame& out) {
  const double d = local.direction[axis];
  const double clamped = std::abs(d) < kLeastDirection ? std::copysign(kLeastDirection, d) : d;
  const auto start = static_cast<float>(local.origin[axis]);
  // Two roundings of plane * inverse, one of the difference, one of the inverse itself: see RayFrame.
  const double rounding = kUnit * (4 + 3 * std::abs(static_cast<double>(start)));
  const double drift = kLeastSlack + 2 * kLeastDirection * worst_error;
  const double wide = std::min(local.origin_error[axis] + slack + rounding + drift, kEverything);
  const auto inverse = static_cast<float>(1 / clamped);
  const double near_shift = inverse > 0 ? wide : -wide;
  out.origin[axis] = start;
  out.direction[axis] = static_cast<float>(clamped);
  out.inverse[axis] = inverse;
  out.near_offset[axis] = round_up((static_cast<double>(start) + near_shift) * static_cast<double>(inverse));
  out.far_offset[axis] = round_down((static_cast<double>(start) - near_shift) * static_cast<double>(inverse));
  const auto low = static_cast<std::uint32_t>(offsetof(Node, low) + sizeof(float) * kWidth * axis);
  const auto high = static_cast<std::uint32_t>(offsetof(Node, high) + sizeof(float) * kWidth * axis);
  out.near_plane[axis] = inverse > 0 ? low : high;
  out.far_plane[axis] = inverse > 0 ? high : low;
}

/// With floors like these every triangle of a met leaf is a candidate.
void accept_triangles(RayFrame& out) {
  out.sign_slope = out.entry_slope = out.entry_linear = 0;
  out.sign_floor = out.entry_floor = static_cast<float>(kEverything);
  out.parameter_cap = static_cast<float>(kEverything);
}

void set_leaf_slack(double start_error, double slack, RayFrame& out) {
  if (start_error > 1) {
    accept_triangles(out);
    return;
  }
  double reach = 0;
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    reach = std::max(reach, std::abs(static_cast<double>(out.origin[axis])));
    largest = std::max(largest, std::abs(static_cast<double>(out.direction[axis])));
  }
  const double c = 1 + reach + start_error + slack;
  const double d = largest;
  const double s = slack;
  const double corner = start_error + s + kUnit;
  const double k0 = 6 * d * (corner + 8.5 * kUnit * c);
  out.sign_slope = round_up(kRaise * (2 * k0 + 26 * kUnit * c * d + 96 * kUnit * d));
  out.sign_floor = round_up(kRaise * 24 * d * s * (c + 4) + kTiny);
  out.entry_slope = round_up(kRaise * (6 * corner + (61 + 48 * d) * kUnit * c));
  out.entry_linear = round_up(kRaise * 24 * s * c * (1 + d));
  out.entry_floor = round_up(kRaise * 24 * s * s * c * (1 + d) + kTiny);
  out.parameter_cap = round_up(kRaise * c);
}

/// Nothing is known of the start: every box and triangle passes.
void accept_everything(RayFrame& out) {
  for (int axis = 0; axis < 3; ++axis) {
    out.origin[axis] = 0;
    out.inverse[axis] = 1;
    out.direction[axis] = 1;
    out.near_offset[axis] = static_cast<float>(kEverything);
    out.far_offset[axis] = static_cast<float>(-kEverything);
    out.near_plane[axis] = static_cast<std::uint32_t>(offsetof(Node, low) + sizeof(float) * kWidth * axis);
    out.far_plane[axis] = static_cast<std::uint32_t>(offsetof(Node, high) + sizeof(float) * kWidth * axis);
  }
  accept_triangles(out);
  // Any limit that is not negative stays infinite.
  out.to_local_1 = out.to_local_2 = std::numeric_limits<double>::infinity();
  for (double& move : out.moved) move = 0;
}

}  // namespace

float RayFrame::local_limit(double limit) const {
  if (!(limit >= 0)) return -1;
  if (limit == 0 && std::isinf(to_local_1)) return std::numeric_limits<float>::infinity();
  double parameter = limit * to_local_1 * to_local_2;
  for (const double move : moved) {
    // Exact while the two are within a factor of two of each other, else one rounding of the difference.
    parameter -= move;
  }
  return round_up(parameter + 0x1p-50 * std::abs(parameter) + kTiny);
}

bool prepare_ray(const Layout& layout, const Ray& ray, double limit, double slack_m, RayFrame& frame) {
  LocalRay local;
  if (!(limit >= 0) || layout.root == kNothing) return false;
  if (!localize(layout.frame, ray, local, frame)) {
    accept_everything(frame);
    return true;
  }
  const double slack = slack_m * layout.frame.scale * (1 + 0x1p-50);
  for (int axis = 0; axis < 3; ++axis) {
    frame.moved[axis] = 0;
    local.origin_error[axis] = kLeastSlack / 8;
  }
  if (local.unknown[0] || local.unknown[1] || local.unknown[2] || !(slack < 1)) {
    accept_everything(frame);
    return true;
  }
  if (!is_near(local)) {
    if (!move_to_scene(layout, slack, local, frame.moved)) return false;
    if (!is_near(local)) {
      accept_everything(frame);
      return true;
    }
  }
  double start_error = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto start = static_cast<float>(local.origin[axis]);
    local.origin_error[axis] += std::abs(local.origin_rest[axis]) + std::abs(local.origin[axis] - static_cast<double>(start));
    start_error = std::max(start_error, local.origin_error[axis]);
  }
  for (int axis = 0; axis < 3; ++axis) set_axis(local, slack, start_error, axis, frame);
  set_leaf_slack(start_error, slack, frame);
  return true;
}

}  // namespace collided::bsp
