#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "client/library/watching/nearest_news.hpp"
#include "collided/nearest.hpp"

namespace collided {

namespace client {

/// Client::add_nearest, remove_nearest and nearest.
Result<void> add_nearest(Connection& connection, const NearestQuestion& nearest);
Result<std::size_t> remove_nearest(Connection& connection, const std::string& name);
Result<std::vector<ListedNearest>> list_nearest(Connection& connection, const std::string& name_glob);

/// A Watch on the fences' topics, and what it says of questions for the nearest.
///
/// threads  any
class [[gnu::visibility("hidden")]] NearestWatcher {
 public:
  NearestWatcher(Watch watch, NearestWatchOptions options) : watch_(std::move(watch)), options_(std::move(options)) {}

  std::optional<NearestEvent> next(std::chrono::nanoseconds wait);
  const Watch& watch() const { return watch_; }

 private:
  Watch watch_;
  NearestWatchOptions options_;
  std::mutex mutex_;  // for the rest
  NearestNews news_;
};

}  // namespace client

}  // namespace collided
