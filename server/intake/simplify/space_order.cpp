#include "server/intake/simplify/space_order.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/geometry/aabb.hpp"

namespace collided::engine {
namespace {

constexpr double kSteps = 0x1fffff;  // along each axis

/// The low 21 bits, two zeros after each.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1f00000000ffff;
  bits = (bits | bits << 16) & 0x1f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

}  // namespace

std::vector<std::uint32_t> space_order(std::span<const Vec3> points) {
  Aabb all;
  for (const Vec3& point : points) all.extend(point);
  const double largest = points.empty() ? 0 : (all.high - all.low).maxCoeff();
  const double scale = largest > 0 && std::isfinite(largest) ? kSteps / largest : 0;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3 at = (points[i] - all.low) * scale;
    for (int axis = 0; axis < 3; ++axis) {
      keys[i].first |= spread(static_cast<std::uint64_t>(std::clamp(at[axis], 0.0, kSteps))) << axis;
    }
    keys[i].second = i;
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].second;
  return order;
}

}  // namespace collided::engine
