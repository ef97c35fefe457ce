#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <collided/geometry.hpp>

namespace collided::ros {

/// A topic of geometry_msgs/PoseStamped, whose poses are those of a frame.
struct RosPoseTopic {
  std::string topic;  // as ROS has it, with or without its leading slash
  std::string frame;
};

/// Where ROS is, and what is read besides frames.
struct RosLinkOptions {
  int domain = 0;                       // ROS_DOMAIN_ID
  std::string interface = "lo";         // "auto": as DDS chooses, and multicast
  std::vector<std::string> peers = {};  // addresses to look at where multicast does not reach
  bool has_joint_states = false;        // read /joint_states and /robot_description
  std::vector<RosPoseTopic> poses = {};
};

/// A frame's pose in its parent, as a message said it.
struct RosTransform {
  std::string parent;
  std::string child;
  std::int64_t stamp_ns = 0;  // since 1970, or of the simulation
  Pose pose;
  bool is_static = false;
};

/// Positions of joints, as a message said them.
struct RosJoints {
  std::int64_t stamp_ns = 0;
  std::vector<std::string> names;
  std::vector<double> positions;  // as many as names, or fewer
};

/// A contact to be shown.
struct ShownContact {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  double depth_m = 0;
};

/// What comes from ROS; called by RosLink::take.
struct RosTaker {
  std::function<void(const RosTransform&)> transform;
  std::function<void(const RosJoints&)> joints;
  std::function<void(const std::string& urdf)> robot;
};

/// Its DDS entities, which ros_link.cpp has.
struct RosEntities;

/// A participant of ROS's domain without ROS: reads /tf, /tf_static and, where wanted, topics of poses, /joint_states and
/// /robot_description, and writes /collided/contacts. Errors of DDS throw std::runtime_error with what was tried.
///
/// threads  one at a time
class RosLink {
 public:
  explicit RosLink(const RosLinkOptions& options);
  ~RosLink();
  RosLink(RosLink&&) noexcept;
  RosLink& operator=(RosLink&&) = delete;

  /// Waits until something comes, at most so long, then takes all that is there. Returns the number of messages.
  std::size_t take(std::chrono::nanoseconds wait, const RosTaker& taker);
  /// Shows the contacts as markers, in place of those before: a ball at each point, and a line along each normal as long
  /// as the depth. False where a reader takes no more.
  bool show(const std::vector<ShownContact>& contacts, const std::string& frame, std::int64_t stamp_ns);
  /// Number of writers of /tf, /tf_static and the topics of poses that are matched.
  std::size_t broadcasters() const;

 private:
  std::unique_ptr<RosEntities> entities_;
};

}  // namespace collided::ros
