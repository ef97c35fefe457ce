#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "client/library/watching/fence_news.hpp"
#include "collided/fences.hpp"

namespace collided {

namespace client {

/// Client::add_fence, add_fences, remove_fences and fences.
Result<void> add_fence(Connection& connection, const Fence& fence);
Result<void> add_fences(Connection& connection, std::span<const Fence> fences);
Result<std::size_t> remove_fences(Connection& connection, const std::string& name);
Result<std::vector<ListedFence>> list_fences(Connection& connection, const std::string& name_glob);

/// A Watch on the fences' topics, and what it says that next() has not taken.
///
/// threads  any
class [[gnu::visibility("hidden")]] FenceWatcher {
 public:
  explicit FenceWatcher(Watch watch) : watch_(std::move(watch)) {}

  std::optional<FenceEvent> next(std::chrono::nanoseconds wait);
  const Watch& watch() const { return watch_; }

 private:
  Watch watch_;
  std::mutex mutex_;  // for the rest
  FenceNews news_;
  std::deque<FenceEvent> waiting_;
};

}  // namespace client

}  // namespace collided
