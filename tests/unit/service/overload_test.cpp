#include "server/service/questions/overload.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace collided::engine::service {
namespace {

using Stage = Overload::Stage;

// Details first, then questions of the low class; each is said, and taken back one by one once it has been calm.
TEST(Overload, LeavesOutInOrderAndSaysSo) {
  std::vector<std::string> said;
  Overload overload([&](const std::string& sentence) { said.push_back(sentence); });
  overload.note(false, false);
  EXPECT_EQ(overload.stage(), Stage::none);
  overload.note(true, false);
  EXPECT_TRUE(overload.leaves_out_details());
  EXPECT_FALSE(overload.refuses_low_questions());
  overload.note(false, true);
  EXPECT_TRUE(overload.refuses_low_questions());
  ASSERT_EQ(said.size(), 2U);
  EXPECT_NE(said[0].find("more poses come"), std::string::npos) << said[0];
  EXPECT_NE(said[1].find("questions of the low class are refused"), std::string::npos) << said[1];
  overload.note(true, true);
  EXPECT_EQ(said.size(), 2U) << "the same again is not news";
  for (int i = 0; i < Overload::kCalmTicks; ++i) overload.note(false, false);
  EXPECT_EQ(overload.stage(), Stage::details);
  overload.note(false, true);
  EXPECT_EQ(overload.stage(), Stage::low_questions);
  for (int i = 0; i < 2 * Overload::kCalmTicks; ++i) overload.note(false, false);
  EXPECT_EQ(overload.stage(), Stage::none);
  EXPECT_NE(said.back().find("no longer overloaded"), std::string::npos);
}

// Calm is so many ticks in a row: one with too much in between begins the count again.
TEST(Overload, IsTakenBackOnlyAfterCalmWithoutABreak) {
  Overload overload([](const std::string&) {});
  for (int i = 0; i < 2; ++i) overload.note(true, false);
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i + 1 < Overload::kCalmTicks; ++i) overload.note(false, false);
    EXPECT_EQ(overload.stage(), Stage::low_questions) << round;
    overload.note(round % 2 == 0, round % 2 == 1);
  }
  for (int i = 0; i < Overload::kCalmTicks; ++i) overload.note(false, false);
  EXPECT_EQ(overload.stage(), Stage::details);
  for (int i = 0; i + 1 < Overload::kCalmTicks; ++i) overload.note(false, false);
  EXPECT_EQ(overload.stage(), Stage::details) << "each stage has its own calm";
}

}  // namespace
}  // namespace collided::engine::service
