#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <collided/robot.hpp>

#include "client/ros/followed_frames.hpp"
#include "client/ros/frame_tree.hpp"
#include "client/ros/ros_link.hpp"

namespace collided::ros {

/// Counts of the bridge since its start. Those from `unnamed` on are invalid transforms or positions: left out, unless
/// stated otherwise.
struct BridgeCounts {
  std::uint64_t messages = 0;
  std::uint64_t transforms = 0;
  std::uint64_t poses = 0;      // sent to the server
  std::uint64_t unnamed = 0;    // without a frame, or of a frame in itself
  std::uint64_t bad = 0;        // not finite, or an invalid quaternion
  std::uint64_t loops = 0;      // would make a frame its own ancestor
  std::uint64_t late = 0;       // older than the history of their frame
  std::uint64_t full = 0;       // new frames beyond the limit
  std::uint64_t unstamped = 0;  // with a stamp of zero: accepted, with the time of reception
  std::uint64_t ahead = 0;      // stamped more than half a second ahead: accepted, with the time of reception
  std::uint64_t robotless = 0;  // messages of joints before the description of a robot
  std::uint64_t joints = 0;     // messages of joints that the robot does not have, or with invalid positions
};

/// Moves objects by messages from ROS.
///
/// threads  one at a time
class Bridge {
 public:
  /// Client and publisher must outlive it.
  Bridge(Client& client, Publisher& publisher, const FollowedFramesOptions& options)
      : frames_(), followed_(client, publisher, options) {}

  /// Takes a transform; `now_ns` is the time of its reception, since 1970.
  void take(const RosTransform& transform, std::int64_t now_ns);
  /// Takes positions of joints as transforms of the robot's links; without a robot they are ignored.
  void take(const RosJoints& joints, std::int64_t now_ns);
  /// Takes the description of a robot; its fixed joints are static frames. An error gives its fault.
  Result<void> take_robot(const std::string& urdf);
  /// Sends new poses.
  void send(std::int64_t now_ns) { counts_.poses += followed_.send(frames_, now_ns); }
  /// Looks for objects that can follow a frame. Call this regularly.
  Result<std::size_t> find_objects() { return followed_.find_objects(frames_); }

  BridgeCounts& counts() { return counts_; }
  const FrameTree& frames() const { return frames_; }
  const FollowedFrames& followed() const { return followed_; }

 private:
  FrameTree frames_;
  FollowedFrames followed_;
  std::optional<Robot> robot_;
  std::vector<double> positions_;
  BridgeCounts counts_;
};

}  // namespace collided::ros
