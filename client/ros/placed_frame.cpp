#include "client/ros/placed_frame.hpp"

namespace collided::ros {

PlacedFrame place_frame(const FrameTree& frames, const std::string& fixed, const std::string& frame,
                        std::int64_t stamp_ns, std::int64_t now_ns) {
  constexpr std::int64_t kMostAheadNs = 500'000'000;
  PlacedFrame placed{.placing = FramePlacing::not_yet,
                     .pose = {},
                     .is_unstamped = stamp_ns <= 0,
                     .is_ahead = stamp_ns > now_ns + kMostAheadNs};
  const std::string name = frame.starts_with('/') ? frame.substr(1) : frame;
  if (name.empty()) placed.placing = FramePlacing::unnamed;
  if (name == fixed) placed.placing = FramePlacing::done;
  if (placed.placing != FramePlacing::not_yet) return placed;
  const std::optional<std::int64_t> newest_ns = frames.newest_common(fixed, name);
  if (!newest_ns) return placed;
  const bool is_by_stamp = !placed.is_unstamped && !placed.is_ahead && *newest_ns != kAlways;
  if (const std::optional<Pose> pose = frames.lookup(fixed, name, is_by_stamp ? stamp_ns : *newest_ns)) {
    placed.pose = *pose;
    placed.placing = FramePlacing::done;
  }
  return placed;
}

}  // namespace collided::ros
