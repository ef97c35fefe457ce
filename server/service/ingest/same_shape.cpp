#include "server/service/ingest/same_shape.hpp"

#include <algorithm>

#include "server/geometry/mesh.hpp"

namespace collided::engine::service {
namespace {

bool is_same(const std::shared_ptr<const TriangleMesh>& a, const std::shared_ptr<const TriangleMesh>& b) {
  if (a == b) return true;
  return a && b && a->vertices == b->vertices && a->triangles == b->triangles;
}

bool is_same(const Sphere& a, const Sphere& b) { return a.center == b.center && a.radius_m == b.radius_m; }
bool is_same(const Box& a, const Box& b) { return a.center == b.center && a.axes == b.axes && a.half_m == b.half_m; }
bool is_same(const Capsule& a, const Capsule& b) { return a.a == b.a && a.b == b.b && a.radius_m == b.radius_m; }
bool is_same(const Cylinder& a, const Cylinder& b) { return a.a == b.a && a.b == b.b && a.radius_m == b.radius_m; }
bool is_same(const Cone& a, const Cone& b) { return a.apex == b.apex && a.base == b.base && a.radius_m == b.radius_m; }
bool is_same(const Ellipsoid& a, const Ellipsoid& b) {
  return a.center == b.center && a.axes == b.axes && a.half_m == b.half_m;
}
bool is_same(const Hull& a, const Hull& b) {
  return is_same(a.mesh, b.mesh) && a.rotation == b.rotation && a.position == b.position;
}
bool is_same(const HalfSpace& a, const HalfSpace& b) { return a.point == b.point && a.normal == b.normal; }

bool is_same_primitive(const Primitive& a, const Primitive& b) {
  if (a.index() != b.index()) return false;
  return std::visit([&](const auto& one) { return is_same(one, std::get<std::decay_t<decltype(one)>>(b)); }, a);
}

}  // namespace

bool is_same_shape(const Shape& a, const Shape& b) {
  return a.is_unknown == b.is_unknown && is_same(a.mesh, b.mesh) &&
         std::equal(a.primitives.begin(), a.primitives.end(), b.primitives.begin(), b.primitives.end(),
                    is_same_primitive);
}

}  // namespace collided::engine::service
