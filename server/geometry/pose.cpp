#include "server/geometry/pose.hpp"

#include <cmath>

#include "server/geometry/mesh.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

// The fixed order of operations in a row's product. Not Eigen's, whose order may change with the vector width.
double row_times(const Mat3& r, int row, const Vec3& v) {
  return (r(row, 0) * v[0] + r(row, 1) * v[1]) + r(row, 2) * v[2];
}

Mat3 turned(const Frame& frame, const Mat3& axes) {
  Mat3 result;
  // By columns, as both are stored.
  const double* r = frame.rotation.data();
  const double* axis = axes.data();
  double* to = result.data();
  for (int column = 0; column < 3; ++column, axis += 3, to += 3) {
    for (int row = 0; row < 3; ++row) to[row] = (r[row] * axis[0] + r[row + 3] * axis[1]) + r[row + 6] * axis[2];
  }
  return result;
}

}  // namespace

Frame frame_of(const Pose& pose) {
  const double norm2 = pose.rotation.squaredNorm();
  double w = pose.rotation.w(), x = pose.rotation.x(), y = pose.rotation.y(), z = pose.rotation.z();
  if (!(std::abs(norm2 - 1) <= kUnitSquareSlack)) {
    const double divisor = std::sqrt(norm2);
    w /= divisor, x /= divisor, y /= divisor, z /= divisor;
  }
  const double x2 = x + x;
  const double y2 = y + y;
  const double z2 = z + z;
  Frame frame{.rotation = Mat3(), .position = pose.position};
  Mat3& r = frame.rotation;
  r(0, 0) = 1 - (y * y2 + z * z2);
  r(0, 1) = x * y2 - w * z2;
  r(0, 2) = x * z2 + w * y2;
  r(1, 0) = x * y2 + w * z2;
  r(1, 1) = 1 - (x * x2 + z * z2);
  r(1, 2) = y * z2 - w * x2;
  r(2, 0) = x * z2 - w * y2;
  r(2, 1) = y * z2 + w * x2;
  r(2, 2) = 1 - (x * x2 + y * y2);
  return frame;
}

Vec3 place(const Frame& frame, const Vec3& point) {
  Vec3 placed;
  for (int row = 0; row < 3; ++row) placed[row] = row_times(frame.rotation, row, point) + frame.position[row];
  return placed;
}

Pose composed(const Pose& a, const Pose& b) {
  return {.position = place(frame_of(a), b.position), .rotation = (a.rotation * b.rotation).normalized()};
}

Pose inverse(const Pose& pose) {
  const Quat back = pose.rotation.conjugate().normalized();
  return {.position = -place(frame_of({.position = Vec3::Zero(), .rotation = back}), pose.position), .rotation = back};
}

Sphere place(const Frame& frame, const Sphere& sphere) { return {place(frame, sphere.center), sphere.radius_m}; }

Box place(const Frame& frame, const Box& box) {
  return {place(frame, box.center), turned(frame, box.axes), box.half_m};
}

Capsule place(const Frame& frame, const Capsule& capsule) {
  return {place(frame, capsule.a), place(frame, capsule.b), capsule.radius_m};
}

Cylinder place(const Frame& frame, const Cylinder& cylinder) {
  return {place(frame, cylinder.a), place(frame, cylinder.b), cylinder.radius_m};
}

Cone place(const Frame& frame, const Cone& cone) {
  return {place(frame, cone.apex), place(frame, cone.base), cone.radius_m};
}

Ellipsoid place(const Frame& frame, const Ellipsoid& ellipsoid) {
  return {place(frame, ellipsoid.center), turned(frame, ellipsoid.axes), ellipsoid.half_m};
}

Hull place(const Frame& frame, const Hull& hull) { return {hull.mesh, frame.rotation, frame.position}; }

HalfSpace place(const Frame& frame, const HalfSpace& half_space) {
  Vec3 normal;
  for (int row = 0; row < 3; ++row) normal[row] = row_times(frame.rotation, row, half_space.normal);
  return {place(frame, half_space.point), normal};
}

Vec3 vertex_of(const Hull& hull, std::size_t number) {
  return place(Frame{hull.rotation, hull.position}, hull.mesh->vertices[number]);
}

Triangle place(const Frame& frame, const Triangle& triangle) {
  return {place(frame, triangle.a), place(frame, triangle.b), place(frame, triangle.c)};
}

Primitive place(const Frame& frame, const Primitive& primitive) {
  return std::visit([&](const auto& shape) { return Primitive(place(frame, shape)); }, primitive);
}

}  // namespace collided::engine
