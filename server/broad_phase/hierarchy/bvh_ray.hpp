#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine::bvh {

/// A ray prepared for the float walk: in local coordinates, its start moved up to the scene, its largest direction
/// component in [1, 2), and every rounding on the way turned into slack. All slack is outward: the walk may visit a box
/// or keep a triangle that the ray misses, never the reverse.
///
/// slabs   near side of axis k: plane * inverse[k] - near_offset[k] is at most the true parameter; far side: at least
/// leaves  the signs U, V, W of a triangle are certain beyond sign_slope * E + sign_floor, its parameter beyond
/// (entry_slope * E + entry_linear) * E + entry_floor; E is the largest edge component (derived in bvh_ray.cpp)
struct alignas(16) RayFrame {
  // Three axes, and a fourth lane for SIMD stores.
  float inverse[4];
  float near_offset[4];
  float far_offset[4];
  float origin[4];
  float direction[4];
  std::uint32_t near_plane[4];  // byte offset within Node
  std::uint32_t far_plane[4];
  std::uint32_t octant;  // bit k: backward along axis k
  float sign_slope, sign_floor;
  float entry_slope, entry_linear, entry_floor;
  float parameter_cap;  // no triangle is hit beyond it
  bool is_moved = false;

  /// Local parameter of a world parameter, rounded up; negative: the walk is over.
  float local_limit(double limit) const;
  /// Local parameter of a world parameter known to within 2^-40, rounded down; negative: nothing is certainly within
  /// it.
  float sure_limit(double limit) const;

  double to_local_1, to_local_2;  // their product turns s into the local parameter, before the start is moved
  // How far the start was moved, in local parameters; used if is_moved.
  double moved[3];
};

namespace ray_detail {

inline constexpr double kUnit = 0x1p-24;
inline constexpr double kTiny = 0x1p-120;
/// An axis along which the direction is smaller than this counts as parallel: over the longest path (parameter 16) the
/// ray drifts by 2^-55, half of kLeastSlack.
inline constexpr double kLeastDirection = 0x1p-60;
inline constexpr double kLeastSlack = 0x1p-54;
/// A start farther out than this is first moved up to the scene, so that floats resolve the scene instead of the
/// distance to it.
inline constexpr double kNear = 4;
inline constexpr double kEverything = 0x1p40;

/// A ray in local coordinates, still in double.
struct LocalRay {
  double origin[3];
  double direction[3];     // the largest component in [1, 2)
  double origin_error[3];  // bound on the error of the origin
  double slack;
};

/// A float at or above the value, and one at or below it.
inline float above(double value) { return static_cast<float>(value + 0x1p-23 * std::abs(value) + kTiny); }
inline float below(double value) { return static_cast<float>(value - 0x1p-23 * std::abs(value) - kTiny); }

/// Chooses near and far planes by the signs of the inverse direction.
inline void set_planes(RayFrame& out) {
  out.octant = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned backward = out.inverse[axis] < 0 ? 1 : 0;
    const auto first = static_cast<std::uint32_t>(offsetof(Node, plane) + 2 * kPlaneBytes * axis);
    out.near_plane[axis] = first + kPlaneBytes * backward;
    out.far_plane[axis] = first + kPlaneBytes * (1 - backward);
    out.octant |= backward << axis;
  }
}

/// Sets one axis. worst_error: the largest of all axes; it lengthens the path along which a clamped direction drifts.
inline void set_axis(const LocalRay& local, double worst_error, int axis, RayFrame& out) {
  const double d = local.direction[axis];
  const double clamped = std::abs(d) < kLeastDirection ? std::copysign(kLeastDirection, d) : d;
  const auto start = static_cast<float>(local.origin[axis]);
  const auto start_value = static_cast<double>(start);
  const double error = local.origin_error[axis] + std::abs(local.origin[axis] - start_value);
  // Two roundings of plane * inverse, one of the difference, one of the inverse itself: see RayFrame.
  const double rounding = kUnit * (4 + 3 * std::abs(start_value));
  const double drift = kLeastSlack + 2 * kLeastDirection * worst_error;
  const double wide = std::min(error + local.slack + rounding + drift, kEverything);
  const auto inverse = static_cast<float>(1 / clamped);
  const auto inverse_value = static_cast<double>(inverse);
  const double near_shift = std::copysign(wide, inverse_value);
  out.origin[axis] = start;
  out.direction[axis] = static_cast<float>(clamped);
  out.inverse[axis] = inverse;
  out.near_offset[axis] = above((start_value + near_shift) * inverse_value);
  out.far_offset[axis] = below((start_value - near_shift) * inverse_value);
}

/// Makes every triangle of a visited leaf a candidate.
inline void accept_triangles(RayFrame& out) {
  out.sign_slope = out.entry_slope = out.entry_linear = 0;
  out.sign_floor = out.entry_floor = static_cast<float>(kEverything);
  out.parameter_cap = static_cast<float>(kEverything);
}

