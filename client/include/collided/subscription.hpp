#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

/// How a program takes what a server reports from then on.
#pragma GCC visibility push(default)

namespace collided {

struct SubscriptionHealth {
  std::uint64_t lost = 0;     // dropped since next() was not called in time
  std::uint64_t resyncs = 0;  // how often something was missed and had to be made up for from the state
  bool connected = true;      // false while no status of the server has come for 240 ms
  /// The server has confirmed that what held at the start has been reported, so that what comes from now on is new. False
  /// again while something missed is being made up for.
  bool in_step = true;
};

/// What a server reports, one after the other.
///
/// threads  calls from any thread. Destroying it ends the subscription and waits for its thread
template <class News>
class Subscription {
 public:
  /// Where the news come from.
  struct Source {
    virtual ~Source() = default;
    virtual std::optional<News> next(std::chrono::nanoseconds wait) = 0;
    virtual SubscriptionHealth health() const = 0;
  };
  explicit Subscription(std::unique_ptr<Source> source) : source_(std::move(source)) {}

  /// The next one; nothing if none comes within `wait`.
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
