#include <gtest/gtest.h>

#include <functional>

#include "client/library/connection/server_pulse.hpp"
#include "tests/service/wire/network.hpp"

namespace collided {
namespace {

using client::Clock;
using client::ServerPulse;
using namespace std::chrono_literals;

const std::chrono::nanoseconds kLost(wire_contract::kStatusLostNs);

dds::Sample<wire::Status> status_of(std::uint64_t server, std::uint64_t version) {
  dds::Sample<wire::Status> status;
  status->server = server;
  status->version = version;
  return status;
}

/// Until it went through in less time than after which a server is lost: what the machine does meanwhile is not asked.
void in_good_time(const std::function<void(ServerPulse&)>& run, const std::function<void(ServerPulse&)>& check) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    ServerPulse pulse;
    const Clock::time_point start = Clock::now();
    run(pulse);
    if (Clock::now() - start >= kLost) continue;
    check(pulse);
    return;
  }
  FAIL() << "the machine is too slow to tell";
}

// Two servers on one namespace: the state, the version and the publishers of one are not those of the other.
TEST(ServerPulse, ASecondServersStatusDoesNotCountWhileTheFirstSpeaks) {
  std::vector<std::uint64_t> observed;
  in_good_time(
      [&](ServerPulse& pulse) {
        observed.clear();
        pulse.observe([&](const wire::Status& status) { observed.push_back(status.version); });
        for (const auto& [server, version] :
             std::vector<std::pair<std::uint64_t, std::uint64_t>>{{1, 10}, {2, 99}, {1, 11}, {2, 100}}) {
          auto status = status_of(server, version);
          pulse.hear(status);
        }
      },
      [&](ServerPulse& pulse) {
        EXPECT_EQ(pulse.server(), 1u);
        EXPECT_EQ(pulse.status()->version, 11u);
        EXPECT_EQ(observed, (std::vector<std::uint64_t>{10, 11}));
      });
}

TEST(ServerPulse, TheServerThatAnsweredHelloIsTheOneThatCounts) {
  in_good_time(
      [](ServerPulse& pulse) {
        pulse.greeted(1, 0);
        auto status = status_of(2, 99);
        pulse.hear(status);
      },
      [](ServerPulse& pulse) {
        EXPECT_EQ(pulse.server(), 1u);
        EXPECT_FALSE(pulse.status());
      });
}

TEST(ServerPulse, AnyMessageIsASignOfLifeToo) {
  in_good_time(
      [](ServerPulse& pulse) {
        auto status = status_of(1, 10);
        pulse.hear(status);
        const Clock::time_point heard = pulse.last_heard();
        EXPECT_TRUE(test::eventually([&] { return Clock::now() > heard + 1ms; }));
        pulse.hear_message();
        EXPECT_GT(pulse.last_heard(), heard);
      },
      [](ServerPulse& pulse) { EXPECT_FALSE(pulse.silent()); });
}

TEST(ServerPulse, OnceTheFirstIsSilentAnotherTakesItsPlace) {
  ServerPulse pulse;
  EXPECT_TRUE(pulse.silent()) << "nothing was heard";
  EXPECT_EQ(pulse.server(), 0u);
  EXPECT_FALSE(pulse.status());
  const Clock::time_point start = Clock::now();
  auto first = status_of(1, 10);
  pulse.hear(first);
  ASSERT_TRUE(test::eventually([&] { return pulse.silent(); }));
  EXPECT_GT(Clock::now() - start, kLost);
  auto second = status_of(2, 99);
  pulse.hear(second);
  EXPECT_EQ(pulse.server(), 2u);
  EXPECT_EQ(pulse.status()->version, 99u);
}

