#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <collided/geometry.hpp>

#include "client/ros/marker_shape.hpp"
#include "client/ros/octomap_message.hpp"
#include "client/ros/point_cloud.hpp"

namespace collided::ros {

/// A topic of geometry_msgs/PoseStamped with the poses of a frame.
struct RosPoseTopic {
  std::string topic;  // its name in ROS, with or without its leading slash
  std::string frame;
};

/// The domain of ROS, and the topics to read besides frames.
struct RosLinkOptions {
  int domain = 0;                       // ROS_DOMAIN_ID
  std::string interface = "lo";         // "auto": as DDS chooses, and multicast
  std::vector<std::string> peers = {};  // addresses to contact where multicast does not reach
  bool has_joint_states = false;        // read /joint_states and /robot_description
  std::vector<RosPoseTopic> poses = {};
  std::vector<std::string> clouds = {};    // topics of PointCloud2
  std::vector<std::string> octomaps = {};  // topics of Octomap
  std::vector<std::string> markers = {};   // topics of MarkerArray
  bool has_clock = false;                  // read /clock
  bool sends_tf = false;                   // write /tf
};

/// A frame's pose in its parent, from a message.
struct RosTransform {
  std::string parent;
  std::string child;
  std::int64_t stamp_ns = 0;  // since 1970, or of the simulation
  Pose pose;
  bool is_static = false;
};

/// Positions of joints, from a message.
struct RosJoints {
  std::int64_t stamp_ns = 0;
  std::vector<std::string> names;
  std::vector<double> positions;  // as many as names, or fewer
};

/// A contact to show.
struct ShownContact {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  double depth_m = 0;
  std::string a, b;  // names of the two objects
};

/// A component's line for /diagnostics.
struct RosDiagnostic {
  std::string name;
  std::string message;
  std::uint8_t level = 0;  // 0 ok, 1 warn, 2 error
  std::vector<std::pair<std::string, std::string>> values;
};

struct ShownMarker {
  MarkerMessage marker;
  float red = 0.6F, green = 0.6F, blue = 0.65F;
};

/// Receives messages from ROS; called by RosLink::take.
struct RosTaker {
  std::function<void(const RosTransform&)> transform;
  std::function<void(const RosJoints&)> joints;
  std::function<void(const std::string& urdf)> robot;
  /// With the number of the topic among those requested. Data that the messages point to is gone after the call.
  std::function<void(std::size_t topic, const CloudMessage&)> cloud;
  std::function<void(std::size_t topic, const OctomapMessage&)> octomap;
  std::function<void(std::size_t topic, const MarkerMessage&)> marker;
  std::function<void(std::int64_t now_ns)> clock;
};

/// Its DDS entities, defined in ros_link.cpp.
struct RosEntities;

/// A participant of ROS's domain without ROS: reads /tf, /tf_static and, on request, topics of poses, clouds, maps and
/// markers, /joint_states, /robot_description and /clock, and writes /collided/contacts and the topics of the functions
/// below. Errors of DDS throw std::runtime_error with the failed action.
///
/// threads  one at a time
class RosLink {
 public:
  explicit RosLink(const RosLinkOptions& options);
  ~RosLink();
  RosLink(RosLink&&) noexcept;
  RosLink& operator=(RosLink&&) = delete;

  /// Waits until something arrives, at most this long, then takes all that is available. Returns the number of
  /// messages.
  std::size_t take(std::chrono::nanoseconds wait, const RosTaker& taker);
  /// Shows the contacts as markers, replacing earlier ones: a ball at each point, and a line along each normal as long
  /// as the depth. False if a reader accepts no more.
  bool show(const std::vector<ShownContact>& contacts, const std::string& frame, std::int64_t stamp_ns);
  /// The same as ros_gz_interfaces/Contacts on /collided/contact_states.
  bool tell(const std::vector<ShownContact>& contacts, const std::string& frame, std::int64_t stamp_ns);
  /// /collided/objects, replacing earlier ones.
  bool show(const std::vector<ShownMarker>& objects, const std::string& frame, std::int64_t stamp_ns);
  /// /tf; only with RosLinkOptions::sends_tf.
  bool send(const std::vector<RosTransform>& transforms);
  /// /collided/clearance, metres.
  bool tell_clearance(double clearance_m);
  bool tell(const std::vector<RosDiagnostic>& diagnostics, std::int64_t stamp_ns);
  /// Number of matched writers of all topics read.
  std::size_t broadcasters() const;

 private:
  std::unique_ptr<RosEntities> entities_;
};

}  // namespace collided::ros
