#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include <collided/client.hpp>
#include <collided/voxels.hpp>

#include "client/ros/frame_tree.hpp"
#include "client/ros/ros_link.hpp"

namespace collided::ros {

/// Outcomes of the messages. Those from `bad` on are left out, unless stated otherwise.
struct CloudCounts {
  std::uint64_t clouds = 0;  // in the world
  std::uint64_t maps = 0;
  std::uint64_t points = 0;      // in the world
  std::uint64_t bad = 0;         // invalid messages; the first reason is reported
  std::uint64_t unnamed = 0;     // without a frame
  std::uint64_t frameless = 0;   // their frame was not known at their stamp, nor a second later
  std::uint64_t unstamped = 0;   // stamped 0: accepted, at the frame's newest pose
  std::uint64_t ahead = 0;       // stamped more than half a second ahead: accepted, same pose
  std::uint64_t not_finite = 0;  // points
  std::uint64_t dropped = 0;     // points in blocks beyond the limit
  std::uint64_t unsent = 0;      // calls that the library refused or that timed out
};

/// Which topics become cells, and how.
struct LiveCloudOptions {
  std::string fixed = "world";
  std::vector<std::string> clouds = {};  // names of the cells of each topic of clouds ...
  std::vector<std::string> maps = {};    // ... and of each topic of maps
  VoxelOptions voxels = {};              // of clouds; a map has its own size of cells
};

/// Keeps cells of clouds and maps of ROS in the world. The origin of a cloud's frame is taken as its sensor.
///
/// threads  one at a time
class LiveClouds {
 public:
  /// The client must outlive it.
  LiveClouds(Client& client, LiveCloudOptions options) : client_(client), options_(std::move(options)) {}

  /// Starts publishing; does nothing without topics.
  Result<void> start();
  void take(std::size_t topic, const CloudMessage& cloud, std::int64_t now_ns);
  void take(std::size_t topic, const OctomapMessage& map, std::int64_t now_ns);
  /// Places messages that wait for their frame, lets old cells decay, and signals that this publisher lives.
  void go_on(const FrameTree& frames, std::int64_t now_ns);

  const CloudCounts& counts() const { return counts_; }
  /// Faults of messages since the last call, at most 100 sentences.
  std::vector<std::string> take_flaws() { return std::exchange(flaws_, {}); }
  std::size_t occupied_count() const;
  /// Null if there are no topics.
  Publisher* publisher() { return publisher_ ? &*publisher_ : nullptr; }

 private:
  struct Waiting {
    std::size_t grid = 0;
    std::string frame;
    std::int64_t stamp_ns = 0;
    std::int64_t came_ns = 0;
    std::vector<double> points;      // of a cloud, in its frame ...
    std::vector<VoxelBlock> blocks;  // ... or of a map
    double cell_m = 0;               // of a map
  };
  void put(Waiting& message, const Pose& pose);
  void put_map(Waiting& message, const Pose& pose);
  void put_off(Waiting message);
  void refuse(const std::string& flaw);
  void tell(const std::string& flaw);

  Client& client_;
  LiveCloudOptions options_;
  std::optional<Publisher> publisher_;
  std::vector<std::optional<PublishedVoxels>> grids_;  // of clouds, then of maps
  std::deque<Waiting> waiting_;
  CloudCounts counts_;
  std::vector<std::string> flaws_;
};

}  // namespace collided::ros
