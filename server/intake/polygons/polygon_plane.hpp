#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/vector.hpp"
#include "server/intake/polygons/planar.hpp"

namespace collided::engine {

/// A polygon in the coordinate plane that sees most of it, turning to the left as a whole. Coordinates stay as they are
/// but for a mirror, so each sign found there is exact.
/// source  Newell's normal: Sutherland, Sproull, Schumacker, "A characterization of ten hidden-surface algorithms", 1974
std::vector<PlanePoint> flattened(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices);

/// The same for more rings, one after the other; the first one's normal counts.
std::vector<PlanePoint> flattened(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> ring_ends,
                                  const std::vector<Vec3>& vertices);

/// How far the corners lie from one plane: the largest distance from the one through their middle along Newell's normal,
/// and the polygon's size. Both 0 for a polygon without area.
struct Flatness {
  double off_plane_m = 0;
  double size_m = 0;
  bool is_flat() const;  // to kFlatEnough
};
Flatness flatness(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices);

}  // namespace collided::engine
