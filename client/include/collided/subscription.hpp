#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

/// Subscriptions: how a program receives a server's reports.
#pragma GCC visibility push(default)

namespace collided {

/// The state of a subscription; counts are since its start.
struct SubscriptionHealth {
  std::uint64_t lost = 0;     // events dropped since next() was not called in time
  std::uint64_t resyncs = 0;  // how often missed events were reconstructed from the state
  bool connected = true;      // false if no status of the server has come for 240 ms
  /// The server has confirmed that the state at the start has been reported, so that later events are new. False again
  /// while missed events are being reconstructed.
  bool in_step = true;
};

/// The reports of a server, one after the other.
///
/// threads  calls from any thread. The destructor ends the subscription and waits for its thread
template <class News>
class Subscription {
 public:
  /// The source of the reports.
  struct Source {
    virtual ~Source() = default;
    virtual std::optional<News> next(std::chrono::nanoseconds wait) = 0;
    virtual SubscriptionHealth health() const = 0;
  };
  explicit Subscription(std::unique_ptr<Source> source) : source_(std::move(source)) {}

  /// Returns the next report; nothing if none comes within `wait`.
  std::optional<News> next(std::chrono::nanoseconds wait) { return source_->next(wait); }
  SubscriptionHealth health() const { return source_->health(); }
  std::uint64_t lost() const { return health().lost; }
  std::uint64_t resyncs() const { return health().resyncs; }
  bool connected() const { return health().connected; }
  bool in_step() const { return health().in_step; }

 protected:
  Source& source() const { return *source_; }

 private:
  std::unique_ptr<Source> source_;
};

}  // namespace collided

#pragma GCC visibility pop
