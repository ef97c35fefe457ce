#include "client/ros/marker_shape.hpp"

#include <algorithm>

namespace collided::ros {
namespace {

/// Numbers of points that a marker may have: a shape is one message.
constexpr std::size_t kMostPoints = 20'000;

ShapePart ball(const Vec3& scale, const Vec3& center) {
  if (scale.x() == scale.y() && scale.y() == scale.z()) return SphereShape{.radius_m = scale.x() / 2, .center = center};
  return EllipsoidShape{.half_m = scale / 2, .center = center};
}

std::variant<Shape, std::string> lines(const MarkerMessage& marker, bool is_strip) {
  if (marker.points.size() < 2 || (!is_strip && marker.points.size() % 2 != 0))
    return "lines of " + std::to_string(marker.points.size()) + " points";
  Shape shape;
  const double radius_m = marker.scale.x() / 2;
  if (is_strip) {
    shape.emplace_back(PolylineShape{.points = marker.points, .radius_m = radius_m});
    return shape;
  }
  for (std::size_t i = 0; i + 1 < marker.points.size(); i += 2)
    shape.emplace_back(CapsuleShape{marker.points[i], marker.points[i + 1], radius_m});
  return shape;
}

std::variant<Shape, std::string> triangles(const MarkerMessage& marker) {
  if (marker.points.empty() || marker.points.size() % 3 != 0)
    return "triangles of " + std::to_string(marker.points.size()) + " points";
  MeshShape mesh;
  for (const Vec3& point : marker.points) mesh.vertices.emplace_back(point.cwiseProduct(marker.scale));
  for (std::uint32_t i = 0; i < marker.points.size(); i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  return Shape{std::move(mesh)};
}

std::variant<Shape, std::string> at_points(const MarkerMessage& marker) {
  if (marker.points.empty()) return std::string("a list without points");
  Shape shape;
  const Vec3& scale = marker.scale;
  const bool are_balls = marker.type == kPoints || (scale.x() == scale.y() && scale.y() == scale.z());
  if (marker.type != kCubeList && are_balls) {
    shape.emplace_back(CloudShape{.points = marker.points, .radius_m = scale.x() / 2});
    return shape;
  }
  for (const Vec3& point : marker.points) {
    if (marker.type == kCubeList) shape.emplace_back(BoxShape{.half_m = scale / 2, .center = point});
    else shape.emplace_back(ball(scale, point));
  }
  return shape;
}

}  // namespace

std::variant<Shape, std::string> shape_of(const MarkerMessage& marker) {
  const Vec3& scale = marker.scale;
  if (!(scale.array() >= 0).all() || !scale.allFinite()) return std::string("a scale below 0 or not finite");
  if (marker.points.size() > kMostPoints)
    return std::to_string(marker.points.size()) + " points, allowed are " + std::to_string(kMostPoints);
  const bool is_solid = marker.type == kCube || marker.type == kSphere || marker.type == kCylinder;
  if (is_solid && !(scale.array() > 0).all()) return std::string("a scale of 0");
  switch (marker.type) {
    case kCube: return Shape{BoxShape{.half_m = scale / 2}};
    case kSphere: return Shape{ball(scale, Vec3::Zero())};
    case kCylinder: {
      if (scale.x() != scale.y()) return std::string("a cylinder that is not round");
      const Vec3 end(0, 0, scale.z() / 2);
      return Shape{CylinderShape{-end, end, scale.x() / 2}};
    }
    case kLineStrip: return lines(marker, true);
    case kLineList: return lines(marker, false);
    case kCubeList:
    case kSphereList:
    case kPoints: return at_points(marker);
    case kTriangleList: return triangles(marker);
    case kArrow: return std::string("an arrow, which is no thing");
    case kText: return std::string("a text, which is no thing");
    case kMeshResource: return std::string("a mesh in a file of the sender");
    default: return "unknown type " + std::to_string(marker.type);
  }
}

}  // namespace collided::ros
