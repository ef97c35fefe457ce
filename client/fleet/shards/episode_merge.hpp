#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "collided/events.hpp"
#include "idl/shards/shard_map.hpp"

namespace collided::client {

/// Makes one stream of contact events of those that several shards tell. It uses no DDS, threads or clocks.
///
/// What a shard tells of a pair is true of the pair for as long as it holds both objects, and at each instant of a contact
/// a shard whose box has a point of it holds both. So a contact begins with the first `began` that a shard tells. It ends
/// when one shard says so, for a reason that is the pair's: the others will say the same. Other reasons may be that shard's
/// alone: an object left it, its server stopped or was started again, it lost a publisher, or objects were placed there again
/// after it was away. The contact ends for such a reason when the last shard that holds it says so. While a shard is split
/// its box is also that of others: nothing of this changes, since boxes may overlap.
///
/// threads  one at a time
/// Always: for every pair of names it tells `began` (or `open`) and `ended` in turn, with the names in order, and between
/// them `contained` and `emerged` in turn.
class EpisodeMerge {
 public:
  using Tell = std::function<void(const Event&)>;
  EpisodeMerge(shards::ShardMap map, Tell tell) : map_(std::move(map)), tell_(std::move(tell)) {}

  /// Goes by another map from now on, in which each shard has the place that it had: after a split others are there too.
  void set_map(shards::ShardMap map) { map_ = std::move(map); }
  /// Leaves aside what a shard has told of what goes on. To be called once other shards hold all that it held, and have been
  /// heard about it: what is open with them stays open.
  void forget(std::size_t shard);

  /// Takes an event of a shard, in that shard's order.
  void hear(std::size_t shard, const Event& event);
  /// Tells what happened up to then: every shard that is there has been heard up to that world time.
  void settle(std::chrono::nanoseconds through);

  std::size_t open_contacts() const { return told_count_; }

 private:
  using Names = std::pair<std::string, std::string>;
  struct HeardEvent {
    std::chrono::nanoseconds at{0};
    std::uint64_t order = 0;  // in which it came
    std::size_t shard = 0;
    Event event;
    bool is_of_pair = true;  // `ended` or `emerged` counts for every shard, not only for this one
  };
  struct PairState {
    shards::ShardSet open = 0;       // shards that say that the two touch
    shards::ShardSet contained = 0;  // and that one lies within the other
    bool is_told = false;
    bool is_told_contained = false;
    std::uint64_t episode = 0;
    std::chrono::nanoseconds began{0};
  };

  static void sort_by_time(std::vector<HeardEvent>& of_pair);
  void settle_instant(std::span<HeardEvent> instant);
  static bool is_of_pair(const HeardEvent& heard, std::span<const HeardEvent> instant, const PairState& pair);
  void take_turn(PairState& pair, std::span<HeardEvent* const> turn);
  static void note(PairState& pair, const HeardEvent& heard);
  bool is_owner(const HeardEvent& heard) const;
  int rank(const HeardEvent& heard) const;
  const HeardEvent* chosen(std::span<HeardEvent* const> turn, EventKind kind) const;
  void begin(PairState& pair, const HeardEvent& heard);
  void tell(PairState& pair, Event event);

  shards::ShardMap map_;
  Tell tell_;
  std::map<Names, std::vector<HeardEvent>> pending_;
  std::map<Names, PairState> pairs_;
  std::uint64_t order_ = 0;
  std::uint64_t sequence_ = 0;
  std::size_t told_count_ = 0;
};

}  // namespace collided::client
