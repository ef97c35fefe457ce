#pragma once

#include <cstdint>
#include <string>

#include "client/ros/ros_link.hpp"
#include "idl/ros_types.hpp"

/// Converts between messages of ROS and plain values. A text that DDS left out is empty.
namespace collided::ros {

inline constexpr std::int64_t kSecondNs = 1'000'000'000;

inline std::int64_t stamp_of(const builtin_interfaces_msg_dds__Time_& time) {
  return static_cast<std::int64_t>(time.sec) * kSecondNs + time.nanosec;
}
inline builtin_interfaces_msg_dds__Time_ time_of(std::int64_t stamp_ns) {
  return {static_cast<std::int32_t>(stamp_ns / kSecondNs), static_cast<std::uint32_t>(stamp_ns % kSecondNs)};
}

inline std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }
/// DDS only reads the text, which must outlive the write.
inline char* borrowed(const std::string& text) { return const_cast<char*>(text.c_str()); }

inline Vec3 vector_of(const auto& from) { return {from.x, from.y, from.z}; }
inline Quat rotation_of(const geometry_msgs_msg_dds__Quaternion_& from) { return Quat(from.w, from.x, from.y, from.z); }

RosTransform transform_of(const geometry_msgs_msg_dds__TransformStamped_& from, bool is_static);
RosTransform transform_of(const PoseStamped& from, const std::string& frame);
/// The bytes stay the message's.
CloudMessage cloud_of(const PointCloud& from);
OctomapMessage octomap_of(const Octomap& from);
MarkerMessage marker_of(const Marker& from);

/// An empty marker. Its texts are those of `frame` and `name`, which must outlive the write.
Marker plain_marker(const std::string& frame, std::int64_t stamp_ns, const std::string& name, std::int32_t number);

}  // namespace collided::ros
