#pragma once

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>

#include <memory>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::bench {
using namespace engine;

inline btVector3 bullet(const Vec3& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

/// A mesh in Bullet's quantised tree of triangles.
struct BulletMesh {
  std::vector<btVector3> vertices;
  std::vector<int> corners;
  std::unique_ptr<btTriangleIndexVertexArray> array;
  std::unique_ptr<btBvhTriangleMeshShape> shape;

  explicit BulletMesh(const TriangleMesh& mesh) {
    for (const Vec3& vertex : mesh.vertices) vertices.push_back(bullet(vertex));
    for (const TriangleCorners& t : mesh.triangles) {
      for (const std::uint32_t corner : t) corners.push_back(static_cast<int>(corner));
    }
    array = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.triangles.size()), corners.data(), 3 * static_cast<int>(sizeof(int)),
        static_cast<int>(vertices.size()), &vertices[0][0], static_cast<int>(sizeof(btVector3)));
    shape = std::make_unique<btBvhTriangleMeshShape>(array.get(), true);
  }
};

}  // namespace collided::bench
