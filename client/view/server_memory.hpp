#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>

#include "client/view/web_server.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// The content of the server's flight recorder, fetched on a page's request, in the form in which the page shows
/// recordings (run_of_recording). The newest one is kept until the next request.
///
/// limits   kMostBytes; more is refused
/// threads  any; fetch() takes as long as the server needs to write it, and as reading it takes
class ServerMemory {
 public:
  static constexpr std::uint64_t kMostBytes = std::uint64_t{256} << 20;

  /// Fetches the last seconds, and returns their number for page().
  ///
  /// surroundings  as in PictureOptions
  Result<std::uint64_t> fetch(Client& client, std::chrono::nanoseconds last,
                              std::shared_ptr<const ShownObjects> surroundings);
  /// Ends a fetch() that is under way, and refuses further ones.
  void stop() { is_stopping_ = true; }
  /// "/memory?number=N"; nothing for other targets, and for one that is no longer kept.
  std::optional<WebPage> page(std::string_view target) const;

 private:
  std::atomic<bool> is_stopping_{false};
  mutable std::mutex mutex_;
  std::uint64_t number_ = 0;
  Bytes newest_;
};

}  // namespace collided::view
