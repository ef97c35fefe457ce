// Which server may take another one's place, and when that one stops looking for somebody.
#include "server/fleet/succession.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace collided::engine::service {
namespace {

using wire_contract::MemberRole;
using wire_contract::ServerState;

constexpr std::uint64_t kOwnServer = 1;
constexpr std::uint64_t kNorth = 2;
constexpr std::uint64_t kOwnEpoch = 10;

class SuccessionTest : public ::testing::Test {
 protected:
  static OtherMember other(MemberRole role, std::uint64_t epoch) {
    OtherMember member;
    member.server = kNorth;
    member.epoch = epoch;
    member.role = role;
    member.state = ServerState::ready;
    member.name = "north";
    member.following.primary = kOwnServer;
    return member;
  }

  std::atomic<bool> takes_questions_{true};
  int ends_ = 0;
  Succession succession_{{.on_world_thread = [](const std::function<void()>& job) { job(); },
                          .speak = {},
                          .fall_silent = [] {},
                          .say_last_words = {},
                          .has_come_as_far = {},
                          .lend_place = {},
                          .take_place_back = {},
                          .answer_held_questions = {},
                          .takes_questions = takes_questions_,
                          .self = kOwnServer,
                          .epoch = [] { return kOwnEpoch; },
                          .joins = true,
                          .notice = [](const std::string&) {},
                          .became_primary = {},
                          .end = [this] { ++ends_; }},
                         MemberRole::primary};
};

TEST_F(SuccessionTest, AReadyStandbyMayTakeThePlace) {
  EXPECT_FALSE(succession_.heir(""));
  succession_.hear(other(MemberRole::standby, kOwnEpoch + 1));
  ASSERT_TRUE(succession_.heir(""));
  EXPECT_EQ(succession_.heir("north")->server, kNorth);
  EXPECT_FALSE(succession_.heir("south"));
}

// What the standby said before it took the place may be heard only then, by a server that was stopped: it is no heir any
// more, and the end need not wait for it.
TEST_F(SuccessionTest, WhosePlaceIsTakenHasNoHeir) {
  succession_.hear(other(MemberRole::standby, kOwnEpoch + 1));
  succession_.hear(other(MemberRole::primary, kOwnEpoch + 1));
  EXPECT_EQ(ends_, 1);
  EXPECT_TRUE(succession_.has_given_way());
  EXPECT_FALSE(takes_questions_.load());
  EXPECT_FALSE(succession_.heir(""));
  EXPECT_FALSE(succession_.heir("north"));
}

// Of two that have joined at once the later one ends; it was no primary for anybody, and hands nothing over.
TEST_F(SuccessionTest, WhoJoinedLaterHasNoHeir) {
  constexpr std::uint64_t kSouth = 3;
  OtherMember standby = other(MemberRole::standby, kOwnEpoch + 1);
  standby.server = kSouth;
  succession_.hear(standby);
  OtherMember earlier = other(MemberRole::primary, kOwnEpoch - 1);
  earlier.following.primary = 0;
  succession_.hear(earlier);
  EXPECT_TRUE(succession_.has_given_way());
  EXPECT_FALSE(succession_.heir(""));
}

}  // namespace
}  // namespace collided::engine::service
