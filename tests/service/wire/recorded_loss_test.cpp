#include <gtest/gtest.h>

#include "client/library/recordings/recorded_loss.hpp"

namespace collided {
namespace {

using client::Clock;
using client::RecordedLoss;
using std::chrono::seconds;

TEST(RecordedLoss, GapsOfAPublisherCountWhateverTopicTheyAreOn) {
  RecordedLoss loss;
  loss.hear_definition(7, 1, 2);  // from before: says nothing
  loss.hear_poses(7, 1, 10);
  loss.hear_poses(7, 1, 11);
  loss.hear_definition(7, 1, 13);
  loss.hear_poses(7, 1, 12);  // the topics overtake each other
  EXPECT_EQ(loss.poses(), 0U);
  loss.hear_poses(7, 1, 16);
  EXPECT_EQ(loss.poses(), 2U);
  loss.hear_definition(7, 1, 15);
  EXPECT_EQ(loss.poses(), 1U);
}

// The opening carries the number of the newest sample in it; what comes again from before it is not counted.
TEST(RecordedLoss, WhatTheOpeningHasIsNoGap) {
  RecordedLoss loss;
  loss.hear_poses(7, 1, 900);
  loss.hear_poses(7, 1, 899);
  loss.hear_poses(7, 1, 900);
  loss.hear_definition(7, 1, 5);
  loss.hear_poses(7, 1, 901);
  EXPECT_EQ(loss.poses(), 0U);
}

TEST(RecordedLoss, EventsHaveNoGap) {
  RecordedLoss loss;
  loss.hear_events(1, 1, 100, 5);
  loss.hear_events(1, 1, 105, 1);
  EXPECT_EQ(loss.events(), 0U);
  loss.hear_events(1, 1, 110, 1);
  EXPECT_EQ(loss.events(), 4U);
  loss.hear_events(1, 2, 1, 1);  // another life counts anew
  EXPECT_EQ(loss.events(), 4U);
}

TEST(RecordedLoss, AReplyWithoutItsQuestionIsALostQuestion) {
  RecordedLoss loss;
  const Clock::time_point start = Clock::now();
  loss.hear_question(1, 1, start);
  loss.hear_reply(1, 1, start);
  loss.hear_reply(1, 1, start);  // in two parts
  loss.hear_reply(1, 2, start);  // overtakes its question
  loss.hear_question(1, 2, start);
  loss.hear_reply(1, 3, start);
  loss.hear_question(1, 4, start);
  loss.settle(start + seconds(1));
  EXPECT_EQ(loss.questions(), 0U) << "it may still come";
  loss.settle(start + seconds(6));
  EXPECT_EQ(loss.questions(), 1U);
  EXPECT_EQ(loss.unanswered(), 0U) << "a command may take a minute";
  loss.settle(start + seconds(61));
  EXPECT_EQ(loss.unanswered(), 1U);
}

}  // namespace
}  // namespace collided
