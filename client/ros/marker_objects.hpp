#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <collided/client.hpp>

#include "client/ros/frame_tree.hpp"
#include "client/ros/ros_link.hpp"

namespace collided::ros {

/// Outcomes of the markers. Those from `shapeless` on are left out, unless stated otherwise.
struct MarkerCounts {
  std::uint64_t markers = 0;    // received
  std::uint64_t shapeless = 0;  // of a type without volume, of an unknown one, or with invalid numbers
  std::uint64_t bad = 0;        // poses that are not finite, or with an invalid quaternion; unknown actions
  std::uint64_t unnamed = 0;    // without a frame
  std::uint64_t frameless = 0;  // their frame was not known at their stamp, nor a second later
  std::uint64_t unstamped = 0;  // stamped 0: accepted, at the frame's newest pose
  std::uint64_t ahead = 0;      // stamped more than half a second ahead: accepted, same pose
  std::uint64_t unsent = 0;     // calls that the library refused or that timed out
};

/// Objects of the world that are markers of ROS: TOPIC/NAMESPACE/NUMBER, at the marker's pose at its stamp.
///
/// threads  one at a time
class MarkerObjects {
 public:
  /// The client must outlive it. topics: the names' prefixes, by number of the topic.
  MarkerObjects(Client& client, std::string fixed, std::vector<std::string> topics)
      : client_(client), fixed_(std::move(fixed)), topics_(std::move(topics)) {}

  Result<void> start();
  void take(std::size_t topic, const MarkerMessage& marker, std::int64_t now_ns);
  /// Places markers that wait for their frame, removes expired ones, and sends changes.
  void go_on(const FrameTree& frames, std::int64_t now_ns);

  const MarkerCounts& counts() const { return counts_; }
  /// Faults of messages since the last call, at most 100 sentences.
  std::vector<std::string> take_flaws() { return std::exchange(flaws_, {}); }
  std::size_t size() const { return objects_.size(); }
  /// Null if there are no topics.
  Publisher* publisher() { return publisher_ ? &*publisher_ : nullptr; }

 private:
  struct Waiting {
    std::string name;
    MarkerMessage marker;
    Shape shape;
    std::int64_t came_ns = 0;
  };
  struct MarkerObject {
    Publisher::Object object = 0;
    MarkerMessage marker;
    std::int64_t ends_ns = 0;  // 0: never
  };
  void tell(const std::string& flaw);
  void remove(const std::string& prefix, bool is_whole_name);
  void place(Waiting& waiting, const Pose& pose, std::int64_t now_ns);
  Result<void> show(MarkerObject& shown, Waiting& waiting, const Pose& pose);

  Client& client_;
  std::string fixed_;
  std::vector<std::string> topics_;
  std::optional<Publisher> publisher_;
  std::map<std::string, MarkerObject> objects_;  // by name
  std::deque<Waiting> waiting_;
  MarkerCounts counts_;
  std::vector<std::string> flaws_;
};

}  // namespace collided::ros
