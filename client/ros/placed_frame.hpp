#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/ros/frame_tree.hpp"

namespace collided::ros {

/// Why a message cannot be placed by its frame. not_yet: its frame is not known at its stamp, but may be soon.
enum class FramePlacing { done, unnamed, not_yet };

/// A message's frame in the world, and how its stamp was used.
struct PlacedFrame {
  FramePlacing placing = FramePlacing::not_yet;
  Pose pose;
  bool is_unstamped = false;  // the stamp is 0: the newest pose is used
  bool is_ahead = false;      // more than half a second: the same
};

/// A frame's pose at a message's stamp.
///
/// fixed   the frame that is the world; a message may be in it without any transform
/// now_ns  the time of reception
PlacedFrame place_frame(const FrameTree& frames, const std::string& fixed, const std::string& frame,
                        std::int64_t stamp_ns, std::int64_t now_ns);

}  // namespace collided::ros
