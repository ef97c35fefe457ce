#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string_view>

#include "client/view/web_server.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// What the server's flight recorder holds, fetched when a page asks for it, as an MCAP file. The newest one is kept until
/// the next one is asked for.
///
/// limits   kMostBytes; more is refused
/// threads  any; fetch() takes as long as the server needs to write it
class ServerMemory {
 public:
  static constexpr std::uint64_t kMostBytes = std::uint64_t{256} << 20;

  /// Fetches the last seconds, and returns the number under which page() has them.
  Result<std::uint64_t> fetch(Client& client, std::chrono::nanoseconds last);
  /// "/memory?number=N"; nothing for other targets, and for one that is no longer kept.
  std::optional<WebPage> page(std::string_view target) const;

 private:
  mutable std::mutex mutex_;
  std::uint64_t number_ = 0;
  Bytes newest_;
};

}  // namespace collided::view
