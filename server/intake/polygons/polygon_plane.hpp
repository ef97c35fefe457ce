#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/vector.hpp"
#include "server/intake/polygons/planar.hpp"

namespace collided::engine {

/// A polygon projected to the coordinate plane in which it appears largest, mirrored if needed so that it turns left.
/// Coordinates are dropped or swapped but not changed, so orientation tests on the projection are exact.
/// source  Newell's normal: Sutherland, Sproull, Schumacker, "A characterization of ten hidden-surface algorithms",
///         1974
std::vector<PlanePoint> flattened(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices);

/// Projects several rings, one after the other, by the normal of the first one.
std::vector<PlanePoint> flattened(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> ring_ends,
                                  const std::vector<Vec3>& vertices);

/// How far a polygon is from flat: the largest distance of a corner from the plane through the corners' mean across
/// Newell's normal, and the polygon's size. Both are 0 for a polygon without area.
struct Flatness {
  double off_plane_m = 0;
  double size_m = 0;
  bool is_flat() const;  // within kFlatEnough of the size
};
Flatness flatness(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices);

}  // namespace collided::engine
