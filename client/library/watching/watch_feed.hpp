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

/// The readers and the thread of a watch. The readers' callbacks, on DDS's threads, only queue messages. The thread decodes
/// them and has a WatchStateOf make events of them, which it emits. Contacts have their bookmarks in the connection's
/// statuses, standing questions in the sum among the shards.
///
/// threads  any; emit() runs on the feed's own thread, and in state() on the caller's
template <class News>
class WatchFeed {
 public:
  using Emit = typename WatchStateOf<News>::Emit;
  /// persisted  reads contacts that go on, too, which costs the server work
  WatchFeed(std::shared_ptr<Connection> connection, Emit emit, bool persisted = false);
  ~WatchFeed();

  /// Waits until the readers are matched. Bookmarks count only from then on: before, events after one could be missed.
  std::optional<Error> wait_for_server();
  /// Before run().
  WatchStateOf<News>& state() { return state_; }
  /// Starts the thread, which calls `first` once before all else.
  void run(std::function<void()> first = [] {});

  SubscriptionHealth health(std::uint64_t lost) const {
    return {.lost = lost, .resyncs = resyncs_, .connected = !connection_->pulse().silent(), .in_step = in_step_};
  }
  /// WatchState::emitted_through(): those events have been passed on.
  std::optional<EventPlace> told_through() const {
    const std::lock_guard lock(told_mutex_);
    return told_through_;
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
  void hear(Message& message);

  std::shared_ptr<Connection> connection_;
  WatchStateOf<News> state_;
  std::atomic<std::uint64_t> resyncs_{0};
  std::atomic<std::uint64_t> gaps_{0};
  std::atomic<bool> in_step_{false};
  mutable std::mutex told_mutex_;
  std::optional<EventPlace> told_through_;
  LifeChange life_change_;

  std::atomic<bool> has_readers_{false};
  std::mutex taking_mutex_;  // the readers' callbacks and the constructor
  FramePool frames_;
  ShardPool shards_;
  std::mutex messages_mutex_;
  std::condition_variable message_came_;
  std::deque<Message> messages_;
  bool ending_ = false;
  bool has_sum_ = false;  // of standing questions: one was heard; the thread's own

  dds::Topic<Frame> frame_topic_;
  dds::Topic<Shard> shard_topic_;
  std::optional<dds::Topic<Frame>> persisted_topic_;
  std::optional<dds::Reader<Frame>> frame_reader_;
  std::optional<dds::Reader<Frame>> persisted_reader_;
  std::optional<dds::Reader<Shard>> shard_reader_;
  std::optional<int> status_observer_;
  std::thread thread_;
};

}  // namespace collided::client
