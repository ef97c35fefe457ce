#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
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

/// A recording as a page that needs only a browser.
struct SavedRun {
  std::string page;
  double seconds = 0;
  std::size_t frames = 0;
  bool is_full = false;  // it ended at most_bytes
};

/// Follows the server for the given time and makes a page of it.
Result<SavedRun> record_run(Client& client, const RecordingOptions& options);

/// An earlier recording, in the format of a saved page's run (RunWriter). Error bad_input, with a sentence that leaves
/// out the file's name, if nothing in it can be shown.
///
/// surroundings  as in PictureOptions
/// is_stopped    called many times a second; true ends the reading
/// memory        the file's bytes, and three times kMostRunBytes
Result<std::string> run_of_recording(const std::string& path, std::shared_ptr<const ShownObjects> surroundings,
                                     const std::function<bool()>& is_stopped);

/// Limit on a recording's run, in compressed bytes: a browser holds it as one text. A longer recording is shown up to
/// there.
inline constexpr std::size_t kMostRunBytes = std::size_t{128} << 20;

}  // namespace collided::view
