#pragma once

#include <chrono>
#include <string>

#include "client/cli/publish/source.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {

struct LoopOptions {
  std::string publisher_name;
  double rate_hz = 0;  // frames a second instead of the source's own times; 0: those
  double speed = 1;    // of the source's own times
  bool loop = false;
  bool stay = false;  // after the last frame: keep the objects until interrupted
  std::uint64_t most_frames = 0;
  std::chrono::nanoseconds most_time = std::chrono::nanoseconds::max();
};

/// Publishes a source's frames when they are due by the steady clock, says "still there" in between, and ends with what
/// was sent. Ctrl-C ends it with the same report.
Exit publish(Session& session, const Globals& globals, Source& source, const LoopOptions& options);

}  // namespace collided::cli
