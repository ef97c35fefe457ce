#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <collided/shapes.hpp>

namespace collided::ros {

/// Types of a visualization_msgs/Marker.
enum MarkerType : std::int32_t {
  kArrow,
  kCube,
  kSphere,
  kCylinder,
  kLineStrip,
  kLineList,
  kCubeList,
  kSphereList,
  kPoints,
  kText,
  kMeshResource,
  kTriangleList,
};

/// visualization_msgs/Marker, the part about position and shape.
struct MarkerMessage {
  std::string frame;
  std::int64_t stamp_ns = 0;
  std::string name_space;
  std::int32_t number = 0;
  std::int32_t type = 0;
  std::int32_t action = 0;
  Pose pose;
  Vec3 scale = Vec3::Ones();
  std::int64_t lifetime_ns = 0;  // 0: for ever
  std::vector<Vec3> points;
};

/// Actions of a marker.
enum MarkerAction : std::int32_t { kAddMarker = 0, kDeleteMarker = 2, kDeleteAllMarkers = 3 };

/// The marker's volume, in its own frame; or why there is none. Lines are as thick as drawn, and points are balls.
///
/// source  ROS wiki, "rviz/DisplayTypes/Marker"
std::variant<Shape, std::string> shape_of(const MarkerMessage& marker);

}  // namespace collided::ros
