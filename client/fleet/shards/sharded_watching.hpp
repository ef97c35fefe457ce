#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
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

/// A watch of each shard, and a thread that merges what they report. Events that every shard has decided, by the watermarks
/// among them, go through EpisodeMerge to next().
class [[gnu::visibility("hidden")]] ShardedWatching : public Subscription<Event>::Source {
 public:
  ShardedWatching(std::shared_ptr<ShardLinks> links, const WatchOptions& options);
  ~ShardedWatching() override;

  std::optional<Event> next(std::chrono::nanoseconds wait) override { return events_.next(wait); }
  SubscriptionHealth health() const override { return {.lost = events_.lost(), .resyncs = gaps_}; }
  std::chrono::nanoseconds settled() const { return std::chrono::nanoseconds(settled_ns_.load()); }
  std::size_t open_contacts() const { return open_contacts_; }

 private:
  struct WatchedShard {
    std::unique_ptr<Watch::State> watch;  // null: it was never there
    std::optional<SettledTime> settled;   // none: it is away
    Clock::time_point there;              // when it was in step last
    std::uint64_t gaps = 0;               // of the watch, that are in gaps_
    std::uint64_t life_changes = 0;       // of the server, that were judged
  };
  /// The least of all shards' watermarks, which counts once each shard has sent another one.
  struct SettledByAll {
    std::chrono::nanoseconds to{0};
    Clock::time_point came;  // the newest of them
  };
  struct ShardEvent {
    std::size_t shard = 0;
    Event event;
  };

  void run();
  void note_news();
  void take_heard();
  void follow_view();
  void watch_new(std::size_t shard);
  std::optional<SettledTime> settled_of(std::size_t shard) const;
  bool look_at(std::size_t shard);
  void settle();
  void report_map();
  void count_gaps(std::size_t shard);
  void judge_life_change(WatchedShard & watched);
  bool wait_for_news();

  const std::shared_ptr<ShardLinks> links_;
  const WatchOptions options_;
  const std::uint64_t number_;  // by which servers know it among others
  // Before the watches, so that they are destroyed after them: the threads of the watches call back into these.
  std::mutex heard_mutex_;
  std::vector<ShardEvent> heard_;  // since the merge took them last
  std::condition_variable news_came_;
  bool has_news_ = false;
  bool is_over_ = false;
  // Of the thread.
  std::shared_ptr<const ShardView> view_;
  std::vector<WatchedShard> shards_;    // by place in the view
  std::string watched_map_;             // fingerprint of the newest map all of whose shards are watched
  Clock::time_point reported_;          // when servers were told of that last
  shards::ShardSet there_ = 0;          // shards in step
  std::deque<SettledByAll> to_settle_;  // ascending
  EpisodeMerge merge_;

  EventQueue<Event> events_;
  std::atomic<std::int64_t> settled_ns_{0};
  std::atomic<std::uint64_t> gaps_{0};
  std::atomic<std::size_t> open_contacts_{0};
  std::thread thread_;
};

}  // namespace collided::client
