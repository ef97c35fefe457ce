// What a watch reports of who lies within a solid, also where it missed some of it.
#include <gtest/gtest.h>

#include "client/library/watching/watch_state.hpp"
#include "tests/service/wire/watch_model.hpp"
#include "tests/service/wire/watch_state_fixture.hpp"

namespace collided {
namespace {

TEST_F(WatchStateTest, WhatComesToLieWithinIsToldAsItWasSaid) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  hear(server.contained({1, 2}, Containment::b_in_a));
  EXPECT_EQ(events_.back().contained, Containment::b_in_a);
  state_.hear_persisted(server.persisted({1, 2}));
  EXPECT_EQ(events_.back().contained, Containment::b_in_a);
  hear(server.emerged({1, 2}));
  EXPECT_EQ(events_.back().contained, Containment::b_in_a) << "who it was";
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), (Lines{"began 1 2", "contained 1 2", "persisted 1 2", "emerged 1 2", "ended 1 2"}));
  hear(server.bookmark());
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(state_.resyncs(), 0u);
}

TEST_F(WatchStateTest, ALateWatchOpensWithWhatLiesWithin) {
  Model server(1);
  server.began({1, 2});
  server.contained({1, 2}, Containment::a_in_b);
  for (std::uint32_t shard = 0; shard < wire_contract::kContactShards; ++shard)
    hear(server.shard(static_cast<std::uint8_t>(shard)));
  hear(server.bookmark());
  EXPECT_EQ(told(), Lines{"open 1 2 resync"});
  EXPECT_EQ(events_.back().contained, Containment::a_in_b);
  hear(server.emerged({1, 2}));
  EXPECT_EQ(told(), Lines{"emerged 1 2"});
}

TEST_F(WatchStateTest, AMissedChangeIsMadeUpForFromTheState) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  server.contained({1, 2}, Containment::b_in_a);  // lost
  hear(server.began({3, 4}));
  hear(server.shard({1, 2}));
  hear(server.bookmark());
  EXPECT_EQ(told(), (Lines{"began 1 2", "began 3 4", "contained 1 2 resync"}));
  server.emerged({1, 2});  // lost
  server.ended({1, 2});    // lost
  hear(server.began({5, 6}));
  hear(server.shard({1, 2}));
  hear(server.bookmark());
  EXPECT_EQ(told(), (Lines{"began 5 6", "emerged 1 2 resync", "ended 1 2 resync"}));
}

TEST_F(WatchStateTest, AChangeOfAContactWhoseBeginningWasMissedBeginsItFirst) {
  Model server(1);
  hear(server.bookmark());
  server.began({1, 2});                           // lost
  server.contained({1, 2}, Containment::a_in_b);  // lost
  hear(server.emerged({1, 2}));
  EXPECT_EQ(told(), (Lines{"began 1 2 resync", "contained 1 2 resync", "emerged 1 2"}));
}

TEST_F(WatchStateTest, ANewServerWithWhichItStillLiesWithinTellsNothingAnew) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  hear(server.contained({1, 2}, Containment::b_in_a));
  told();
  Model next(2);
  // Its `began` says how it was found, and `contained` repeats it.
  HeardFrame began = next.began({1, 2});
  began.entries.front().event.contained = Containment::b_in_a;
  hear(began);
  hear(next.contained({1, 2}, Containment::b_in_a));
  EXPECT_EQ(told(), Lines{});
  hear(next.emerged({1, 2}));
  EXPECT_EQ(told(), Lines{"emerged 1 2"});
}

TEST_F(WatchStateTest, ANewServerWithWhichItNoLongerLiesWithinTellsThatItEmerged) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  hear(server.contained({1, 2}, Containment::b_in_a));
  told();
  Model next(2);
  hear(next.began({1, 2}));
  EXPECT_EQ(told(), Lines{"emerged 1 2 resync"});
}

}  // namespace
}  // namespace collided
