#include "client/ros/contact_markers.hpp"

#include <array>

namespace collided::ros {
namespace {

using Point = ::geometry_msgs_msg_dds__Point_;

// visualization_msgs/Marker.
constexpr std::int32_t kLineList = 5;
constexpr std::int32_t kSphereList = 7;
constexpr std::int32_t kAdd = 0;
constexpr std::int32_t kDelete = 2;
constexpr double kBall_m = 0.02;
constexpr double kLine_m = 0.005;

Point point_of(const Vec3& from) { return {from.x(), from.y(), from.z()}; }

/// A marker without anything in it. Its texts belong to others and outlive the write.
Marker plain_marker(const std::string& frame, std::int64_t stamp_ns, const char* name, std::int32_t number) {
  static char empty[] = "";
  Marker marker{};
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  marker.header.stamp.sec = static_cast<std::int32_t>(stamp_ns / kSecondNs);
  marker.header.stamp.nanosec = static_cast<std::uint32_t>(stamp_ns % kSecondNs);
  // DDS only reads what is written.
  marker.header.frame_id = const_cast<char*>(frame.c_str());
  marker.ns = const_cast<char*>(name);
  marker.marker_id = number;
  marker.pose.orientation.w = 1;
  marker.color = {1, 0.2F, 0.1F, 1};
  for (char** text : {&marker.texture_resource, &marker.texture.header.frame_id, &marker.texture.format, &marker.text,
                      &marker.mesh_resource, &marker.mesh_file.filename})
    *text = empty;
  return marker;
}

}  // namespace

bool write_contacts(dds::Writer<MarkerArray>& writer, const std::vector<ShownContact>& contacts,
                    const std::string& frame, std::int64_t stamp_ns) {
  std::vector<Point> points, lines;
  for (const ShownContact& contact : contacts) {
    points.push_back(point_of(contact.point));
    lines.push_back(point_of(contact.point));
    lines.push_back(point_of(contact.point + contact.depth_m * contact.normal));
  }
  std::array markers{plain_marker(frame, stamp_ns, "contacts", 0), plain_marker(frame, stamp_ns, "depths", 1)};
  markers[0].type = kSphereList;
  markers[0].scale = {kBall_m, kBall_m, kBall_m};
  markers[1].type = kLineList;
  markers[1].scale = {kLine_m, 0, 0};
  for (Marker& marker : markers) marker.action = contacts.empty() ? kDelete : kAdd;
  dds::borrow(markers[0].points, points);
  dds::borrow(markers[1].points, lines);
  MarkerArray message{};
  dds::borrow(message.markers, markers);
  return writer.write(message);
}

}  // namespace collided::ros
