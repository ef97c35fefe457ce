#include "server/fleet/shards/shard_watchers.hpp"

namespace collided::engine::service {

void ShardWatchers::heard(std::uint64_t client, std::uint64_t watch, std::string map, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  const std::pair key(client, watch);
  if (heard_.size() >= kMost && !heard_.contains(key)) {
    forget_old(now_ns);
    if (heard_.size() >= kMost) {
      turned_away_ns_ = now_ns;
      return;
    }
  }
  heard_.insert_or_assign(key, HeardWatch{.map = std::move(map), .at_ns = now_ns});
}

ShardWatchers::WatcherCounts ShardWatchers::counts(const std::string& map, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  forget_old(now_ns);
  WatcherCounts counts{.all = heard_.size()};
  for (const auto& [key, heard] : heard_) counts.behind += heard.map != map ? 1 : 0;
  if (turned_away_ns_ != 0 && now_ns - turned_away_ns_ < kLast) {
    ++counts.all;
    ++counts.behind;
  }
  return counts;
}

void ShardWatchers::forget_old(std::int64_t now_ns) {
  std::erase_if(heard_, [&](const auto& entry) { return now_ns - entry.second.at_ns > kLast; });
}

}  // namespace collided::engine::service
