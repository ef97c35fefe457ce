#include "server/fleet/primary_pulse.hpp"

#include <utility>

#include "idl/columns.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {

namespace {

/// From one look to the next; much less than any silence that counts.
constexpr std::int64_t kLookNs = 10'000'000;
/// A look that comes so late was this process's own standstill: what came meanwhile may not have been received yet.
constexpr std::int64_t kStoodStillNs = 5 * kLookNs;

}  // namespace

PrimaryPulse::PrimaryPulse(const dds::Participant& participant, const std::string& name_space,
                           std::int64_t silent_after_ns, Collaborators with)
    : silent_after_ns_(silent_after_ns),
      with_(std::move(with)),
      topic_(participant, name_space),
      reader_(topic_),
      waitset_(participant) {
  waitset_.attach(reader_, 1);
  thread_ = named_thread("pulse", [this] { run(); });
}

PrimaryPulse::~PrimaryPulse() {
  is_over_.store(true);
  waitset_.wake();
  thread_.join();
}

void PrimaryPulse::run() {
  looked_ns_ = steady_ns();
  while (!is_over_.load()) {
    waitset_.wait(kLookNs);
    take();
    const std::int64_t now_ns = steady_ns();
    // A standstill of this process must not count against the primary, which gets the whole time again.
    if (now_ns - looked_ns_ > kStoodStillNs && blamed_ns_ != 0) blamed_ns_ = now_ns;
    looked_ns_ = now_ns;
    const std::int64_t silent_ns = blamed_ns_ == 0 ? 0 : now_ns - blamed_ns_;
    is_silent_.store(silent_ns > silent_after_ns_);
    const bool is_given_up = is_silent_.load() || with_.is_replaced();
    if (is_given_up && with_.is_silent(silent_ns)) return;
  }
}

void PrimaryPulse::take() {
  const std::uint64_t primary = with_.primary();
  // One that has just taken the place is not to be blamed for the silence of the one before.
  if (std::exchange(listened_to_, primary) != primary && blamed_ns_ != 0) blamed_ns_ = steady_ns();
  while (reader_.take(status_)) {
    if (!status_.info().valid_data || status_->server != primary) continue;
    const std::int64_t busy_ns = wire::busy_ns(*status_);
    if (busy_ns > wire_contract::kWorldHangsNs) continue;
    blamed_ns_ = steady_ns();
    if (busy_ns == 0) heard_ns_.store(blamed_ns_);
  }
}

}  // namespace collided::engine::service
