#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

#include "collided/client.hpp"

namespace collided::view {

/// How long to record, and the limits.
struct RecordingOptions {
  std::chrono::nanoseconds length{30'000'000'000};
  std::size_t most_bytes = std::size_t{256} << 20;  // compressed; a recording that reaches it ends
  bool y_is_up = false;
  std::string connection = {};  // as in ViewerOptions
  std::function<bool()> is_stopped;
};

/// A recording as a page that needs nothing but a browser.
struct SavedRun {
  std::string page;
  double seconds = 0;
  std::size_t frames = 0;
  bool is_full = false;  // it ended at most_bytes
};

/// Follows the server for the given time and makes a page of it.
Result<SavedRun> record_run(Client& client, const RecordingOptions& options);

}  // namespace collided::view
