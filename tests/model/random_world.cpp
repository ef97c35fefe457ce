#include "tests/model/random_world.hpp"

namespace collided::model {
using namespace engine;

/// Three different ones, each used again and again. Long and thin, so that their boxes meet where they do not.
std::shared_ptr<const TriangleMesh> RandomWorld::mesh() {
  while (meshes_.size() < 3) {
    auto made = std::make_shared<TriangleMesh>();
    made->vertices = {point(0.9), point(0.9), point(0.9), point(0.9)};
    made->triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    meshes_.push_back(made);
  }
  return one_of(meshes_);
}

Primitive RandomWorld::solid(int kind) {
  switch (kind) {
    case 0: return Sphere{point(0.1), uniform(0.1, 0.5)};
    case 1: return Box{.center = point(0.1), .half_m = {0.1, uniform(0.1, 0.5), 0.3}};
    case 2: return Capsule{point(0.5), point(0.5), uniform(0.05, 0.2)};
    case 3: return Cylinder{point(0.5), point(0.5), uniform(0.05, 0.3)};
    case 4: return Cone{point(0.5), point(0.5), uniform(0.05, 0.3)};
    case 5: return Ellipsoid{.center = point(0.1), .half_m = {0.1, uniform(0.1, 0.5), 0.3}};
    default: break;
  }
  const std::vector<Vec3> points{point(0.5), point(0.5), point(0.5), point(0.5), point(0.5), point(0.5)};
  return Hull{std::make_shared<const TriangleMesh>(*convex_hull(points))};
}

Shape RandomWorld::shape() {
  const int kind = only_slow_meshes ? 8 : below(12);
  Shape made;
  if (kind >= 8) made.mesh = mesh();
  if (kind < 7) made.primitives.push_back(solid(kind));
  if (kind == 7) made.primitives = {solid(0), solid(2)};
  if (kind == 11) made.primitives.push_back(solid(1));
  return made;
}

/// Two sheets that rise and fall, one above the other, and something that stands between.
Scene RandomWorld::scene(const std::string& name) {
  Scene made{.name = name};
  constexpr std::uint32_t kSide = 4;
  for (std::uint32_t part = 0; part < 2; ++part) {
    const std::uint32_t first_vertex = static_cast<std::uint32_t>(made.mesh.vertices.size());
    const std::uint32_t first = static_cast<std::uint32_t>(made.mesh.triangles.size());
    for (std::uint32_t i = 0; i < (kSide + 1) * (kSide + 1); ++i) {
      made.mesh.vertices.push_back(
          {i % (kSide + 1) * 1.0 - 2, i / (kSide + 1) * 1.0 - 2, part * 2.0 - 1 + uniform(-0.4, 0.4)});
    }
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
      const std::uint32_t v = first_vertex + i / kSide * (kSide + 1) + i % kSide;
      made.mesh.triangles.push_back({v, v + 1, v + kSide + 1});
      made.mesh.triangles.push_back({v + 1, v + kSide + 2, v + kSide + 1});
    }
    made.parts.push_back({.name = name + "/" + std::to_string(part),
                          .first_triangle = first,
                          .triangle_count = 2 * kSide * kSide,
                          .filter = filter()});
  }
  SceneObject object{.name = name + "/object"};
  object.shape = shape();
  object.pose = pose();
  object.filter = filter();
  made.objects.push_back(object);
  return made;
}

}  // namespace collided::model
