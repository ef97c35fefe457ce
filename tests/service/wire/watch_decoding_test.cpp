// Events, contact shards and bookmarks as they come over the wire, field by field.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numeric>

#include "client/library/asking/answer_decoding.hpp"
#include "client/library/watching/probes.hpp"
#include "client/library/watching/watch_decoding.hpp"
#include "idl/instant.hpp"
#include "idl/topics.hpp"
#include "tests/service/wire/decoding_messages.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided {
namespace {

TEST(WatchDecoding, ADoubtHasItsReason) {
  Names names;
  for (const Doubt why : {Doubt::numeric, Doubt::cost_limit, Doubt::publisher_lost}) {
    FrameMessage frame;
    frame.doubts[0] = static_cast<std::uint8_t>(why);
    const auto heard = client::decode(frame.message(), names);
    ASSERT_TRUE(heard);
    EXPECT_EQ(heard->entries[0].event.doubt, why);
    EXPECT_EQ(heard->entries[1].event.doubt, Doubt::none);
  }
  FrameMessage frame;
  frame.doubts[0] = static_cast<std::uint8_t>(Doubt::cost_limit) | wire_contract::kDoubtPosesMerged;
  const Event merged = client::decode(frame.message(), names)->entries[0].event;
  EXPECT_TRUE(merged.poses_merged && merged.doubt == Doubt::cost_limit);
  EXPECT_FALSE(client::decode(frame.message(), names)->entries[1].event.poses_merged);
  frame.doubts[0] = 9;
  EXPECT_EQ(client::decode(frame.message(), names)->entries[0].event.doubt, Doubt::numeric) << "one that came later";
}

TEST(WatchDecoding, EveryFieldOfAnEventIsItsOwn) {
  Names names;
  FrameMessage frame;
  const auto heard = client::decode(frame.message(), names);
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->from.server, 80u);
  EXPECT_EQ(heard->from.epoch, 81u);
  EXPECT_EQ(heard->first_sequence, 82u);
  ASSERT_EQ(heard->entries.size(), 3u);
  const EventKind whats[] = {EventKind::began, EventKind::persisted, EventKind::ended};
  const EndReason whys[] = {EndReason::none, EndReason::none, EndReason::server_restarted};
  const char* a_names[] = {"one", "#2", "#3"};
  const char* b_names[] = {"#4", "five", "#6"};
  for (std::size_t i = 0; i < 3; ++i) {
    const Event& event = heard->entries[i].event;
    const double first = 100 + 19 * static_cast<double>(i);
    EXPECT_EQ(heard->entries[i].shard, 40 + i);
    EXPECT_EQ(event.kind, whats[i]);
    EXPECT_EQ(event.reason, whys[i]);
    EXPECT_FALSE(event.resync);
    EXPECT_EQ(event.a, a_names[i]);
    EXPECT_EQ(event.b, b_names[i]);
    EXPECT_EQ(event.a_id, 1 + i);
    EXPECT_EQ(event.b_id, 4 + i);
    EXPECT_EQ(event.a_triangle, frame.a_triangles[i]);
    EXPECT_EQ(event.b_triangle, frame.b_triangles[i]);
    EXPECT_EQ(event.epoch, 81u);
    EXPECT_EQ(event.episode, 50 + i);
    EXPECT_EQ(event.world_time, nanoseconds(84));
    EXPECT_EQ(event.point, three(first));
    EXPECT_EQ(event.normal, three(first + 3));
    EXPECT_EQ(event.depth_m, first + 6);
    EXPECT_EQ(event.depth_error_m, first + 7);
    EXPECT_EQ(event.surface_normal, three(first + 8));
    EXPECT_EQ(event.surface_depth_m, first + 11);
    EXPECT_EQ(event.surface_depth_error_m, first + 12);
    EXPECT_EQ(event.bracket_low_s, first + 13);
    EXPECT_EQ(event.bracket_high_s, first + 14);
    EXPECT_EQ(event.relative_velocity, three(first + 15));
    EXPECT_EQ(event.velocity_error, first + 18);
  }
}

TEST(WatchDecoding, AFrameWhoseListsDifferIsRefused) {
  const std::vector<std::pair<const char*, std::function<void(FrameMessage&)>>> spoilers{
      {"kinds", [](FrameMessage& f) { f.kinds.pop_back(); }},
      {"reasons", [](FrameMessage& f) { f.reasons.pop_back(); }},
      {"doubts", [](FrameMessage& f) { f.doubts.pop_back(); }},
      {"shards", [](FrameMessage& f) { f.shards.pop_back(); }},
      {"a", [](FrameMessage& f) { f.a.pop_back(); }},
      {"b", [](FrameMessage& f) { f.b.pop_back(); }},
      {"a triangles", [](FrameMessage& f) { f.a_triangles.pop_back(); }},
      {"b triangles", [](FrameMessage& f) { f.b_triangles.pop_back(); }},
      {"episodes", [](FrameMessage& f) { f.episodes.pop_back(); }},
      {"numbers", [](FrameMessage& f) { f.numbers.pop_back(); }},
      {"an unknown kind", [](FrameMessage& f) { f.kinds[1] = 5; }},
      {"an unknown reason", [](FrameMessage& f) { f.reasons[1] = 12; }},
  };
  for (const auto& [what, spoil] : spoilers) {
    Names names;
    FrameMessage bad;
    spoil(bad);
    EXPECT_FALSE(client::decode(bad.message(), names)) << what;
  }
}

