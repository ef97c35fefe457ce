#pragma once

#include <fcl/geometry/bvh/BVH_model.h>

#include <memory>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::bench {
using namespace engine;

using FclMesh = fcl::BVHModel<fcl::OBBRSS<double>>;

inline std::shared_ptr<FclMesh> fcl_mesh(const TriangleMesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  for (const TriangleCorners& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto model = std::make_shared<FclMesh>();
  model->beginModel();
  model->addSubModel(mesh.vertices, triangles);
  model->endModel();
  return model;
}

}  // namespace collided::bench
