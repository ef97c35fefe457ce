#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>

#include "client/library/connection/connection.hpp"
#include "client/library/watching/watch_decoding.hpp"

namespace collided::client {

/// The readers and the thread of a watch. The readers' callbacks, on DDS's threads, only queue messages. The thread
/// decodes them, passes them to a WatchStateOf and emits the resulting events. Bookmarks of contacts are in the
/// connection's statuses, those of standing questions in the sum of the shards.
///
/// threads  any; emit() runs on the feed's own thread, and in state() on the caller's
template <class News>
class WatchFeed {
 public:
  using Emit = typename WatchStateOf<News>::Emit;
  /// persisted  reads contacts that go on, too, which costs the server work
  /// heard      reads watermarks, too; called after each message, on the feed's thread
  WatchFeed(std::shared_ptr<Connection> connection, Emit emit, bool persisted = false,
            std::function<void()> heard = {});
  ~WatchFeed();

  /// Waits until the readers are matched. Only later bookmarks count: events after an earlier one could be missed.
  std::optional<Error> wait_for_server();
  /// Before run().
  WatchStateOf<News>& state() { return state_; }
  /// Starts the thread, which calls `first` once before all else.
  void run(std::function<void()> first = [] {});

  SubscriptionHealth health(std::uint64_t lost) const {
    return {.lost = lost, .resyncs = resyncs_, .connected = !connection_->pulse().silent(), .in_step = in_step_};
  }
  /// WatchState::settled(): those events have been passed on.
  std::optional<SettledTime> settled() const {
    const std::lock_guard lock(told_mutex_);
    return settled_;
  }
  /// WatchState::gaps().
  std::uint64_t gaps() const { return gaps_; }
  /// WatchState::life_change().
  LifeChange life_change() const {
    const std::lock_guard lock(told_mutex_);
    return life_change_;
  }

 private:
  using Frame = typename WireOf<News>::Frame;
  using Shard = typename WireOf<News>::Shard;
  using FramePool = SamplePool<Frame>;
  using ShardPool = SamplePool<Shard>;
  using FramePointer = typename FramePool::Pointer;
  using ShardPointer = typename ShardPool::Pointer;
  struct PersistedFrame {
    FramePointer sample;
  };
  using Message = std::variant<FramePointer, PersistedFrame, ShardPointer, HeardBookmark>;

  template <class As, class T>
  void take(std::optional<dds::Reader<T>>& reader, SamplePool<T>& pool);
  // Queues a message for the thread, which runs work().
  void queue(Message message);
  void work();
  void hear(Message& message, Clock::time_point came);

  std::shared_ptr<Connection> connection_;
  WatchStateOf<News> state_;
  const std::function<void()> heard_;
  std::atomic<std::uint64_t> resyncs_{0};
  std::atomic<std::uint64_t> gaps_{0};
  std::atomic<bool> in_step_{false};
  mutable std::mutex told_mutex_;
  std::optional<SettledTime> settled_;
  LifeChange life_change_;

  std::atomic<bool> has_readers_{false};
  std::mutex taking_mutex_;  // serializes the readers' callbacks and the constructor
  FramePool frames_;
  ShardPool shards_;
  std::mutex messages_mutex_;
  std::condition_variable message_came_;
  std::deque<std::pair<Message, Clock::time_point>> messages_;  // and when they came
  bool ending_ = false;
  bool has_sum_ = false;  // for standing questions: a sum was received; used only by the thread

  dds::Topic<Frame> frame_topic_;
  dds::Topic<Shard> shard_topic_;
  std::optional<dds::Topic<Frame>> persisted_topic_;
  std::optional<dds::Topic<Frame>> watermark_topic_;
  std::optional<dds::Reader<Frame>> frame_reader_;
  std::optional<dds::Reader<Frame>> persisted_reader_;
  std::optional<dds::Reader<Frame>> watermark_reader_;
  std::optional<dds::Reader<Shard>> shard_reader_;
  std::optional<int> status_observer_;
  std::thread thread_;
};

}  // namespace collided::client
