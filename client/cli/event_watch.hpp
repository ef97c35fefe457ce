#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include <collided/client.hpp>
#include <collided/shards.hpp>

#include "client/cli/session.hpp"

namespace collided::cli {

/// The contact events of one server, or with --shards of a world on several. The session must outlive it. One thread.
class EventWatch {
 public:
  /// Connects; throws Failure.
  EventWatch(Session& session, const Globals& globals, const WatchOptions& options);

  /// See Watch::next.
  std::optional<Event> next(std::chrono::nanoseconds wait);
  std::uint64_t lost() const;
  /// See Watch::tells_since.
  std::chrono::nanoseconds tells_since() const;
  /// News of the server or the shards since the last call: one is silent, or back. Empty: none.
  std::string_view news();

 private:
  std::variant<Watch, ShardedWatch> watch_;
  bool was_connected_ = true;
  std::uint64_t gaps_ = 0;  // of shards, already reported
};

}  // namespace collided::cli
