#include "server/service/runtime/work_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

namespace collided::engine::service {
namespace {

TEST(WorkQueue, KeepsItsOrderWhileItsMemoryGrowsAndWraps) {
  WorkQueue<int> queue(1'000);
  int next_in = 0;
  int next_out = 0;
  for (int round = 0; round < 20; ++round) {
    for (int i = 0; i < 3 * round; ++i) queue.push(next_in++);
    for (int i = 0; i < 2 * round; ++i) EXPECT_EQ(queue.pop(), next_out++);
  }
  while (!queue.empty()) EXPECT_EQ(queue.pop(), next_out++);
  EXPECT_EQ(next_out, next_in);
}

TEST(WorkQueue, SaysWhenItIsFullAndHandsOutTheRestOnceClosed) {
  WorkQueue<int> queue(2);
  queue.push(1);
  EXPECT_TRUE(queue.has_room());
  queue.push(2);
  EXPECT_FALSE(queue.has_room());
  queue.close();
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(WorkQueue, ItsThreadTakesAllBeforeTheEnd) {
  std::vector<int> taken;
  WorkQueue<int> queue(1'000);
  queue.serve("taker", [&](int item) { taken.push_back(item); });
  for (int i = 0; i < 1'000; ++i) EXPECT_TRUE(queue.push(i));
  queue.finish();
  ASSERT_EQ(taken.size(), 1'000U);
  EXPECT_TRUE(std::is_sorted(taken.begin(), taken.end()));
  EXPECT_FALSE(queue.push(0)) << "nobody would take it";
}

TEST(WorkQueue, EveryItemIsHandedOutOnceToManyThreads) {
  WorkQueue<int> queue(1'000'000);
  constexpr int kItems = 20'000;
  std::vector<std::vector<int>> got(4);
  std::vector<std::thread> threads;
  for (auto& mine : got) {
    threads.emplace_back([&] {
      while (const auto item = queue.pop()) mine.push_back(*item);
    });
  }
  for (int i = 0; i < kItems; ++i) queue.push(i);
  queue.close();
  for (std::thread& thread : threads) thread.join();
  std::vector<int> count(kItems, 0);
  for (const auto& mine : got) {
    for (const int item : mine) ++count[item];
  }
  EXPECT_EQ(std::count(count.begin(), count.end(), 1), kItems);
}

}  // namespace
}  // namespace collided::engine::service
