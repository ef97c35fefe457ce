#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "collided/client.hpp"
#include "tests/service/wire/fake_server.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using test::eventually;
using test::FakeServer;

/// When the contact of the first event began: its frame's world time, 1,000 ns, less the bracket's end, -5 ms.
constexpr std::chrono::nanoseconds kFirstBegan = 5'001'000ns;

/// Speaks frames, shards and bookmarks of a made-up world whose objects are numbered and named "object_<n>".
class EventTeller {
 public:
  using Pair = std::pair<std::uint64_t, std::uint64_t>;
  explicit EventTeller(FakeServer& server) : server_(server) {}

  void began(Pair pair, bool lost = false) {
    contacts_[pair] = ++sequence_;
    tell(pair, 0, 0, sequence_, lost);
  }
  void ended(Pair pair, std::uint8_t reason = 1, bool lost = false) {
    const std::uint64_t episode = contacts_.at(pair);
    contacts_.erase(pair);
    ++sequence_;
    tell(pair, 2, reason, episode, lost);
  }
  std::uint64_t sequence() const { return sequence_; }
  void persisted(Pair pair) {
    write_frame(server_.persisted(), 0, pair, 1, 0, contacts_.at(pair),
                wire_contract::contact_shard(pair.first, pair.second));
  }

 private:
  static std::vector<std::uint8_t> names(const std::vector<std::uint64_t>& ids) {
    std::vector<std::string> names;
    for (const std::uint64_t id : ids) { names.push_back("object_" + std::to_string(id)); }
    return wire_contract::pack_names(names);
  }

  void tell(Pair pair, std::uint8_t kind, std::uint8_t reason, std::uint64_t episode, bool lost) {
    const std::uint8_t shard = wire_contract::contact_shard(pair.first, pair.second);
    if (!lost) { write_frame(server_.events(), sequence_, pair, kind, reason, episode, shard); }
    write_shard(shard);
    const std::lock_guard lock(server_.mutex);
    server_.status->last_event_sequence = sequence_;
    server_.status->contact_count = static_cast<std::uint32_t>(contacts_.size());
    server_.status->contact_hash = 0;
    for (const auto& [held, began] : contacts_) {
      server_.status->contact_hash += wire_contract::contact_hash(held.first, held.second, began);
    }
  }

  void write_frame(dds::Writer<wire::EventFrame>& writer, std::uint64_t sequence, Pair pair, std::uint8_t kind,
                   std::uint8_t reason, std::uint64_t episode, std::uint8_t shard) {
    dds::Sample<wire::EventFrame> frame;
    frame->server = server_.number();
    frame->epoch = 100 + server_.number();
    frame->first_sequence = sequence;
    frame->world_time_ns = static_cast<std::int64_t>(sequence_) * 1'000;
    const std::vector<std::uint8_t> kinds{kind}, reasons{reason}, doubts{0}, shards{shard};
    const std::vector<std::uint64_t> a{pair.first}, b{pair.second}, episodes{episode}, ids{pair.first, pair.second};
    const std::vector<std::uint32_t> a_triangles{5}, b_triangles{wire_contract::kNoTriangle};
    const std::vector<double> numbers{1, 2, 3, 0, 0, 1, 0.25, 1e-9, 0, 1, 0, 0.5, 1e-9, -0.01, -0.005, 7, 8, 9, 0};
    const std::vector<std::uint8_t> packed = names(ids);
    dds::borrow(frame->kinds, kinds);
    dds::borrow(frame->reasons, reasons);
    dds::borrow(frame->doubts, doubts);
    dds::borrow(frame->shards, shards);
    dds::borrow(frame->a, a);
    dds::borrow(frame->b, b);
    dds::borrow(frame->a_triangles, a_triangles);
    dds::borrow(frame->b_triangles, b_triangles);
    dds::borrow(frame->episodes, episodes);
    test::put_rows<wire::EventFrame>(*frame, wire::kEventColumns, numbers);
    dds::borrow(frame->named_ids, ids);
    dds::borrow(frame->names, packed);
    ASSERT_TRUE(writer.write(*frame));
  }

