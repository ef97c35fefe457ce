#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace collided::ros {

/// A number of each point of a cloud.
struct CloudField {
  std::string name;
  std::uint32_t offset = 0;   // bytes within a point
  std::uint8_t datatype = 0;  // of sensor_msgs/PointField
  std::uint32_t count = 0;
};

/// sensor_msgs/PointCloud2, untrusted.
struct CloudMessage {
  std::string frame;
  std::int64_t stamp_ns = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<CloudField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0;  // bytes
  std::uint32_t row_step = 0;    // bytes
  std::span<const std::uint8_t> data;
};

/// The points, x y z each, for all number types of the fields, including points that are not finite; or the message's
/// fault.
///
/// source  sensor_msgs/PointCloud2 and PointField
std::variant<std::vector<double>, std::string> points_of(const CloudMessage& cloud);

}  // namespace collided::ros
