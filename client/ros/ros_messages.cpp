#include "client/ros/ros_messages.hpp"

namespace collided::ros {

RosTransform transform_of(const geometry_msgs_msg_dds__TransformStamped_& from, bool is_static) {
  return {.parent = text_of(from.header.frame_id),
          .child = text_of(from.child_frame_id),
          .stamp_ns = stamp_of(from.header.stamp),
          .pose = {vector_of(from.transform.translation), rotation_of(from.transform.rotation)},
          .is_static = is_static};
}

RosTransform transform_of(const PoseStamped& from, const std::string& frame) {
  return {.parent = text_of(from.header.frame_id),
          .child = frame,
          .stamp_ns = stamp_of(from.header.stamp),
          .pose = {vector_of(from.pose.position), rotation_of(from.pose.orientation)},
          .is_static = false};
}

CloudMessage cloud_of(const PointCloud& from) {
  CloudMessage cloud{.frame = text_of(from.header.frame_id),
                     .stamp_ns = stamp_of(from.header.stamp),
                     .height = from.height,
                     .width = from.width,
                     .fields = {},
                     .is_bigendian = from.is_bigendian,
                     .point_step = from.point_step,
                     .row_step = from.row_step,
                     .data = dds::view(from.data)};
  for (const auto& field : dds::view(from.fields))
    cloud.fields.push_back({text_of(field.name), field.offset, field.datatype, field.count});
  return cloud;
}

OctomapMessage octomap_of(const Octomap& from) {
  return {.frame = text_of(from.header.frame_id),
          .stamp_ns = stamp_of(from.header.stamp),
          .is_binary = from.binary,
          .kind = text_of(from.kind),
          .resolution_m = from.resolution,
          .data = dds::view(from.data)};
}

MarkerMessage marker_of(const Marker& from) {
  MarkerMessage marker{.frame = text_of(from.header.frame_id),
                       .stamp_ns = stamp_of(from.header.stamp),
                       .name_space = text_of(from.ns),
                       .number = from.marker_id,
                       .type = from.type,
                       .action = from.action,
                       .pose = {vector_of(from.pose.position), rotation_of(from.pose.orientation)},
                       .scale = vector_of(from.scale),
                       .lifetime_ns = static_cast<std::int64_t>(from.lifetime.sec) * kSecondNs + from.lifetime.nanosec,
                       .points = {}};
  for (const auto& point : dds::view(from.points)) marker.points.push_back(vector_of(point));
  return marker;
}

Marker plain_marker(const std::string& frame, std::int64_t stamp_ns, const std::string& name, std::int32_t number) {
  static char empty[] = "";
  Marker marker{};
  marker.header.stamp = time_of(stamp_ns);
  marker.header.frame_id = borrowed(frame);
  marker.ns = borrowed(name);
  marker.marker_id = number;
  marker.pose.orientation.w = 1;
  for (char** text : {&marker.texture_resource, &marker.texture.header.frame_id, &marker.texture.format, &marker.text,
                      &marker.mesh_resource, &marker.mesh_file.filename})
    *text = empty;
  return marker;
}

}  // namespace collided::ros
