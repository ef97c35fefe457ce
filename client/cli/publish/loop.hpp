#pragma once

#include <chrono>
#include <string>

#include "client/cli/publish/source.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {

/// How to publish a source, and when to stop.
struct PublishLoopOptions {
  std::string publisher_name;
  std::chrono::nanoseconds gap = PublishOptions{}.gap;
  double rate_hz = 0;  // frames a second; 0: use the source's own times
  double speed = 1;    // factor on the source's own times
  bool loop = false;   // restart after the last frame
  bool stay = false;   // after the last frame: keep the objects until interrupted
  std::uint64_t most_frames = 0;
  std::chrono::nanoseconds most_time = std::chrono::nanoseconds::max();
};

/// Publishes a source's frames when they are due by the steady clock, and keeps the publisher alive in between. Ends,
/// also on Ctrl-C, with a report of what was sent.
Exit publish(Session& session, const Globals& globals, MotionSource& source, const PublishLoopOptions& options);

}  // namespace collided::cli
