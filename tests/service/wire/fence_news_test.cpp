// What the events of fences' topics say, by what each fence is to tell.
#include "client/library/watching/fence_news.hpp"
#include "client/library/watching/margin_news.hpp"

#include <gtest/gtest.h>

namespace collided {
namespace {

using codes::kTellsCross;
using codes::kTellsEnter;
using codes::kTellsExit;

Event event_of(EventKind kind, std::uint32_t tells, std::uint64_t sequence, EndReason reason = EndReason::none) {
  Event event;
  event.kind = kind;
  event.reason = reason;
  event.a = "drone";
  event.b = "dock";
  event.b_triangle = tells;
  event.sequence = sequence;
  event.episode = 1;
  event.bracket_low_s = 0.2;
  event.bracket_high_s = 0.1;
  return event;
}

/// The words for what comes of a passage.
std::string passage(std::uint32_t tells) {
  client::FenceNews news;
  std::string words;
  for (const Event& event : {event_of(EventKind::began, tells, 1, EndReason::crossed),
                             event_of(EventKind::ended, tells, 2, EndReason::crossed)}) {
    for (const FenceEvent& told : news.take(event)) {
      EXPECT_EQ(told.object, "drone");
      EXPECT_EQ(told.fence, "dock");
      words += told.kind == FenceEventKind::enter ? "e" : told.kind == FenceEventKind::exit ? "x" : "c";
    }
  }
  return words;
}

TEST(FenceNews, APassageIsOneEventOrTheTwoThatItIsMadeOf) {
  EXPECT_EQ(passage(kTellsEnter | kTellsExit | kTellsCross), "c");
  EXPECT_EQ(passage(kTellsCross), "c");
  EXPECT_EQ(passage(kTellsEnter | kTellsExit), "ex");
  EXPECT_EQ(passage(kTellsEnter), "e");
  EXPECT_EQ(passage(kTellsExit), "x");
}

TEST(FenceNews, APassageHasBothBrackets) {
  client::FenceNews news;
  Event came = event_of(EventKind::began, kTellsCross, 1, EndReason::crossed);
  Event left = event_of(EventKind::ended, kTellsCross, 2, EndReason::crossed);
  left.bracket_low_s = 0.08;
  left.bracket_high_s = 0.07;
  EXPECT_TRUE(news.take(came).empty());
  const std::vector<FenceEvent> told = news.take(left);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].kind, FenceEventKind::cross);
  EXPECT_EQ(told[0].sequence, 2u);
  EXPECT_EQ(told[0].bracket_low_s, 0.2);
  EXPECT_EQ(told[0].bracket_high_s, 0.1);
  EXPECT_EQ(told[0].left_low_s, 0.08);
  EXPECT_EQ(told[0].left_high_s, 0.07);
  EXPECT_EQ(told[0].reason, EndReason::none);
}

TEST(FenceNews, WhatIsOfMergedPosesIsMarked) {
  client::FenceNews news;
  Event came = event_of(EventKind::began, kTellsEnter | kTellsExit, 1);
  came.poses_merged = true;
  const std::vector<FenceEvent> entered = news.take(came);
  ASSERT_EQ(entered.size(), 1u);
  EXPECT_TRUE(entered[0].poses_merged);
  EXPECT_FALSE(news.take(event_of(EventKind::ended, kTellsExit, 2, EndReason::separated)).at(0).poses_merged);
  // Of a passage one half is enough.
  Event left = event_of(EventKind::ended, kTellsCross, 4, EndReason::crossed);
  left.poses_merged = true;
  EXPECT_TRUE(news.take(event_of(EventKind::began, kTellsCross, 3, EndReason::crossed)).empty());
  EXPECT_TRUE(news.take(left).at(0).poses_merged);
}

TEST(FenceNews, WhatIsOfMergedPosesIsMarkedInMarginsToo) {
  Event near = event_of(EventKind::began, 0, 1);
  near.b = "gap\nperson\n0\n2.5";
  EXPECT_FALSE(client::margin_news(near, {})->poses_merged);
  near.poses_merged = true;
  EXPECT_TRUE(client::margin_news(near, {})->poses_merged);
}

TEST(FenceNews, OnlyWhatTheFenceTellsIsReported) {
  client::FenceNews news;
  EXPECT_EQ(news.take(event_of(EventKind::began, kTellsEnter, 1)).size(), 1u);
  EXPECT_TRUE(news.take(event_of(EventKind::ended, kTellsEnter, 2, EndReason::separated)).empty());
  EXPECT_TRUE(news.take(event_of(EventKind::began, kTellsExit, 3)).empty());
  const std::vector<FenceEvent> left = news.take(event_of(EventKind::ended, kTellsExit, 4, EndReason::removed));
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].reason, EndReason::removed);
  EXPECT_EQ(news.take(event_of(EventKind::open, kTellsCross, 5)).size(), 1u);
}

// A doubt has no word of what its fence tells: all of it is told, which errs on the safe side.
TEST(FenceNews, ADoubtIsTold) {
  client::FenceNews news;
  Event doubt = event_of(EventKind::began, kNoTriangle, 1);
  doubt.doubt = Doubt::publisher_lost;
  const std::vector<FenceEvent> told = news.take(doubt);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].kind, FenceEventKind::enter);
  EXPECT_EQ(told[0].doubt, Doubt::publisher_lost);
}

// Where the end of a passage was missed, its beginning is told when something else comes.
TEST(FenceNews, APassageWithoutItsEndIsNotSwallowed) {
  client::FenceNews news;
  EXPECT_TRUE(news.take(event_of(EventKind::began, 7, 1, EndReason::crossed)).empty());
  Event missed = event_of(EventKind::ended, 7, 2);
  missed.resync = true;
  const std::vector<FenceEvent> told = news.take(missed);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].kind, FenceEventKind::enter);
  EXPECT_EQ(told[1].kind, FenceEventKind::exit);
  EXPECT_TRUE(told[1].resync);
}

}  // namespace
}  // namespace collided