  void write_shard(std::uint8_t number) {
    std::vector<std::uint64_t> a, b, episodes, ids;
    std::vector<std::int64_t> began;
    for (const auto& [pair, episode] : contacts_) {
      if (wire_contract::contact_shard(pair.first, pair.second) == number) {
        a.push_back(pair.first);
        b.push_back(pair.second);
        episodes.push_back(episode);
        began.push_back(kFirstBegan.count() + static_cast<std::int64_t>(episode - 1) * 1'000);
        ids.insert(ids.end(), {pair.first, pair.second});
      }
    }
    const std::vector<std::uint32_t> triangles(a.size(), wire_contract::kNoTriangle);
    const std::vector<double> numbers(a.size() * wire::width_of<wire::ContactShard>(wire::kContactColumns), 0.5);
    const std::vector<std::uint8_t> packed = names(ids);
    dds::Sample<wire::ContactShard> shard;
    shard->server = server_.number();
    shard->epoch = 100 + server_.number();
    shard->shard = number;
    shard->as_of_sequence = sequence_;
    const std::vector<std::uint8_t> doubts(a.size(), 0);
    dds::borrow(shard->doubts, doubts);
    dds::borrow(shard->a, a);
    dds::borrow(shard->b, b);
    dds::borrow(shard->a_triangles, triangles);
    dds::borrow(shard->b_triangles, triangles);
    dds::borrow(shard->episodes, episodes);
    dds::borrow(shard->began_ns, began);
    test::put_rows<wire::ContactShard>(*shard, wire::kContactColumns, numbers);
    dds::borrow(shard->named_ids, ids);
    dds::borrow(shard->names, packed);
    ASSERT_TRUE(server_.contacts().write(*shard));
  }

  FakeServer& server_;
  std::map<Pair, std::uint64_t> contacts_;
  std::uint64_t sequence_ = 0;
};

class ClientWatch : public testing::Test {
 protected:
  void SetUp() override {
    Result<Client> connected =
        Client::connect({.domain = test::own_domain(), .name_space = test::own_namespace(), .wait = 5s});
    ASSERT_TRUE(connected) << connected.error().message;
    client_.emplace(std::move(*connected));
  }
  /// A watch that hears what is told from here on: a writer that has yet to learn of it sends it nothing, and what it
  /// then takes from the state of contacts counts as missed.
  Watch watch(const WatchOptions& options = {}) {
    const auto readers = [&] {
      return std::tuple(server_.events().matched_readers(), server_.contacts().matched_readers(),
                        server_.persisted().matched_readers());
    };
    const auto before = readers();
    Result<Watch> watch = client_->watch(options);
    EXPECT_TRUE(watch) << watch.error().message;
    EXPECT_TRUE(eventually([&] {
      const auto [events, contacts, persisted] = readers();
      return events > std::get<0>(before) && contacts > std::get<1>(before) &&
             (!options.persisted || persisted > std::get<2>(before));
    })) << "the server has not found the watch";
    return std::move(*watch);
  }
  /// Until a status has told of what was published: a watch that begins on an older one starts from that one's state,
  /// and what came since counts as new, as it should.
  void let_the_past_pass() {
    for (int i = 0; i < 300; ++i) {
      const Result<ServerStatus> status = client_->status();
      if (status && status->last_event_sequence == world_.sequence()) return;
      std::this_thread::sleep_for(10ms);
    }
    FAIL() << "no status told of event " << world_.sequence();
  }
  static Event next(Watch& watch) {
    const std::optional<Event> event = watch.next(3s);
    EXPECT_TRUE(event.has_value()) << "no event came";
    return event.value_or(Event{});
  }
  FakeServer server_{test::own_namespace()};
  EventTeller world_{server_};
  std::optional<Client> client_;
};

TEST_F(ClientWatch, OpensWhatHoldsThenFollows) {
  world_.began({1, 2});
  world_.began({3, 4});
  let_the_past_pass();
  Watch watch = this->watch();
  const Event first = next(watch);
  EXPECT_EQ(first.kind, EventKind::open);
  EXPECT_EQ(first.a, "object_1");
  EXPECT_EQ(first.b, "object_2");
  EXPECT_EQ(first.began, kFirstBegan);
  EXPECT_EQ(next(watch).kind, EventKind::open);
  EXPECT_EQ(watch.open_contacts(), 2u);
  world_.began({5, 6});
  const Event began = next(watch);
  EXPECT_EQ(began.kind, EventKind::began);
  EXPECT_FALSE(began.resync);
  EXPECT_EQ(began.a, "object_5");
  EXPECT_EQ(began.a_id, 5u);
  EXPECT_EQ(began.sequence, 3u);
  EXPECT_EQ(began.episode, 3u);
  EXPECT_EQ(began.epoch, 101u);
  EXPECT_EQ(began.a_triangle, 5u);
  EXPECT_EQ(began.b_triangle, kNoTriangle);
  EXPECT_EQ(began.point, Vec3(1, 2, 3));
  EXPECT_EQ(began.normal, Vec3(0, 0, 1));
  EXPECT_EQ(began.depth_m, 0.25);
  EXPECT_EQ(began.depth_error_m, 1e-9);
  EXPECT_EQ(began.bracket_low_s, -0.01);
  EXPECT_EQ(began.bracket_high_s, -0.005);
  EXPECT_EQ(began.relative_velocity, Vec3(7, 8, 9));
  world_.ended({1, 2}, 2);
  const Event ended = next(watch);
  EXPECT_EQ(ended.kind, EventKind::ended);
  EXPECT_EQ(ended.reason, EndReason::removed);
  EXPECT_EQ(ended.began, kFirstBegan);
  EXPECT_EQ(ended.world_time, 4'000ns);
  EXPECT_EQ(watch.open_contacts(), 2u);
  EXPECT_TRUE(watch.connected());
  EXPECT_FALSE(watch.next(50ms));
}

TEST_F(ClientWatch, TenThousandEventsComeOnceAndInOrder) {
  Watch watch = this->watch();
  ASSERT_TRUE(eventually([&] { return watch.in_step(); }));
  for (std::uint64_t i = 0; i < 5'000; ++i) {
    world_.began({i, i + 1});
    world_.ended({i, i + 1});
  }
  for (std::uint64_t sequence = 1; sequence <= 10'000; ++sequence) {
    const Event event = next(watch);
    ASSERT_EQ(event.sequence, sequence);
    ASSERT_FALSE(event.resync);
  }
  EXPECT_EQ(watch.resyncs(), 0u);
  EXPECT_EQ(watch.lost(), 0u);
  EXPECT_EQ(watch.open_contacts(), 0u);
}

TEST_F(ClientWatch, PersistedComesToWhoAsks) {
  Watch plain = watch();
  Watch curious = watch({.persisted = true});
  ASSERT_TRUE(eventually([&] { return plain.in_step() && curious.in_step(); }));
  world_.began({1, 2});
  EXPECT_EQ(next(curious).kind, EventKind::began);
  EXPECT_EQ(next(plain).kind, EventKind::began);
  std::optional<Event> event;
  ASSERT_TRUE(eventually([&] {
    world_.persisted({1, 2});
    return (event = curious.next(10ms)).has_value();
  }));
  EXPECT_EQ(event->kind, EventKind::persisted);
  EXPECT_EQ(event->began, kFirstBegan);
  EXPECT_FALSE(plain.next(10ms));
}

TEST_F(ClientWatch, LostFrameIsMadeUpForByTheContactState) {
  Watch watch = this->watch();
  ASSERT_TRUE(eventually([&] { return watch.in_step(); }));
  world_.began({1, 2});
  world_.began({3, 4}, true);
  world_.began({5, 6});
  EXPECT_EQ(next(watch).a, "object_1");
  EXPECT_EQ(next(watch).a, "object_5");
  const Event missed = next(watch);
  EXPECT_EQ(missed.a, "object_3");
  EXPECT_TRUE(missed.resync);
  EXPECT_EQ(watch.resyncs(), 1u);
  EXPECT_EQ(watch.open_contacts(), 3u);
}

TEST_F(ClientWatch, CutOffWatchCatchesUp) {
  Watch watch = this->watch();
  ASSERT_TRUE(eventually([&] { return watch.in_step(); }));
  world_.began({1, 2});
  EXPECT_EQ(next(watch).a, "object_1");
  server_.participant().set_deaf_mute(true, true, 600'000'000);
  EXPECT_TRUE(eventually([&] { return !watch.connected(); }));
  world_.ended({1, 2});
  world_.began({3, 4});
  std::set<std::string> told;
  for (int i = 0; i < 2; ++i) {
    const Event event = next(watch);
    told.insert((event.kind == EventKind::ended ? "ended " : "began ") + event.a);
  }
  EXPECT_EQ(told, (std::set<std::string>{"ended object_1", "began object_3"}));
  EXPECT_TRUE(eventually([&] { return watch.connected(); }));
}

TEST_F(ClientWatch, RestartedServerEndsWhatItNoLongerHolds) {
  Watch watch = this->watch();
  ASSERT_TRUE(eventually([&] { return watch.in_step(); }));
  world_.began({1, 2});
  world_.began({3, 4});
  EXPECT_EQ(next(watch).kind, EventKind::began);
  EXPECT_EQ(next(watch).kind, EventKind::began);
  server_.beating = false;
  ASSERT_TRUE(eventually([&] { return !watch.connected(); }));
  FakeServer second(
      test::own_namespace(), 2,
      {.domain = test::own_domain(), .role = dds::Role::server, .process_domain = test::own_domain() + 200'000}, false);
  EventTeller anew(second);
  anew.began({3, 4});  // before its first status, which says what holds
  second.beating = true;
  const Event ended = next(watch);
  EXPECT_EQ(ended.kind, EventKind::ended);
  EXPECT_EQ(ended.reason, EndReason::server_restarted);
  EXPECT_TRUE(ended.resync);
  EXPECT_EQ(ended.a, "object_1");
  EXPECT_EQ(ended.epoch, 102u);
  EXPECT_EQ(watch.open_contacts(), 1u);
  EXPECT_FALSE(watch.next(50ms));
}

// Forged frames and statuses were believed: of ten events that were none was seen.
TEST_F(ClientWatch, WhatAnotherSaysInTheServersPlaceIsNotHeardWhileTheServerIs) {
  Watch watch = this->watch();
  ASSERT_TRUE(eventually([&] { return watch.in_step(); }));
  world_.began({1, 2});
  EXPECT_EQ(next(watch).kind, EventKind::began);
  const std::uint64_t epoch = client_->status()->epoch;
  FakeServer stranger(
      test::own_namespace(), 1,
      {.domain = test::own_domain(), .role = dds::Role::server, .process_domain = test::own_domain() + 200'000});
  {
    const std::lock_guard lock(stranger.mutex);
    stranger.status->epoch = epoch + 1'000;
  }
  ASSERT_TRUE(eventually([&] { return stranger.events().matched_readers() > 0; }));
  EventTeller forged(stranger);
  for (std::uint64_t i = 10; i < 20; ++i) forged.began({i, i + 1});
  EXPECT_FALSE(watch.next(300ms));
  EXPECT_EQ(client_->status()->epoch, epoch);
  world_.ended({1, 2});
  const Event ended = next(watch);
  EXPECT_EQ(ended.kind, EventKind::ended);
  EXPECT_EQ(ended.a, "object_1");
  EXPECT_EQ(watch.open_contacts(), 0U);
}

TEST_F(ClientWatch, FiltersChooseByEitherName) {
  Watch watch = this->watch({.only = "object_[13]", .skip = "object_4"});
  ASSERT_TRUE(eventually([&] { return watch.in_step(); }));
  world_.began({1, 2});
  world_.began({3, 4});
  world_.began({5, 6});
  world_.began({2, 3});
  EXPECT_EQ(next(watch).a, "object_1");
  EXPECT_EQ(next(watch).b, "object_3");
  EXPECT_EQ(watch.open_contacts(), 2u);
  EXPECT_FALSE(watch.next(20ms));
}

TEST_F(ClientWatch, FullQueueDropsTheOldestAndCounts) {
  Watch watch = this->watch({.capacity = 4});
  ASSERT_TRUE(eventually([&] { return watch.in_step(); }));
  for (std::uint64_t i = 0; i < 10; ++i) { world_.began({i, i + 1}); }
  ASSERT_TRUE(eventually([&] { return watch.lost() == 6; }));
  EXPECT_EQ(next(watch).a, "object_6");
}

TEST_F(ClientWatch, CallbackIsCalledUntilTheWatchGoes) {
  std::atomic<int> count{0};
  {
    const Result<Watch> watch = client_->watch({}, [&](const Event&) { ++count; });
    ASSERT_TRUE(watch) << watch.error().message;
    ASSERT_TRUE(eventually([&] { return watch->in_step(); }));
    world_.began({1, 2});
    ASSERT_TRUE(eventually([&] { return count == 1; }));
  }
  world_.ended({1, 2});
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(count, 1);
}

}  // namespace
}  // namespace collided
