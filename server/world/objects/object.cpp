#include "server/world/objects/object.hpp"

#include <algorithm>

namespace collided::engine {

std::uint32_t StaticScene::part_of(std::uint32_t triangle) const {
  const auto after = std::upper_bound(parts.begin(), parts.end(), triangle,
                                      [](std::uint32_t t, const Part& part) { return t < part.first_triangle; });
  return static_cast<std::uint32_t>(after - parts.begin()) - 1;
}

std::uint64_t StaticScene::bytes() const {
  return tree.report().bytes + mesh.vertices.capacity() * sizeof(Vec3) +
         mesh.triangles.capacity() * sizeof(TriangleCorners) + parts.capacity() * sizeof(Part) +
         part_objects.capacity() * sizeof(ObjectId);
}

}  // namespace collided::engine
