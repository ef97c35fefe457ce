#include "client/draw/drawing/outlines.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace collided::draw {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// How far outside its curve a chain runs, relative to the curve's size: more than all roundings here.
constexpr double kOutside = 1e-9;

Vec3 placed(const Pose& pose, const Vec3& p) { return pose.rotation * p + pose.position; }

/// The eye: a point or, for a parallel projection, a direction.
struct Eye {
  Vec3 place;  // a point; if is_far, the direction to the eye
  bool is_far;
  Vec3 from(const Vec3& p) const { return is_far ? place : Vec3(place - p); }
};

Eye eye_of(const Camera& camera) {
  return camera.is_orthographic() ? Eye{-camera.forward(), true} : Eye{camera.eye(), false};
}

/// center + cos u + sin v, from one angle to another.
struct Arc {
  Vec3 center;
  Vec3 u;
  Vec3 v;
  double from = 0;
  double to = kTurn;
};

std::vector<Vec3> chain(const Arc& arc, const Camera& camera) {
  const double radius_m = std::max(arc.u.norm(), arc.v.norm());
  const double radius_px = radius_m / camera.pixel_m(arc.center);
  // A polygon around a circle is off by R (1/cos(step/2) - 1) at its corners. Half of kCurveError_px is allowed, since
  // parts of the circle may be nearer to the eye than its middle.
  const double sagitta = std::min(0.25, kCurveError_px / 2 / std::max(radius_px, 1e-3));
  const double step = std::min(2 * std::acos(1 / (1 + sagitta)), kTurn / 12);
  const int count = std::clamp(static_cast<int>(std::ceil((arc.to - arc.from) / step)), 1, 4'096);
  const double exact_step = (arc.to - arc.from) / count;
  const double outward = (1 + kOutside) / std::cos(exact_step / 2);
  std::vector<Vec3> points;
  for (int i = 0; i <= count; ++i) {
    const double angle = arc.from + exact_step * i;
    points.push_back(arc.center + outward * (std::cos(angle) * arc.u + std::sin(angle) * arc.v));
  }
  return points;
}

/// The silhouette of a unit sphere about the origin: a circle with its centre along `toward`. There is none for an eye
/// inside.
struct SightCircle {
  Vec3 center;
  Vec3 u;
  Vec3 v;
};
std::optional<SightCircle> sight_circle(const Eye& eye) {
  const double distance = eye.place.norm();
  if (!eye.is_far && !(distance > 1)) return std::nullopt;
  const Vec3 toward = eye.place / distance;
  const double height = eye.is_far ? 0 : 1 / distance;
  const Vec3 u = toward.unitOrthogonal();
  const double radius = std::sqrt(1 - height * height);
  return SightCircle{height * toward, radius * u, radius * toward.cross(u)};
}

struct ImageLine {
  Vec3 a;
  Vec3 b;
};

/// An axis in the world with two directions at right angles to it.
struct SolidAxis {
  Vec3 a;
  Vec3 along;  // of unit length
  Vec3 u;
  Vec3 v;
  double length_m;
};

SolidAxis axis_of(const Vec3& a, const Vec3& b) {
  const double length = (b - a).norm();
  const Vec3 along = length > 0 ? Vec3((b - a) / length) : Vec3(Vec3::UnitZ());
  const Vec3 u = along.unitOrthogonal();
  return {a, along, u, along.cross(u), length};
}

/// The two angles about the axis at which a surface with the normal cos u + sin v + slope along is edge-on to the eye.
std::optional<std::pair<double, double>> edge_on_angles(const SolidAxis& axis, const Vec3& toward_eye, double slope,
                                                        double lift_m) {
  const double x = axis.u.dot(toward_eye);
  const double y = axis.v.dot(toward_eye);
  const double across = std::hypot(x, y);
  const double cosine = (lift_m - slope * axis.along.dot(toward_eye)) / across;
  if (!(across > 0 && std::abs(cosine) <= 1)) return std::nullopt;
  const double middle = std::atan2(y, x);
  return std::pair(middle - std::acos(cosine), middle + std::acos(cosine));
}

Vec3 around(const SolidAxis& axis, double angle) { return std::cos(angle) * axis.u + std::sin(angle) * axis.v; }

/// Adds the part of a sphere's silhouette that is behind a plane through its centre (normal . (p - center) <= 0).
void add_half_outline(const Vec3& center, double radius_m, const Vec3& normal, const Eye& eye, const Camera& camera,
                      std::uint32_t object, std::vector<FeatureLine>& lines) {
  const Eye local{eye.is_far ? eye.place : Vec3((eye.place - center) / radius_m), eye.is_far};
  const std::optional<SightCircle> circle = sight_circle(local);
  if (!circle) return;
  // normal . (c + cos u + sin v) <= 0
  const double height = normal.dot(circle->center);
  const double x = normal.dot(circle->u);
  const double y = normal.dot(circle->v);
  const double reach = std::hypot(x, y);
  Arc arc{center + radius_m * circle->center, radius_m * circle->u, radius_m * circle->v};
  if (height + reach > 0) {
    if (height - reach >= 0) return;
    const double half = std::acos(std::clamp(-height / reach, -1.0, 1.0));
    const double middle = std::atan2(y, x);
    arc.from = middle + half;
    arc.to = middle + kTurn - half;
  }
  lines.push_back({chain(arc, camera), LineKind::silhouette, object});
}

}  // namespace

