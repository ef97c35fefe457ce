#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "idl/topics.hpp"
#include "server/world/events/events.hpp"

namespace collided::engine::service {

/// The shards of the held pairs that need to be written again.
class ChangedShards {
 public:
  void mark(const OpenContact& pair) { is_changed_[wire_contract::contact_shard(pair.a, pair.b)] = 1; }
  void mark_all() { is_changed_.assign(wire_contract::kContactShards, 1); }

  /// Calls visit(shard, numbers of its pairs in `holding`) for each, in order, and clears them.
  template <class Visit>
  void take(const std::vector<OpenContact>& holding, Visit&& visit) {
    if (std::ranges::find(is_changed_, 1) == is_changed_.end()) return;
    for (std::vector<std::uint32_t>& numbers : of_shard_) numbers.clear();
    for (std::uint32_t i = 0; i < holding.size(); ++i) {
      const std::uint8_t shard = wire_contract::contact_shard(holding[i].a, holding[i].b);
      if (is_changed_[shard] != 0) of_shard_[shard].push_back(i);
    }
    for (std::uint32_t shard = 0; shard < is_changed_.size(); ++shard) {
      if (is_changed_[shard] == 0) continue;
      is_changed_[shard] = 0;
      visit(static_cast<std::uint8_t>(shard), of_shard_[shard]);
    }
  }

 private:
  std::vector<std::uint8_t> is_changed_ = std::vector<std::uint8_t>(wire_contract::kContactShards, 0);  // by shard
  std::vector<std::vector<std::uint32_t>> of_shard_{wire_contract::kContactShards};
};

}  // namespace collided::engine::service
