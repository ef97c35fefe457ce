#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include "server/geometry/mesh.hpp"
#include "tests/studies/bench/peers/convex_peer.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

Geometry geometry_of(const Sphere& s) { return std::make_shared<fcl::Sphered>(s.radius_m); }
Geometry geometry_of(const Box& b) {
  return std::make_shared<fcl::Boxd>(2 * b.half_m[0], 2 * b.half_m[1], 2 * b.half_m[2]);
}
Geometry geometry_of(const Cylinder& c) { return std::make_shared<fcl::Cylinderd>(c.radius_m, c.b[2] - c.a[2]); }
Geometry geometry_of(const Cone& c) { return std::make_shared<fcl::Coned>(c.radius_m, c.apex[2] - c.base[2]); }
Geometry geometry_of(const Ellipsoid& e) {
  return std::make_shared<fcl::Ellipsoidd>(e.half_m[0], e.half_m[1], e.half_m[2]);
}
// Not compared.
Geometry geometry_of(const Capsule&) { return nullptr; }
Geometry geometry_of(const HalfSpace&) { return nullptr; }
Geometry geometry_of(const Hull& hull) {
  auto vertices = std::make_shared<std::vector<fcl::Vector3d>>(hull.mesh->vertices.begin(), hull.mesh->vertices.end());
  auto faces = std::make_shared<std::vector<int>>();
  for (const TriangleCorners& t : hull.mesh->triangles) {
    faces->push_back(3);
    for (const std::uint32_t corner : t) faces->push_back(static_cast<int>(corner));
  }
  return std::make_shared<fcl::Convexd>(vertices, static_cast<int>(hull.mesh->triangles.size()), faces);
}

fcl::CollisionObjectd object_of(const ConvexCase& one) {
  fcl::Transform3d pose = fcl::Transform3d::Identity();
  pose.translation() = one.pose.position;
  pose.linear() = one.pose.rotation.toRotationMatrix();
  return {std::visit([](const auto& shape) { return geometry_of(shape); }, one.shape), pose};
}

class Fcl final : public ConvexPeer {
 public:
  Fcl(const std::vector<ConvexCase>& a, const std::vector<ConvexCase>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) pairs_.emplace_back(object_of(a[i]), object_of(b[i]));
  }
  std::vector<bool> answers() override {
    std::vector<bool> all;
    for (const auto& [a, b] : pairs_) all.push_back(collides(a, b, false));
    return all;
  }
  void collide(bool contacts) override {
    for (const auto& [a, b] : pairs_) collides(a, b, contacts);
  }

 private:
  static bool collides(const fcl::CollisionObjectd& a, const fcl::CollisionObjectd& b, bool contacts) {
    const fcl::CollisionRequestd request(1, contacts);
    fcl::CollisionResultd result;
    return fcl::collide(&a, &b, request, result) > 0;
  }

  std::vector<std::pair<fcl::CollisionObjectd, fcl::CollisionObjectd>> pairs_;
};

}  // namespace

std::unique_ptr<ConvexPeer> fcl_convex_peer(const std::vector<ConvexCase>& a, const std::vector<ConvexCase>& b) {
  return std::make_unique<Fcl>(a, b);
}

}  // namespace collided::bench
