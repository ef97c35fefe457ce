#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

#include "server/fleet/primary_pulse.hpp"
#include "tests/service/eventually.hpp"
#include "tests/service/own_domain.hpp"

namespace collided::engine::service {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kSilentAfterNs = 300'000'000;

/// Writes a primary's status as its heartbeat does while a step lasts.
class BusyPrimary {
 public:
  explicit BusyPrimary(const dds::Participant& participant) : topic_(participant, "collided"), writer_(topic_) {
    status_->server = 7;
  }
  void beat(std::int64_t busy_ns) {
    const std::vector<std::uint64_t> publishers{wire_contract::kPublisherBusyWorld}, applied{0};
    const std::vector<std::int64_t> silent{busy_ns};
    const std::vector<std::uint8_t> states{0}, names{0};
    if (busy_ns > 0) {
      dds::borrow(status_->publishers, publishers);
      dds::borrow(status_->applied_sequences, applied);
      dds::borrow(status_->silent_ns, silent);
      dds::borrow(status_->publisher_states, states);
      dds::borrow(status_->publisher_names, names);
    }
    static_cast<void>(writer_.write(*status_));
  }
  bool is_heard() const { return writer_.matched_readers() > 0; }

 private:
  dds::Topic<wire::Status> topic_;
  dds::Writer<wire::Status> writer_;
  dds::Sample<wire::Status> status_;
};

// A standby replaces a primary that hangs, and none that is at a long step: it would be at the same one. What that step
// finds has not been written yet, so it is not counted as heard.
TEST(PrimaryPulse, APrimaryAtALongStepLivesAndOneThatHangsDoesNot) {
  const int domain = testing_support::own_domain();
  const dds::Participant here({.domain = domain, .role = dds::Role::server});
  const dds::Participant there({.domain = domain, .role = dds::Role::server, .process_domain = domain + 100'000});
  BusyPrimary primary(there);
  PrimaryPulse pulse(here, "collided", kSilentAfterNs,
                     {.primary = [] { return std::uint64_t{7}; },
                      .is_silent = [](std::int64_t) { return false; },
                      .is_replaced = [] { return false; }});
  ASSERT_TRUE(test::eventually([&] { return primary.is_heard(); }));
  const auto beat_until = [&](std::int64_t busy_ns, const auto& is_done) {
    for (int beats = 0; beats < 400 && !is_done(); ++beats) {
      primary.beat(busy_ns);
      std::this_thread::sleep_for(20ms);
    }
    return is_done();
  };
  primary.beat(0);
  ASSERT_TRUE(test::eventually([&] { return pulse.heard_ns() != 0; }));
  const std::int64_t heard_ns = pulse.heard_ns();
  // Three times as long as it may be silent; a machine that stands still meanwhile is not its fault.
  const auto over = std::chrono::steady_clock::now() + 3 * std::chrono::nanoseconds(kSilentAfterNs);
  int silences = 0;
  beat_until(1'000'000'000, [&] {
    silences += pulse.is_silent() ? 1 : 0;
    return std::chrono::steady_clock::now() >= over;
  });
  EXPECT_EQ(silences, 0);
  EXPECT_EQ(pulse.heard_ns(), heard_ns) << "only what its world's thread writes says how far its events are told";
  EXPECT_TRUE(beat_until(wire_contract::kWorldHangsNs + 1, [&] { return pulse.is_silent(); }));
}

}  // namespace
}  // namespace collided::engine::service
