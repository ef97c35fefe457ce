// What the events of fences' topics say of questions for the nearest: who follows whom.
#include "client/library/watching/nearest_news.hpp"

#include <gtest/gtest.h>

#include "idl/fence_ids.hpp"

namespace collided {
namespace {

Event event_of(EventKind kind, const std::string& object, std::uint64_t id, std::uint32_t goes_on = 0) {
  Event event;
  event.kind = kind;
  event.a = object;
  event.a_id = id;
  event.b = "escape";
  event.b_id = wire_contract::kNearestBits | 5;
  event.b_triangle = goes_on;
  event.depth_m = -2;
  event.depth_error_m = 1e-12;
  if (kind == EventKind::ended) event.reason = EndReason::separated;
  return event;
}

TEST(NearestNews, AnEndAndABeginningAreOneChange) {
  client::NearestNews news;
  const auto first = news.take(event_of(EventKind::open, "door_a", 1));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->kind, NearestEventKind::is);
  EXPECT_EQ(first->to, "door_a");
  EXPECT_EQ(first->distance_m, 2);
  EXPECT_FALSE(news.take(event_of(EventKind::ended, "door_a", 1, wire_contract::kNearestGoesOn)));
  const auto changed = news.take(event_of(EventKind::began, "door_b", 2));
  ASSERT_TRUE(changed);
  EXPECT_EQ(changed->kind, NearestEventKind::changed);
  EXPECT_EQ(changed->from, "door_a");
  EXPECT_EQ(changed->to, "door_b");
  EXPECT_EQ(changed->reason, EndReason::separated);
  const auto left = news.take(event_of(EventKind::ended, "door_b", 2));
  ASSERT_TRUE(left);
  EXPECT_EQ(left->from, "door_b");
  EXPECT_EQ(left->to, "");
  EXPECT_EQ(left->distance_m, 0);
  EXPECT_EQ(news.take(event_of(EventKind::began, "door_c", 3))->from, "");
}

TEST(NearestNews, AChangeOfMergedPosesOfEitherIsMarked) {
  client::NearestNews news;
  EXPECT_FALSE(news.take(event_of(EventKind::open, "door_a", 1))->poses_merged);
  Event ended = event_of(EventKind::ended, "door_a", 1, wire_contract::kNearestGoesOn);
  ended.poses_merged = true;
  EXPECT_FALSE(news.take(ended));
  EXPECT_TRUE(news.take(event_of(EventKind::began, "door_b", 2))->poses_merged);
  EXPECT_FALSE(news.take(event_of(EventKind::ended, "door_b", 2, wire_contract::kNearestGoesOn)));
  EXPECT_FALSE(news.take(event_of(EventKind::began, "door_c", 3))->poses_merged);
}

// After a gap the state is told in any order.
TEST(NearestNews, AnEndThatComesAfterItsSuccessorIsNoNews) {
  client::NearestNews news;
  EXPECT_TRUE(news.take(event_of(EventKind::began, "door_a", 1)));
  EXPECT_EQ(news.take(event_of(EventKind::began, "door_b", 2))->from, "door_a");
  EXPECT_FALSE(news.take(event_of(EventKind::ended, "door_a", 1)));
}

TEST(NearestNews, ADoubtHasNoDistanceAndFencesAreNoNews) {
  client::NearestNews news;
  Event doubtful = event_of(EventKind::began, "door_a", 1);
  doubtful.doubt = Doubt::publisher_lost;
  const auto told = news.take(doubtful);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->doubt, Doubt::publisher_lost);
  EXPECT_EQ(told->distance_m, 0);
  Event of_fence = event_of(EventKind::began, "door_a", 1);
  of_fence.b_id = std::uint64_t{1} << 63;
  EXPECT_FALSE(news.take(of_fence));
}

}  // namespace
}  // namespace collided