void add_outline(const SphereShape& sphere, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines) {
  if (!(sphere.radius_m > 0)) return;
  // With a zero normal the whole silhouette is behind the plane.
  add_half_outline(placed(pose, sphere.center), sphere.radius_m, Vec3::Zero(), eye_of(camera), camera, object, lines);
}

void add_outline(const CapsuleShape& capsule, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines) {
  const SolidAxis axis = axis_of(placed(pose, capsule.a), placed(pose, capsule.b));
  const double radius_m = capsule.radius_m;
  if (!(axis.length_m > 0)) return add_outline(SphereShape{radius_m, capsule.a}, pose, camera, object, lines);
  const Vec3 b = axis.a + axis.length_m * axis.along;
  if (!(radius_m > 0)) {
    lines.push_back({{axis.a, b}, LineKind::silhouette, object});
    return;
  }
  const Eye eye = eye_of(camera);
  add_half_outline(axis.a, radius_m, axis.along, eye, camera, object, lines);
  add_half_outline(b, radius_m, -axis.along, eye, camera, object, lines);
  const auto angles = edge_on_angles(axis, eye.from(axis.a), 0, eye.is_far ? 0 : radius_m);
  if (!angles) return;
  for (const double angle : {angles->first, angles->second}) {
    const Vec3 out = radius_m * (1 + kOutside) * around(axis, angle);
    lines.push_back({{axis.a + out, b + out}, LineKind::silhouette, object});
  }
}

void add_outline(const CylinderShape& cylinder, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines) {
  const SolidAxis axis = axis_of(placed(pose, cylinder.a), placed(pose, cylinder.b));
  const double radius_m = cylinder.radius_m;
  const Vec3 b = axis.a + axis.length_m * axis.along;
  for (const Vec3& end : {axis.a, b}) {
    lines.push_back({chain({end, radius_m * axis.u, radius_m * axis.v}, camera), LineKind::crease, object});
  }
  const Eye eye = eye_of(camera);
  const auto angles = edge_on_angles(axis, eye.from(axis.a), 0, eye.is_far ? 0 : radius_m);
  if (!angles) return;
  for (const double angle : {angles->first, angles->second}) {
    const Vec3 out = radius_m * (1 + kOutside) * around(axis, angle);
    lines.push_back({{axis.a + out, b + out}, LineKind::silhouette, object});
  }
}

void add_outline(const ConeShape& cone, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines) {
  const SolidAxis axis = axis_of(placed(pose, cone.base), placed(pose, cone.apex));
  const Vec3 apex = axis.a + axis.length_m * axis.along;
  const double radius_m = cone.radius_m;
  if (!(axis.length_m > 0)) return;
  lines.push_back({chain({axis.a, radius_m * axis.u, radius_m * axis.v}, camera), LineKind::crease, object});
  // Every tangent plane of a cone goes through its apex.
  const auto angles = edge_on_angles(axis, eye_of(camera).from(apex), radius_m / axis.length_m, 0);
  if (!angles) return;
  for (const double angle : {angles->first, angles->second}) {
    const Vec3 out = radius_m * (1 + kOutside) * around(axis, angle);
    lines.push_back({{axis.a + out, apex + kOutside * out}, LineKind::silhouette, object});
  }
}

void add_outline(const EllipsoidShape& ellipsoid, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines) {
  if (!(ellipsoid.half_m.array() > 0).all()) return;
  // Computed where the ellipsoid is the unit sphere: affine maps preserve silhouettes.
  const Eigen::Matrix3d axes = (pose.rotation * ellipsoid.rotation).toRotationMatrix();
  const Eigen::Matrix3d out_of = axes * ellipsoid.half_m.asDiagonal();
  const Vec3 center = placed(pose, ellipsoid.center);
  const Eye eye = eye_of(camera);
  const Vec3 seen = axes.transpose() * eye.from(center);
  const std::optional<SightCircle> circle =
      sight_circle({(seen.array() / ellipsoid.half_m.array()).matrix(), eye.is_far});
  if (!circle) return;
  lines.push_back({chain({center + out_of * circle->center, out_of * circle->u, out_of * circle->v}, camera),
                   LineKind::silhouette, object});
}

void add_outline(const BoxShape& box, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines) {
  const Eigen::Matrix3d axes = (pose.rotation * box.rotation).toRotationMatrix();
  const Vec3 center = placed(pose, box.center);
  const Eye eye = eye_of(camera);
  const auto faces = [&](int axis, double side) {
    const Vec3 normal = side * axes.col(axis);
    return normal.dot(eye.from(center + box.half_m[axis] * normal)) > 0;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3;
    const int last = (axis + 2) % 3;
    for (const double p : {-1.0, 1.0}) {
      for (const double q : {-1.0, 1.0}) {
        const Vec3 middle = center + p * box.half_m[next] * axes.col(next) + q * box.half_m[last] * axes.col(last);
        const Vec3 half = box.half_m[axis] * axes.col(axis);
        const LineKind kind = faces(next, p) != faces(last, q) ? LineKind::silhouette : LineKind::crease;
        lines.push_back({{middle - half, middle + half}, kind, object});
      }
    }
  }
}

}  // namespace collided::draw
