#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>

#include "client/library/connection/connection.hpp"
#include "idl/described.hpp"

namespace collided {

/// A reading in the answer of `probes` and in a watch; `object` is unknown if the state is absent. The answer of
/// `probes` has the members common to all readings only once.
constexpr auto fields_of(const ProbeReading*) {
  using T = ProbeReading;
  constexpr auto has_object = [](const T& reading) { return reading.state != Clearance::absent; };
  return listed(fields<&T::probe, &T::state>(), fields_if<has_object, &T::object>(),
                fields<&T::clearance_m, &T::error_m, &T::met, &T::triangle, &T::point, &T::normal>(),
                unless_default<&T::epoch, &T::version, &T::world_time>());
}

}  // namespace collided

namespace collided::client {

/// Client::add_probe, remove_probes and probes.
Result<void> add_probe(Connection& connection, const Probe& probe);
Result<std::size_t> remove_probes(Connection& connection, const std::string& name);
Result<std::vector<ProbeReading>> read_probes(Connection& connection, const std::string& name_glob);

/// Appends the frame's readings; false if its columns differ in length.
bool decode(const wire::ProbeFrame& frame, Names& names, std::vector<ProbeReading>& readings);

/// The reader of the probe topic, and the queue of readings for next().
///
/// threads  any; DDS's thread fills the queue, the caller's empties it
class [[gnu::visibility("hidden")]] ProbeReader : public Subscription<ProbeReading>::Source {
 public:
  static Result<std::unique_ptr<ProbeReader>> start(std::shared_ptr<Connection> connection,
                                                    const WatchOptions& options);

  std::optional<ProbeReading> next(std::chrono::nanoseconds wait) override;
  SubscriptionHealth health() const override { return {.lost = lost_, .connected = !connection_->pulse().silent()}; }

 private:
  ProbeReader(std::shared_ptr<Connection> connection, const WatchOptions& options);
  void take();

  std::shared_ptr<Connection> connection_;
  WatchOptions options_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<ProbeReading> readings_;
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<bool> has_reader_{false};
  std::mutex taking_mutex_;  // serializes the reader's callback and the constructor; also guards the next two
  dds::Sample<wire::ProbeFrame> incoming_;
  std::vector<ProbeReading> decoded_;
  // Last, so that they are destroyed first: their callbacks use the members above.
  dds::Topic<wire::ProbeFrame> topic_;
  std::optional<dds::Reader<wire::ProbeFrame>> reader_;
};

}  // namespace collided::client