// A standby that takes its place has a greater epoch, and says once what nobody was told: it must be heard from its first
// word on. One of an earlier epoch may have been stopped, and goes on.
TEST(ServerPulse, AnHeirIsHeardSoonerThanAnyOtherAndAnEarlierServerLast) {
  in_good_time(
      [](ServerPulse& pulse) {
        auto first = status_of(1, 10);
        first->epoch = 7;
        pulse.hear(first);
        EXPECT_FALSE(pulse.is_heir(*first));
        auto heir = status_of(2, 11);
        heir->epoch = 8;
        EXPECT_FALSE(pulse.is_heir(*heir)) << "while the first speaks";
      },
      [](ServerPulse& pulse) {
        EXPECT_TRUE(test::eventually([&] { return pulse.may_have_heir(); }));
        auto heir = status_of(2, 11);
        heir->epoch = 8;
        EXPECT_TRUE(pulse.is_heir(*heir));
        pulse.hear(heir);
        EXPECT_EQ(pulse.epoch(), 8U);
        EXPECT_TRUE(test::eventually([&] { return pulse.silent(); }));
        auto first = status_of(1, 12);
        first->epoch = 7;
        EXPECT_FALSE(pulse.is_heir(*first));
        pulse.hear(first);
        EXPECT_EQ(pulse.server(), 2U);
      });
}

TEST(ServerPulse, EveryFieldOfAStatusIsItsOwn) {
  ServerPulse pulse;
  dds::Sample<wire::Status> sample;
  wire::Status& status = *sample;
  status.server = 1;
  status.epoch = 2;
  status.version = 3;
  status.world_time_ns = 4;
  status.last_event_sequence = 5;
  status.contact_count = 6;
  status.contacts_truncated = 1;
  status.state = static_cast<std::uint8_t>(wire_contract::ServerState::recovering);
  status.pid = 7;
  ASSERT_TRUE(dds::set_text(status.namespace_name, "eight"));
  ASSERT_TRUE(dds::set_text(status.server_version, "nine"));
  ASSERT_TRUE(dds::set_text(status.scenes, "hall\nyard"));
  status.static_triangles = 10;
  status.object_count = 11;
  status.moving_count = 12;
  status.poses_applied = 13;
  status.poses_dropped = 14;
  status.questions_answered = 15;
  status.questions_refused = 16;
  status.undecided_answers = 17;
  const std::vector<std::uint64_t> publishers{20, 21, 22}, applied{30, 31, 32};
  const std::vector<std::int64_t> silent{40, 41, 42};
  const std::vector<std::uint8_t> states{0, 1, 2};
  const std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"a", "b", "c"});
  dds::borrow(status.publishers, publishers);
  dds::borrow(status.applied_sequences, applied);
  dds::borrow(status.silent_ns, silent);
  dds::borrow(status.publisher_states, states);
  dds::borrow(status.publisher_names, names);
  pulse.hear(sample);
  const ServerStatus told = *pulse.status();
  EXPECT_EQ(told.name_space, "eight");
  EXPECT_EQ(told.version_text, "nine");
  EXPECT_EQ(told.pid, 7u);
  EXPECT_EQ(told.state, "recovering");
  EXPECT_EQ(told.epoch, 2u);
  EXPECT_EQ(told.version, 3u);
  EXPECT_EQ(told.world_time, 4ns);
  EXPECT_EQ(told.last_event_sequence, 5u);
  EXPECT_EQ(told.contacts, 6u);
  EXPECT_TRUE(told.contacts_truncated);
  EXPECT_EQ(told.scenes, (std::vector<std::string>{"hall", "yard"}));
  EXPECT_EQ(told.static_triangles, 10u);
  EXPECT_EQ(told.objects, 11u);
  EXPECT_EQ(told.moving, 12u);
  EXPECT_EQ(told.poses_applied, 13u);
  EXPECT_EQ(told.poses_dropped, 14u);
  EXPECT_EQ(told.questions_answered, 15u);
  EXPECT_EQ(told.questions_refused, 16u);
  EXPECT_EQ(told.undecided_answers, 17u);
  ASSERT_EQ(told.publishers.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(told.publishers[i].name, std::string(1, static_cast<char>('a' + i)));
    EXPECT_EQ(told.publishers[i].applied_sequence, 30 + i);
    EXPECT_EQ(told.publishers[i].silent, std::chrono::nanoseconds(40 + i));
    EXPECT_EQ(told.publishers[i].lost, i == 2);
    const auto view = pulse.publisher(20 + i);
    ASSERT_TRUE(view);
    EXPECT_EQ(view->applied_sequence, 30 + i);
    EXPECT_EQ(view->lost, i == 2);
  }
  for (const std::uint64_t unknown : {0, 19, 23}) EXPECT_FALSE(pulse.publisher(unknown)) << unknown;
}

