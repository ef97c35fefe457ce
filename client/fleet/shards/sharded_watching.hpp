#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client/fleet/shards/episode_merge.hpp"
#include "client/fleet/shards/shard_links.hpp"
#include "client/library/watching/event_queue.hpp"
#include "client/library/watching/watch.hpp"
#include "collided/shards.hpp"

namespace collided::client {

/// A watch of each shard, and a thread that asks each one again and again how far it has decided. What every shard has
/// decided, and told by the next time that it is asked, goes through EpisodeMerge to next().
class [[gnu::visibility("hidden")]] ShardedWatching : public Subscription<Event>::Source {
 public:
  ShardedWatching(std::shared_ptr<ShardLinks> links, const WatchOptions& options);
  ~ShardedWatching() override;

  std::optional<Event> next(std::chrono::nanoseconds wait) override { return events_.next(wait); }
  SubscriptionHealth health() const override { return {.lost = events_.lost(), .resyncs = gaps_}; }
  std::chrono::nanoseconds settled() const { return std::chrono::nanoseconds(settled_ns_.load()); }
  std::size_t open_contacts() const { return open_contacts_; }

 private:
  /// How far a shard had come when it was asked.
  struct ShardProgress {
    std::chrono::nanoseconds settled{0};
    EventPlace told;
    std::uint64_t heir_of = 0;    // the server whose place it has taken; 0: it has taken none
    std::uint64_t told_from = 0;  // the first event that it has told since
  };
  struct WatchedShard {
    std::unique_ptr<Watch::State> watch;  // null: it was never there
    std::optional<ShardProgress> now;     // by the newest round in which it answered; none: it is away
    Clock::time_point there;              // when it last answered, or was heard although its answer was late
    std::uint64_t gaps = 0;               // of the watch, that are in gaps_
    std::uint64_t life_changes = 0;       // of the server, that were judged
  };
  struct ShardEvent {
    std::size_t shard = 0;
    Event event;
  };

  void run();
  void take_heard();
  void follow_view();
  void watch_new(std::size_t shard);
  std::string watched_map() const;
  std::optional<ShardProgress> ask(std::size_t shard);
  void ask_all();
  bool is_outdated() const;
  bool has_heard_all() const;
  void count_gaps(std::size_t shard);
  void judge_life_change(WatchedShard & watched);
  bool sleep();

  const std::shared_ptr<ShardLinks> links_;
  const WatchOptions options_;
  const std::uint64_t number_;  // by which servers know it among others
  // Before the watches, so that they are destroyed after them: the threads of the watches call back into these.
  std::mutex heard_mutex_;
  std::vector<ShardEvent> heard_;  // since the merge took them last
  // Of the thread.
  std::shared_ptr<const ShardView> view_;
  std::vector<WatchedShard> shards_;                    // by place in the view
  std::string told_map_;                                // fingerprint of the newest map all of whose shards are watched
  shards::ShardSet there_ = 0;                          // shards that answered in the newest round
  std::optional<std::chrono::nanoseconds> may_settle_;  // by the round before
  EpisodeMerge merge_;

  EventQueue<Event> events_;
  std::mutex over_mutex_;
  std::condition_variable over_came_;
  bool is_over_ = false;
  std::atomic<std::int64_t> settled_ns_{0};
  std::atomic<std::uint64_t> gaps_{0};
  std::atomic<std::size_t> open_contacts_{0};
  std::thread thread_;
};

}  // namespace collided::client
