#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

#include "collided/client.hpp"

namespace collided::view {

struct RecordingOptions {
  std::chrono::nanoseconds length{30'000'000'000};
  std::size_t most_bytes = std::size_t{256} << 20;  // packed; a recording that reaches it ends there
  bool y_is_up = false;
  std::function<bool()> is_stopped;
};

/// A page that shows what was recorded, and needs nothing but a browser.
struct SavedRun {
  std::string page;
  double seconds = 0;
  std::size_t frames = 0;
  bool is_full = false;
};

/// Follows the server for that long and makes a page of it.
Result<SavedRun> record_run(Client& client, const RecordingOptions& options);

}  // namespace collided::view
