#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "client/library/watching/event_queue.hpp"
#include "client/library/watching/watch_feed.hpp"

namespace collided {

/// A watch of contacts: calls the callback or queues the events for next().
struct [[gnu::visibility("hidden")]] Watch::State : Subscription<Event>::Source {
  using Callback = std::function<void(const Event&)>;
  /// heard  as of WatchFeed
  static Result<std::unique_ptr<State>> start(std::shared_ptr<client::Connection> connection,
                                              const WatchOptions& options, Callback callback,
                                              std::function<void()> heard = {});

  std::optional<Event> next(std::chrono::nanoseconds wait) override { return events_.next(wait); }
  SubscriptionHealth health() const override { return feed_.health(events_.lost()); }
  std::size_t open_contacts() const { return open_contacts_; }
  const client::WatchFeed<Event>& feed() const { return feed_; }
  std::chrono::nanoseconds tells_since() const { return tells_since_; }

 private:
  State(std::shared_ptr<client::Connection> connection, const WatchOptions& options, Callback callback,
        std::function<void()> heard);
  // Fetches the flight recorder and takes its events since that time into recorded_.
  std::optional<Error> hear_recorded(client::Connection & connection, std::chrono::nanoseconds since);
  // Passes an event on if it is wanted: to recorded_, the callback or the queue.
  void emit(const Event& event);

  WatchOptions options_;
  Callback callback_;
  std::vector<Event> recorded_;  // events since WatchOptions::since, which the thread reports first
  std::chrono::nanoseconds tells_since_{0};
  bool is_hearing_recorded_ = false;
  std::atomic<std::size_t> open_contacts_{0};
  client::EventQueue<Event> events_;
  client::WatchFeed<Event> feed_;  // destroyed first, since its thread uses the rest
};

}  // namespace collided
