#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <collided/client.hpp>

#include "client/ros/frame_tree.hpp"
#include "client/ros/ros_link.hpp"

namespace collided::ros {

/// The part of the server's world to show to ROS.
struct ShownWorldOptions {
  std::string fixed = "world";
  std::string clearance_of = {};  // name glob; empty: no clearance
  bool shows_objects = false;
  bool sends_tf = false;
};

/// Shows objects as markers and their poses as transforms, and the least clearance of some to all others: ten times a
/// second at most, static objects once a change.
///
/// threads  one at a time
class ShownWorld {
 public:
  /// The client must outlive it.
  ShownWorld(Client& client, ShownWorldOptions options) : client_(client), options_(std::move(options)) {}

  void go_on(RosLink& link, const FrameTree& frames, std::int64_t now_ns);
  /// Whether this transform of an object was sent here: it comes back, without new information.
  bool has_sent(const RosTransform& transform) const {
    return transform.parent == options_.fixed && sent_.contains(transform.child);
  }
  RosDiagnostic clearance_diagnostic() const;

 private:
  void show_objects(RosLink& link, std::int64_t now_ns);
  void send_poses(RosLink& link, const FrameTree& frames, std::int64_t now_ns);
  void tell_clearance(RosLink& link);

  Client& client_;
  ShownWorldOptions options_;
  std::chrono::steady_clock::time_point next_;
  ShownObjects shown_;
  std::uint64_t shown_version_ = 0;
  std::set<std::string> sent_;
  std::optional<ClearanceAnswer> clearance_;
  std::string clearance_error_;
};

}  // namespace collided::ros
