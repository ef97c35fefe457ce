#include "server/world/objects/indexed_mesh.hpp"

#include <algorithm>

#include "server/geometry/tolerance.hpp"
#include "server/world/objects/part_index.hpp"

namespace collided::engine {
namespace {

double radius_of(const TriangleMesh& mesh) {
  double radius_m = 0;
  for (const Vec3& vertex : mesh.vertices) radius_m = std::max(radius_m, vertex.stableNorm());
  return radius_m * (1 + kChainSlack);  // covers the rounding of the norm
}

}  // namespace

std::shared_ptr<const IndexedMesh> indexed_mesh(std::shared_ptr<const TriangleMesh> mesh, Bvh tree) {
  auto indexed = std::make_shared<IndexedMesh>();
  indexed->radius_m = radius_of(*mesh);
  indexed->mesh = std::move(mesh);
  indexed->tree = std::move(tree);
  return indexed;
}

ObjectInfo without_world(const Shape& shape, const std::function<bool()>& cancelled) {
  ObjectInfo info;
  info.primitives = SharedPrimitives(shape.primitives);
  if (auto parts = index_parts(info.primitives)) info.rare.edit().parts = std::move(parts);
  if (shape.mesh) {
    info.mesh =
        indexed_mesh(shape.mesh, Bvh::build(*shape.mesh, {.threads = 1, .progress = {}, .cancelled = cancelled}));
  }
  return info;
}

}  // namespace collided::engine