TEST(WatchDecoding, EveryFieldOfAContactIsItsOwn) {
  Names names;
  ShardMessage shard;
  const auto heard = client::decode(shard.message(), names);
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->from.server, 80u);
  EXPECT_EQ(heard->from.epoch, 82u);
  EXPECT_EQ(heard->shard, 81);
  EXPECT_EQ(heard->as_of_sequence, 84u);
  ASSERT_EQ(heard->contacts.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Event& contact = heard->contacts[i];
    const double first = 100 + 13 * static_cast<double>(i);
    EXPECT_EQ(contact.kind, EventKind::open);
    EXPECT_EQ(contact.a, i == 0 ? "#1" : "two");
    EXPECT_EQ(contact.b, i == 0 ? "#4" : "#5");
    EXPECT_EQ(contact.a_id, 1 + i);
    EXPECT_EQ(contact.b_id, 4 + i);
    EXPECT_EQ(contact.a_triangle, shard.a_triangles[i]);
    EXPECT_EQ(contact.b_triangle, shard.b_triangles[i]);
    EXPECT_EQ(contact.epoch, 82u);
    EXPECT_EQ(contact.episode, 50 + i);
    EXPECT_EQ(contact.began, nanoseconds(90 + i));
    EXPECT_EQ(contact.world_time, nanoseconds(90 + i));
    EXPECT_EQ(contact.point, three(first));
    EXPECT_EQ(contact.normal, three(first + 3));
    EXPECT_EQ(contact.depth_m, first + 6);
    EXPECT_EQ(contact.depth_error_m, first + 7);
    EXPECT_EQ(contact.surface_normal, three(first + 8));
    EXPECT_EQ(contact.surface_depth_m, first + 11);
    EXPECT_EQ(contact.surface_depth_error_m, first + 12);
    EXPECT_EQ(contact.doubt, i == 0 ? Doubt::none : Doubt::cost_limit);
  }
}

TEST(WatchDecoding, AShardWhoseListsDifferIsRefused) {
  const std::vector<std::pair<const char*, std::function<void(ShardMessage&)>>> spoilers{
      {"a", [](ShardMessage& s) { s.a.pop_back(); }},
      {"b", [](ShardMessage& s) { s.b.pop_back(); }},
      {"a triangles", [](ShardMessage& s) { s.a_triangles.pop_back(); }},
      {"b triangles", [](ShardMessage& s) { s.b_triangles.pop_back(); }},
      {"episodes", [](ShardMessage& s) { s.episodes.pop_back(); }},
      {"doubts", [](ShardMessage& s) { s.doubts.pop_back(); }},
      {"began", [](ShardMessage& s) { s.began_ns.pop_back(); }},
      {"numbers", [](ShardMessage& s) { s.numbers.pop_back(); }},
  };
  for (const auto& [what, spoil] : spoilers) {
    Names names;
    ShardMessage bad;
    spoil(bad);
    EXPECT_FALSE(client::decode(bad.message(), names)) << what;
  }
}

TEST(WatchDecoding, ABookmarkIsThatOfItsStatus) {
  wire::Status status{};
  status.server = 1;
  status.epoch = 2;
  status.world_time_ns = 3;
  status.last_event_sequence = 4;
  status.contact_count = 5;
  status.contact_hash = 6;
  const auto settled = [&](wire_contract::ServerState state) {
    status.state = static_cast<std::uint8_t>(state);
    return client::decode(status).settled;
  };
  EXPECT_FALSE(settled(wire_contract::ServerState::starting));
  EXPECT_FALSE(settled(wire_contract::ServerState::recovering));
  EXPECT_TRUE(settled(wire_contract::ServerState::ready));
  EXPECT_TRUE(settled(wire_contract::ServerState::stopping));
  status.settled_ns = 7;
  status.heir_of = 8;
  status.told_from = 9;
  const client::HeardBookmark bookmark = client::decode(status);
  EXPECT_EQ(bookmark.from.server, 1u);
  EXPECT_EQ(bookmark.from.epoch, 2u);
  EXPECT_EQ(bookmark.world_time, nanoseconds(3));
  EXPECT_EQ(bookmark.last_event_sequence, 4u);
  EXPECT_EQ(bookmark.contact_count, 5u);
  EXPECT_EQ(bookmark.contact_hash, 6u);
  EXPECT_EQ(bookmark.settled_to, nanoseconds(7));
  EXPECT_EQ(bookmark.heir_of, 8u);
  EXPECT_EQ(bookmark.told_from, 9u);
}

}  // namespace
}  // namespace collided