// The last row of the publishers is the world's, where that is at a step: no publisher, and how long it has lasted.
TEST(ServerPulse, ABusyWorldIsNoPublisher) {
  ServerPulse pulse;
  const std::vector<std::uint64_t> publishers{20, wire_contract::kPublisherBusyWorld}, applied{30, 0};
  const std::vector<std::int64_t> silent{40, 5'000'000'000};
  const std::vector<std::uint8_t> states{0, 0};
  const std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"a", ""});
  auto busy = status_of(1, 7);
  dds::borrow(busy->publishers, publishers);
  dds::borrow(busy->applied_sequences, applied);
  dds::borrow(busy->silent_ns, silent);
  dds::borrow(busy->publisher_states, states);
  dds::borrow(busy->publisher_names, names);
  pulse.hear(busy);
  EXPECT_TRUE(pulse.is_busy());
  EXPECT_EQ(pulse.status()->step_lasting, 5s);
  ASSERT_EQ(pulse.status()->publishers.size(), 1U);
  EXPECT_EQ(pulse.status()->publishers[0].name, "a");
  const Clock::time_point last = pulse.last_busy();
  auto free = status_of(1, 8);
  pulse.hear(free);
  EXPECT_FALSE(pulse.is_busy());
  EXPECT_EQ(pulse.status()->step_lasting, 0s);
  EXPECT_EQ(pulse.last_busy(), last);
}

TEST(ServerPulse, EachStateHasItsName) {
  const char* names[] = {"starting", "recovering", "ready", "stopping", "unknown (4)"};
  for (std::uint8_t state = 0; state < 5; ++state) {
    ServerPulse pulse;
    auto status = status_of(1, 1);
    status->state = state;
    pulse.hear(status);
    EXPECT_EQ(pulse.status()->state, names[state]);
  }
}

// A status whose lists differ in length is taken as far as all of them go.
TEST(ServerPulse, ColumnsOfPublishersThatDifferInLengthAreCutToTheShortest) {
  const std::vector<std::uint64_t> publishers{21, 20}, applied{30};
  const std::vector<std::int64_t> silent{40, 41};
  const std::vector<std::uint8_t> states{0, 2};
  const std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"a", "b"});
  ServerPulse pulse;
  auto status = status_of(1, 1);
  dds::borrow(status->publishers, publishers);
  dds::borrow(status->applied_sequences, applied);
  dds::borrow(status->silent_ns, silent);
  dds::borrow(status->publisher_states, states);
  dds::borrow(status->publisher_names, names);
  pulse.hear(status);
  EXPECT_EQ(pulse.status()->publishers.size(), 1u);
  EXPECT_TRUE(pulse.publisher(21));
  EXPECT_FALSE(pulse.publisher(20));
}

TEST(ServerPulse, AnObserverHearsUntilItIsStopped) {
  ServerPulse pulse;
  int first = 0, second = 0;
  const int number = pulse.observe([&](const wire::Status&) { ++first; });
  pulse.observe([&](const wire::Status&) { ++second; });
  auto status = status_of(1, 1);
  pulse.hear(status);
  pulse.stop_observing(number);
  auto next = status_of(1, 2);
  pulse.hear(next);
  EXPECT_EQ(first, 1);
  EXPECT_EQ(second, 2);
}

}  // namespace
}  // namespace collided
