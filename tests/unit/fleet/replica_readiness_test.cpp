// A replica answers while its world was found the primary's a moment ago, and not before that is known anew after a doubt.
#include <gtest/gtest.h>

#include "server/fleet/replica_readiness.hpp"

namespace collided::engine::service {
namespace {

class Readiness : public testing::Test {
 protected:
  const WorldClock clock;
  ReplicaReadiness readiness{clock};
};

TEST_F(Readiness, OpensOnceTheWorldsAreTheSameAndTheWorldTurns) {
  readiness.note_turn();
  EXPECT_FALSE(readiness.is_open());
  readiness.note_compared(5, true);
  EXPECT_TRUE(readiness.is_open());
  EXPECT_EQ(readiness.whole_since_ns(), 5);
  readiness.note_compared(6, true);
  EXPECT_EQ(readiness.whole_since_ns(), 5);
}

TEST_F(Readiness, AWorldThatHasNotTurnedIsNotOpen) {
  readiness.note_compared(5, true);
  EXPECT_FALSE(readiness.is_open());
}

// What was known before the doubt says nothing, even where it is heard later.
TEST_F(Readiness, AfterADoubtOnlyALaterInstantCounts) {
  readiness.note_turn();
  const std::int64_t before_ns = clock.now_ns();
  readiness.note_compared(before_ns, true);
  readiness.doubt();
  EXPECT_FALSE(readiness.is_open());
  readiness.note_compared(before_ns, true);
  EXPECT_FALSE(readiness.is_open());
  const std::int64_t after_ns = clock.now_ns() + 1;
  readiness.note_compared(after_ns, true);
  EXPECT_TRUE(readiness.is_open());
  EXPECT_EQ(readiness.whole_since_ns(), after_ns);
}

TEST_F(Readiness, ADifferenceCloses) {
  readiness.note_turn();
  readiness.note_compared(5, true);
  readiness.note_compared(6, false);
  EXPECT_FALSE(readiness.is_open());
}

}  // namespace
}  // namespace collided::engine::service
