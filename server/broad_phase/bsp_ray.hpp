#pragma once

#include <cstdint>

#include "server/broad_phase/bsp_layout.hpp"
#include "server/geometry/ray.hpp"

namespace collided::bsp {

/// A ray made ready for the float walk: local coordinates, its start moved up to the scene, its largest direction
/// component in [1, 2), and every rounding on the way turned into slack. All slack is outward: the walk may visit
/// a box or keep a triangle that the ray misses, never the reverse.
///
/// slabs   near side of axis k: plane * inverse[k] - near_offset[k] is at most the true parameter; far side: at least
/// leaves  the signs U, V, W of a triangle are trusted beyond sign_slope * E + sign_floor, its parameter beyond
///         (entry_slope * E + entry_linear) * E + entry_floor; E the largest edge component (derived in bsp_ray.cpp)
struct RayFrame {
  float inverse[3];
  float near_offset[3];
  float far_offset[3];
  std::uint32_t near_plane[3];  // byte offset in Node
  std::uint32_t far_plane[3];
  float origin[3];
  float direction[3];
  float sign_slope, sign_floor;
  float entry_slope, entry_linear, entry_floor;
  float parameter_cap;  // no triangle is met beyond it

  /// Local parameter of a world parameter, rounded up; negative: the walk ends.
  float local_limit(double limit) const;

  double to_local_1, to_local_2;  // their product turns s into the local parameter, before the start was moved
  double moved[3];
};

/// False: the ray surely misses the scene within the limit.
bool prepare_ray(const Layout& layout, const Ray& ray, double limit, double slack_m, RayFrame& frame);

}  // namespace collided::bsp
