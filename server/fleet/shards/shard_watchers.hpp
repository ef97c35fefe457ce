#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace collided::engine::service {

/// The watches of this shard together with others, and by which map they watch: each reports that twice a second while a
/// shard is split. So it is known before the next map holds whether all of them watch the new shards.
///
/// threads  any
class ShardWatchers {
 public:
  struct WatcherCounts {
    std::size_t all = 0;     // heard within kLast
    std::size_t behind = 0;  // that do not watch by the map asked about
  };
  static constexpr std::int64_t kLast = 3'000'000'000;  // ns; a watch reports twice a second
  static constexpr std::size_t kMost = 65'536;          // beyond it they count, and nobody knows what they watch

  /// client, watch  whose it is, and its number there
  /// map            the fingerprint that it says
  void heard(std::uint64_t client, std::uint64_t watch, std::string map, std::int64_t now_ns);
  /// How many there are, and how many of them do not watch by this map.
  WatcherCounts counts(const std::string& map, std::int64_t now_ns);

 private:
  struct HeardWatch {
    std::string map;
    std::int64_t at_ns = 0;
  };
  void forget_old(std::int64_t now_ns);

  std::mutex mutex_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, HeardWatch> heard_;
  std::int64_t turned_away_ns_ = 0;  // when one was not noted, for want of room; 0: never
};

}  // namespace collided::engine::service
