// Messages about standing questions that are not what they should be.
#include <gtest/gtest.h>

#include <cstdint>

#include "client/library/watching/watch_decoding.hpp"
#include "tests/service/wire/standing_messages.hpp"

namespace collided {
namespace {

TEST(StandingDecoding, AFrameWhoseColumnsDifferOrWithAnUnknownCodeIsRefused) {
  const test::StandingServer server;
  client::Names names;
  const auto good = [&] {
    return server.frame(
        1, 1,
        {{.kind = StandingEventKind::enter, .standing = test::standing_id(1), .object = 1, .episode = 1},
         {.kind = StandingEventKind::changed, .standing = test::standing_id(2), .object = 2}});
  };
  const auto is_taken = [&](auto spoil) {
    auto frame = good();
    spoil(frame.columns);
    return client::decode(frame.message(), names).has_value();
  };
  using Columns = wire::StandingFrameColumns;
  EXPECT_TRUE(is_taken([](Columns&) {}));
  std::size_t number = 0;
  Columns::for_each([&](auto, auto column, std::uint32_t width) {
    if (width == 0) return;
    EXPECT_FALSE(is_taken([&](Columns& c) { (c.*column).pop_back(); })) << "column " << number;
    EXPECT_FALSE(is_taken([&](Columns& c) { (c.*column).push_back({}); })) << "column " << number;
    ++number;
  });
  EXPECT_FALSE(is_taken([](Columns& c) { c.kinds[0] = codes::kCodeCount<StandingEventKind>; }));
  EXPECT_FALSE(is_taken([](Columns& c) { c.forms[0] = codes::kCodeCount<StandingForm>; }));
  EXPECT_FALSE(is_taken([](Columns& c) { c.reasons[0] = codes::kCodeCount<EndReason>; }));
  for (const StandingEventKind kind : {StandingEventKind::inside, StandingEventKind::within, StandingEventKind::is})
    EXPECT_FALSE(is_taken([&](Columns& c) { c.kinds[0] = static_cast<std::uint8_t>(kind); })) << name_of(kind);
  EXPECT_FALSE(is_taken([](Columns& c) { c.objects[0] = 0; })) << "no object came in";
  EXPECT_FALSE(is_taken([](Columns& c) { c.objects[1] = 0; })) << "from none to none";
  EXPECT_TRUE(is_taken([](Columns& c) { c.doubts[0] = 9; })) << "a doubt that came later";
}

TEST(StandingDecoding, AShardWhoseColumnsDifferOrWithAnUnknownCodeIsRefused) {
  const test::StandingServer server;
  client::Names names;
  const auto is_taken = [&](auto spoil) {
    auto shard = server.shard(1, 3, 1, {{.standing = test::standing_id(1), .object = 1, .episode = 1}});
    spoil(shard.columns);
    return client::decode(shard.message(), names).has_value();
  };
  using Columns = wire::StandingShardColumns;
  EXPECT_TRUE(is_taken([](Columns&) {}));
  std::size_t number = 0;
  Columns::for_each([&](auto, auto column, std::uint32_t width) {
    if (width == 0) return;
    EXPECT_FALSE(is_taken([&](Columns& c) { (c.*column).pop_back(); })) << "column " << number;
    ++number;
  });
  EXPECT_FALSE(is_taken([](Columns& c) { c.forms[0] = codes::kCodeCount<StandingForm>; }));
}

TEST(StandingDecoding, TheSumIsABookmarkAndNoOtherShardIsOne) {
  const test::StandingServer server{.server = 7, .epoch = 8};
  const test::StandingStay stay{.standing = test::standing_id(1), .object = 1, .episode = 5};
  auto sum = server.sum(9, 6, {stay});
  const auto bookmark = client::bookmark_in(sum.message());
  ASSERT_TRUE(bookmark);
  EXPECT_EQ(bookmark->from, (client::ServerLife{7, 8}));
  EXPECT_EQ(bookmark->last_event_sequence, 6U);
  EXPECT_EQ(bookmark->contact_count, 1U);
  EXPECT_EQ(bookmark->contact_hash, wire_contract::contact_hash(1, test::standing_id(1), 5));
  EXPECT_EQ(bookmark->world_time.count(), 9);
  EXPECT_TRUE(bookmark->settled);
  sum.sample->state = static_cast<std::uint8_t>(wire_contract::ServerState::recovering);
  EXPECT_FALSE(client::bookmark_in(sum.message())->settled);
  auto shard = server.shard(9, 3, 6, {stay});
  EXPECT_FALSE(client::bookmark_in(shard.message()));
}

}  // namespace
}  // namespace collided
