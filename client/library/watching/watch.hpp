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
#include "client/library/watching/event_queue.hpp"
#include "client/library/watching/watch_state.hpp"

namespace collided {

/// A watch's readers and its thread. The readers' callbacks, on DDS's threads, only queue messages. The watch's thread
/// decodes them, has client::WatchState make events of them, and calls the callback or queues the events for next().
struct [[gnu::visibility("hidden")]] Watch::State : Subscription<Event>::Source {
  using Callback = std::function<void(const Event&)>;
  static Result<std::unique_ptr<State>> start(std::shared_ptr<client::Connection> connection,
                                              const WatchOptions& options, Callback callback,
                                              WatchOf subject = WatchOf::contacts);
  ~State() override;

  std::optional<Event> next(std::chrono::nanoseconds wait) override { return events_.next(wait); }
  SubscriptionHealth health() const override {
    return {
        .lost = events_.lost(), .resyncs = resyncs_, .connected = !connection_->pulse().silent(), .in_step = in_step_};
  }
  std::size_t open_contacts() const { return open_contacts_; }
  /// WatchState::emitted_through(): those events have been passed on.
  std::optional<client::EventPlace> told_through() const {
    const std::lock_guard lock(told_mutex_);
    return told_through_;
  }
  /// WatchState::gaps().
  std::uint64_t gaps() const { return gaps_; }
  /// WatchState::life_change().
  client::LifeChange life_change() const {
    const std::lock_guard lock(told_mutex_);
    return life_change_;
  }
  std::chrono::nanoseconds tells_since() const { return tells_since_; }

 private:
  using FramePool = client::SamplePool<wire::EventFrame>;
  using ShardPool = client::SamplePool<wire::ContactShard>;
  struct PersistedFrame {
    FramePool::Pointer sample;
  };
  using Message = std::variant<FramePool::Pointer, PersistedFrame, ShardPool::Pointer, client::HeardBookmark>;

  State(std::shared_ptr<client::Connection> connection, const WatchOptions& options, Callback callback,
        WatchOf subject);
  // Hears the bookmarks: the connection's statuses, or those of fences.
  void follow_bookmarks();
  void take_bookmarks();
  // Waits until the readers are matched.
  std::optional<Error> wait_for_server() const;
  // Fetches the flight recorder and takes its events since that time into recorded_.
  std::optional<Error> hear_recorded(std::chrono::nanoseconds since);
  template <class As, class T>
  void take(std::optional<dds::Reader<T>> & reader, client::SamplePool<T> & pool);
  // Queues a message for the thread, which runs work().
  void queue(Message message);
  void work();
  void hear(Message & message);
  // Passes an event on if it is wanted: to recorded_, the callback or the queue.
  void emit(const Event& event);

  std::shared_ptr<client::Connection> connection_;
  WatchOptions options_;
  Callback callback_;
  client::WatchState watch_;
  std::vector<Event> recorded_;  // events since WatchOptions::since, which the thread reports first
  std::chrono::nanoseconds tells_since_{0};
  bool is_hearing_recorded_ = false;
  std::atomic<std::uint64_t> resyncs_{0};
  std::atomic<std::uint64_t> gaps_{0};
  std::atomic<bool> in_step_{false};
  mutable std::mutex told_mutex_;
  std::optional<client::EventPlace> told_through_;
  client::LifeChange life_change_;
  std::atomic<std::size_t> open_contacts_{0};

  std::atomic<bool> has_readers_{false};
  std::mutex taking_mutex_;  // the readers' callbacks and the constructor
  FramePool frames_;
  ShardPool shards_;
  std::mutex messages_mutex_;
  std::condition_variable message_came_;
  std::deque<Message> messages_;
  bool ending_ = false;

  client::EventQueue events_;

  dds::Topic<wire::EventFrame> event_topic_;
  dds::Topic<wire::ContactShard> contact_topic_;
  std::optional<dds::Topic<wire::EventFrame>> persisted_topic_;  // only where requested, since it costs the server work
  std::optional<dds::Reader<wire::EventFrame>> event_reader_;
  std::optional<dds::Reader<wire::EventFrame>> persisted_reader_;
  std::optional<dds::Reader<wire::ContactShard>> contact_reader_;
  std::optional<int> status_observer_;
  // Of fences.
  std::optional<dds::Topic<wire::Status>> bookmark_topic_;
  std::optional<dds::Reader<wire::Status>> bookmark_reader_;
  std::atomic<bool> has_bookmark_reader_{false};
  std::mutex bookmark_mutex_;
  dds::Sample<wire::Status> bookmark_;
  std::thread thread_;
};

}  // namespace collided
