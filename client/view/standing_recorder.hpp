#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "client/view/standing_follower.hpp"
#include "collided/recording.hpp"

namespace collided::view {

/// The schema of the messages for the page.
inline constexpr const char* kStandingSchemaName = "collided.Standing";

/// Writes the outlines of standing questions into a recording: on "<namespace>/standing" in the format of the page of
/// `collide view`, each in the frame of its carrier, and on "/fences" as a scene in the world for Foxglove. A file of a
/// run without standing questions has neither.
///
/// cost     asks the server five times a second while there are any, otherwise once for each change that the recording
///          has received; the poses of 50 carriers at most
/// threads  one
class StandingRecorder {
 public:
  /// recording  must outlive it
  StandingRecorder(Recording& recording, const std::string& name_space);

  /// Call this often.
  void look();

 private:
  using Clock = std::chrono::steady_clock;
  void look_at_carriers();
  void write();

  Recording& recording_;
  Client client_;
  StandingFollower follower_;
  const OwnChannel listed_;
  const OwnChannel scene_;
  Clock::time_point next_;
  std::uint64_t changes_ = ~std::uint64_t{0};  // included by the last look; an impossible number at first
  std::vector<draw::StandingOutline> outlines_;
  std::map<std::string, Pose> carriers_;  // by name, as in the last scene
};

}  // namespace collided::view
