#include "client/cli/event_watch.hpp"

#include <utility>

#include "client/cli/shards_away.hpp"

namespace collided::cli {
namespace {

std::variant<Watch, ShardedWatch> begin_watching(Session& session, const Globals& globals,
                                                 const WatchOptions& options) {
  if (globals.shards.empty()) return take(session.client(globals).watch(options));
  ShardedWatch watch = take(session.sharded(globals).watch(options));
  warn_of_shards_away(session, globals, "what happens in its part is not heard");
  return watch;
}

}  // namespace

EventWatch::EventWatch(Session& session, const Globals& globals, const WatchOptions& options)
    : watch_(begin_watching(session, globals, options)) {}

std::optional<Event> EventWatch::next(std::chrono::nanoseconds wait) {
  return std::visit([&](auto& watch) { return watch.next(wait); }, watch_);
}

std::uint64_t EventWatch::lost() const {
  return std::visit([](const auto& watch) { return watch.lost(); }, watch_);
}

std::chrono::nanoseconds EventWatch::tells_since() const {
  const Watch* watch = std::get_if<Watch>(&watch_);
  return watch != nullptr ? watch->tells_since() : std::chrono::nanoseconds(0);
}

std::string_view EventWatch::news() {
  if (const auto* shards = std::get_if<ShardedWatch>(&watch_)) {
    const std::uint64_t before = std::exchange(gaps_, shards->gaps());
    return before == gaps_ ? ""
                           : "a shard was silent, or its server was started again; what was missed comes marked resync";
  }
  const bool is_connected = std::get<Watch>(watch_).connected();
  if (is_connected == std::exchange(was_connected_, is_connected)) return "";
  return is_connected ? "the server is back" : "the server is silent; events that it missed come marked resync";
}

}  // namespace collided::cli