/// Sets the slack of the triangle test, as derived at the top of bvh_ray.cpp.
inline void set_leaf_slack(double start_error, double slack, RayFrame& out) {
  if (!(start_error <= 1)) {
    accept_triangles(out);
    return;
  }
  constexpr double kRaise = 1.01;
  const auto reach =
      static_cast<double>(std::max({std::abs(out.origin[0]), std::abs(out.origin[1]), std::abs(out.origin[2])}));
  const auto d = static_cast<double>(
      std::max({std::abs(out.direction[0]), std::abs(out.direction[1]), std::abs(out.direction[2])}));
  const double c = 1 + reach + start_error + slack;
  const double corner = start_error + slack + kUnit;
  const double k0 = 6 * d * (corner + 8.5 * kUnit * c);
  out.sign_slope = static_cast<float>(kRaise * (2 * k0 + 26 * kUnit * c * d + 96 * kUnit * d));
  out.sign_floor = static_cast<float>(kRaise * 24 * d * slack * (c + 4) + kTiny);
  out.entry_slope = static_cast<float>(kRaise * (6 * corner + (61 + 48 * d) * kUnit * c));
  out.entry_linear = static_cast<float>(kRaise * 24 * slack * c * (1 + d));
  out.entry_floor = static_cast<float>(kRaise * 24 * slack * slack * c * (1 + d) + kTiny);
  out.parameter_cap = static_cast<float>(kRaise * c);
}

/// Sets it for a start whose only error is its rounding to floats, and no slack. For a start at most r away, with w = 1
/// + r, the sign slope is 1.01 d u (12 r + 12 + 128 w + 96) = 1.01 d u (140 w + 96), the entry slope 1.01 u (6 r + 6 +
/// (61 + 48 d) w) = 1.01 u (67 + 48 d) w; the other 2 per mille cover terms of 2^-29 of these and the roundings here.
inline void set_usual_leaf_slack(float reach, float d, RayFrame& out) {
  constexpr auto kRaised = static_cast<float>(1.012 * kUnit);
  const float w = 1 + reach;
  out.sign_slope = d * (140 * kRaised * w + 96 * kRaised);
  out.sign_floor = static_cast<float>(kTiny);
  out.entry_slope = (48 * kRaised * d + 67 * kRaised) * w;
  out.entry_linear = 0;
  out.entry_floor = static_cast<float>(kTiny);
  out.parameter_cap = 1.012f * w;
}

inline void finish(const LocalRay& local, RayFrame& out) {
  double worst = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double rounded = local.origin[axis] - static_cast<double>(static_cast<float>(local.origin[axis]));
    worst = std::max(worst, local.origin_error[axis] + std::abs(rounded));
  }
  for (int axis = 0; axis < 3; ++axis) set_axis(local, worst, axis, out);
  set_planes(out);
  set_leaf_slack(worst, local.slack, out);
}

/// 2^exponent, for exponents of normal numbers.
inline double power_of_two(int exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(1023 + exponent) << 52);
}

/// The exponent of a non-negative number; far outside the usual range for zero, denormals, infinity and NaN.
inline int exponent_of(double value) { return static_cast<int>(std::bit_cast<std::uint64_t>(value) >> 52) - 1023; }

/// Whether scales and their products stay in range without special care.
inline bool is_usual(int direction_exponent, int scale_exponent) {
  constexpr int kUsual = 450;
  return std::abs(direction_exponent) < kUsual && std::abs(scale_exponent) < kUsual;
}

/// The slow path, for any ray: starts far out, directions and scenes of extreme scale, slack as large as the scene.
/// False: the ray certainly misses the scene.
bool prepare_any_ray(const Layout& layout, const Ray& ray, double slack_m, RayFrame& frame);

}  // namespace ray_detail

inline float RayFrame::local_limit(double limit) const {
  // Avoids 0 * infinity: an endless ray has no limit at any scale, and if a scale overflows nothing is known.
  if (limit == std::numeric_limits<double>::infinity()) return std::numeric_limits<float>::infinity();
  if (!(limit >= 0)) return -1;
  if (limit == 0 && std::isinf(to_local_1)) return std::numeric_limits<float>::infinity();
  double parameter = limit * to_local_1;
  if (is_moved) {
    parameter *= to_local_2;
    // Each subtraction is exact while the two are within a factor of two of each other, else it rounds once.
    for (const double move : moved) parameter -= move;
  }
  return ray_detail::above(parameter);
}

/// If the start was moved, the limit is a difference, which may have lost all its digits. An endless ray's is beyond
/// every parameter but finite, since its product with an edge-on triangle's determinant would be NaN.
inline float RayFrame::sure_limit(double limit) const {
  if (limit == std::numeric_limits<double>::infinity()) return 2 * parameter_cap;
  return is_moved ? -1 : local_limit(limit) * (1 - 0x1p-20f) - static_cast<float>(4 * ray_detail::kTiny);
}

}  // namespace collided::engine::bvh
