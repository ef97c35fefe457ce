#include "client/ros/written_messages.hpp"

#include <array>
#include <deque>

#include "client/ros/marker_shape.hpp"
#include "client/ros/ros_messages.hpp"

namespace collided::ros {
namespace {

using Point = ::geometry_msgs_msg_dds__Point_;
using Vector = ::geometry_msgs_msg_dds__Vector3_;

constexpr double kBall_m = 0.02;
constexpr double kLine_m = 0.005;
// ros_gz_interfaces/Entity.
constexpr std::uint8_t kCollision = 5;

Point point_of(const Vec3& from) { return {from.x(), from.y(), from.z()}; }
Vector wire_vector(const Vec3& from) { return {from.x(), from.y(), from.z()}; }

}  // namespace

bool write_contacts(dds::Writer<MarkerArray>& writer, const std::vector<ShownContact>& contacts,
                    const std::string& frame, std::int64_t stamp_ns) {
  std::vector<Point> points, lines;
  for (const ShownContact& contact : contacts) {
    points.push_back(point_of(contact.point));
    lines.push_back(point_of(contact.point));
    lines.push_back(point_of(contact.point + contact.depth_m * contact.normal));
  }
  const std::string names[2] = {"contacts", "depths"};
  std::array markers{plain_marker(frame, stamp_ns, names[0], 0), plain_marker(frame, stamp_ns, names[1], 1)};
  markers[0].type = kSphereList;
  markers[0].scale = {kBall_m, kBall_m, kBall_m};
  markers[1].type = kLineList;
  markers[1].scale = {kLine_m, 0, 0};
  for (Marker& marker : markers) {
    marker.color = {1, 0.2F, 0.1F, 1};
    marker.action = contacts.empty() ? kDeleteMarker : kAddMarker;
  }
  dds::borrow(markers[0].points, points);
  dds::borrow(markers[1].points, lines);
  MarkerArray message{};
  dds::borrow(message.markers, markers);
  return writer.write(message);
}

bool write_contacts(dds::Writer<GzContacts>& writer, const std::vector<ShownContact>& contacts,
                    const std::string& frame, std::int64_t stamp_ns) {
  struct OneContact {
    std::array<Vector, 1> point, normal;
    std::array<double, 1> depth;
  };
  std::deque<OneContact> numbers;  // the messages point to these
  std::vector<::ros_gz_interfaces_msg_dds__Contact_> told;
  for (const ShownContact& contact : contacts) {
    OneContact& one = numbers.emplace_back(
        OneContact{{wire_vector(contact.point)}, {wire_vector(contact.normal)}, {contact.depth_m}});
    auto& message = told.emplace_back();
    message.collision1 = {0, borrowed(contact.a), kCollision};
    message.collision2 = {0, borrowed(contact.b), kCollision};
    dds::borrow(message.positions, one.point);
    dds::borrow(message.normals, one.normal);
    dds::borrow(message.depths, one.depth);
  }
  GzContacts message{};
  message.header = {time_of(stamp_ns), borrowed(frame)};
  dds::borrow(message.contacts, told);
  return writer.write(message);
}

bool write_objects(dds::Writer<MarkerArray>& writer, const std::vector<ShownMarker>& objects, const std::string& frame,
                   std::int64_t stamp_ns) {
  const std::string nothing;
  std::vector<Marker> markers{plain_marker(frame, stamp_ns, nothing, 0)};
  markers.front().action = kDeleteAllMarkers;
  std::deque<std::vector<Point>> points;
  for (const ShownMarker& object : objects) {
    const MarkerMessage& from = object.marker;
    Marker& marker = markers.emplace_back(plain_marker(frame, stamp_ns, from.name_space, from.number));
    marker.type = from.type;
    const Quat& turn = from.pose.rotation;
    marker.pose = {point_of(from.pose.position), {turn.x(), turn.y(), turn.z(), turn.w()}};
    marker.scale = wire_vector(from.scale);
    marker.color = {object.red, object.green, object.blue, 1};
    std::vector<Point>& own = points.emplace_back();
    for (const Vec3& point : from.points) own.push_back(point_of(point));
    dds::borrow(marker.points, own);
  }
  MarkerArray message{};
  dds::borrow(message.markers, markers);
  return writer.write(message);
}

bool write_transforms(dds::Writer<TfMessage>& writer, const std::vector<RosTransform>& transforms) {
  std::vector<::geometry_msgs_msg_dds__TransformStamped_> told;
  for (const RosTransform& from : transforms) {
    auto& one = told.emplace_back();
    one.header = {time_of(from.stamp_ns), borrowed(from.parent)};
    one.child_frame_id = borrowed(from.child);
    const Quat& turn = from.pose.rotation;
    one.transform = {wire_vector(from.pose.position), {turn.x(), turn.y(), turn.z(), turn.w()}};
  }
  TfMessage message{};
  dds::borrow(message.transforms, told);
  return writer.write(message);
}

bool write_diagnostics(dds::Writer<Diagnostics>& writer, const std::vector<RosDiagnostic>& diagnostics,
                       std::int64_t stamp_ns) {
  const std::string nothing, hardware = "collided";
  std::deque<std::vector<::diagnostic_msgs_msg_dds__KeyValue_>> values;
  std::vector<::diagnostic_msgs_msg_dds__DiagnosticStatus_> told;
  for (const RosDiagnostic& from : diagnostics) {
    auto& own = values.emplace_back();
    for (const auto& [key, text] : from.values) own.push_back({borrowed(key), borrowed(text)});
    auto& one = told.emplace_back();
    one.level = from.level;
    one.name = borrowed(from.name);
    one.message = borrowed(from.message);
    one.hardware = borrowed(hardware);
    dds::borrow(one.values, own);
  }
  Diagnostics message{};
  message.header = {time_of(stamp_ns), borrowed(nothing)};
  dds::borrow(message.status, told);
  return writer.write(message);
}

}  // namespace collided::ros
