#include "server/world/groups/uncovered.hpp"

#include "server/geometry/box_union.hpp"

namespace collided::engine {

std::optional<Vec3> uncovered_near(std::span<const Aabb> boxes, double distance_m, std::span<const Aabb> covers) {
  for (const Aabb& box : boxes) {
    if (box.empty()) continue;
    const Vec3 middle = box.low / 2 + box.high / 2;
    if (const std::optional<Aabb> outside = nearest_part_outside(grown(box, distance_m), covers, middle))
      return nearest_in(*outside, middle);
  }
  return std::nullopt;
}

}  // namespace collided::engine
