#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include <collided/client.hpp>

#include "client/ros/frame_tree.hpp"

namespace collided::ros {

/// Which objects follow frames, and how.
struct FollowedFramesOptions {
  std::string fixed = "world";  // the frame that is the world of the server
  std::string only = {};        // name glob of the objects that may follow; empty: all
  LostPolicy lost_policy = LostPolicy::freeze;
};

/// Objects of the world that are moved by frames: moving ones without a publisher whose name, or its part after the
/// last '/', is that of a frame.
///
/// threads  one at a time
class FollowedFrames {
 public:
  /// client and publisher must outlive it. The publisher is made to stream: frames have separate instants.
  FollowedFrames(Client& client, Publisher& publisher, FollowedFramesOptions options);

  /// Claims the objects that have appeared since the last call and whose frames are known. Returns their number; an
  /// error if the server did not answer or refused one.
  Result<std::size_t> find_objects(const FrameTree& frames);
  /// Sends the poses of frames that are known at a newer instant than was sent, each with that instant; those of frames
  /// at rest once. Returns their number. Poses that cannot be sent go with the next call.
  ///
  /// now_ns  the instant of frames at rest, since 1970
  std::size_t send(const FrameTree& frames, std::int64_t now_ns);

  std::size_t size() const { return objects_.size(); }
  /// Objects that have the name of a frame but are static, at the last find_objects().
  std::size_t static_count() const { return static_count_; }
  /// Followed frames that were not connected to the fixed one at the last send().
  std::size_t missing_count() const { return missing_count_; }
  /// Number of calls that the library refused or that timed out.
  std::uint64_t unsent_count() const { return unsent_; }

 private:
  struct Followed {
    std::string frame;
    Publisher::Object object = 0;
    std::int64_t sent_ns = 0;
  };
  struct Due {
    std::int64_t stamp_ns;
    std::size_t object;
    Pose pose;
  };
  static std::string frame_of(const std::string& object, const FrameTree& frames);

  Client& client_;
  Publisher& publisher_;
  FollowedFramesOptions options_;
  std::vector<Followed> objects_;
  std::unordered_map<std::string, std::size_t> numbers_;  // by name of the object
  std::vector<Due> due_;
  std::size_t static_count_ = 0;
  std::size_t missing_count_ = 0;
  std::uint64_t unsent_ = 0;
};

}  // namespace collided::ros
