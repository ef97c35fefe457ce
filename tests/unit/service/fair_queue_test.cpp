#include "server/service/runtime/fair_queue.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <new>
#include <random>
#include <system_error>
#include <thread>

#include "tests/oracle/seed.hpp"

namespace collided::engine::service {
namespace {

/// Pushes where there is room.
bool push(FairQueue<int>& queue, std::uint64_t client, double cost, int item, bool is_kept = false) {
  return queue.push({.client = client, .cost = cost, .is_kept = is_kept}, item);
}

// One client has thousands waiting; another's single question is next.
TEST(FairQueue, WhoAsksLittleDoesNotWaitForWhoAsksMuch) {
  FairQueue<int> queue(10'000);
  for (int i = 0; i < 4'000; ++i) ASSERT_TRUE(push(queue, 1, 1'000, i));
  EXPECT_EQ(queue.pop(), 0);
  ASSERT_TRUE(push(queue, 2, 1, -1));
  EXPECT_EQ(queue.pop(), -1);
  ASSERT_TRUE(push(queue, 2, 1, -2));
  EXPECT_EQ(queue.pop(), -2) << "and so is its next one";
  EXPECT_EQ(queue.pop(), 1);
}

// As many threads as there is work at a time, and not more than allowed.
TEST(FairQueue, ThreadsComeWhenWorkWaitsThatNoneIsFreeFor) {
  FairQueue<int> queue(10'000);
  std::atomic<int> at_work{0};
  std::atomic<int> done{0};
  std::atomic<bool> may_end{false};
  std::atomic<int> started{0};
  queue.staff(3, [&] {
    return [&] {
      ++started;
      while (queue.pop()) {
        ++at_work;
        while (!may_end.load()) std::this_thread::yield();
        --at_work;
        ++done;
      }
    };
  });
  EXPECT_EQ(queue.idle(), 3U);
  for (int item = 1; item <= 5; ++item) {
    ASSERT_TRUE(push(queue, 1, 1, item));
    const int most = std::min(item, 3);
    while (at_work.load() < most) std::this_thread::yield();
    EXPECT_EQ(started.load(), most) << item;
  }
  EXPECT_EQ(queue.idle(), 0U);
  EXPECT_EQ(queue.most_threads(), 3U);
  may_end.store(true);
  while (done.load() < 5) std::this_thread::yield();
  // One that is free takes what comes next.
  while (queue.idle() < 3) std::this_thread::yield();
  ASSERT_TRUE(push(queue, 1, 1, 6));
  queue.finish();
  EXPECT_EQ(started.load(), 3);
  EXPECT_EQ(done.load(), 6);
}

// The first two threads find no room and no memory: what nothing would take is refused, and later work is done.
TEST(FairQueue, WithoutRoomForAThreadWorkIsRefusedAndTheNextIsDone) {
  FairQueue<int> queue(10'000);
  int begun = 0;
  std::atomic<int> done{0};
  queue.staff(2, [&]() -> Crew::Shift {
    ++begun;
    if (begun == 1) throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
    if (begun == 2) throw std::bad_alloc();
    return [&] {
      while (queue.pop()) ++done;
    };
  });
  EXPECT_FALSE(push(queue, 1, 1, 1));
  EXPECT_FALSE(push(queue, 1, 1, 2));
  EXPECT_EQ(queue.refused(), 2U);
  EXPECT_EQ(queue.waiting(), 0U);
  EXPECT_TRUE(push(queue, 1, 1, 3));
  queue.finish();
  EXPECT_EQ(done.load(), 1);
}

TEST(FairQueue, KeepsTheOrderOfEachClient) {
  FairQueue<int> queue(10'000);
  std::mt19937_64 random = oracle::seeded(31);
  std::map<int, int> pushed;
  std::map<int, int> popped;
  for (int i = 0; i < 5'000; ++i) {
    const int client = static_cast<int>(random() % 7);
    if (random() % 2 == 0) {
      ASSERT_TRUE(push(queue, static_cast<std::uint64_t>(client), 1.0 + static_cast<double>(random() % 50),
                       client * 10'000 + pushed[client]++));
    } else if (queue.waiting() > 0) {
      const int item = *queue.pop();
      EXPECT_EQ(item % 10'000, popped[item / 10'000]++);
    }
  }
}

// Clients that always have something waiting get the same amount of work done, whatever size they cut it into and however
// much of it they send: at any time nobody is ahead of another by more than one piece of each.
TEST(FairQueue, WorkIsSharedByCost) {
  FairQueue<int> queue(100'000);
  const std::vector<double> cost{1, 10, 100, 1'000};
  for (int round = 0; round < 2'000; ++round) {
    for (std::size_t client = 0; client < cost.size(); ++client) {
      const int pieces = static_cast<int>(1'000 / cost[client]);
      for (int i = 0; i < std::min(pieces, 20); ++i)
        static_cast<void>(push(queue, client, cost[client], static_cast<int>(client)));
    }
  }
  std::vector<double> done(cost.size(), 0);
  double worst = 0;
  for (int i = 0; i < 10'000; ++i) {
    const auto client = static_cast<std::size_t>(*queue.pop());
    done[client] += cost[client];
    if (i < 100) continue;
    const auto [least, most] = std::minmax_element(done.begin(), done.end());
    worst = std::max(worst, *most - *least);
  }
  EXPECT_LE(worst, 2'001);
}

// What one leaves free is there for others: a half, then a half of the rest, and so on.
TEST(FairQueue, NobodyFillsTheRoomOfOthers) {
  FairQueue<int> queue(1'000);
  int taken = 0;
  while (push(queue, 1, 1, taken)) ++taken;
  EXPECT_EQ(taken, 500);
  int second = 0;
  while (push(queue, 2, 1, second)) ++second;
  EXPECT_EQ(second, 250);
  EXPECT_TRUE(push(queue, 3, 1, 0));
  EXPECT_FALSE(push(queue, 1, 1, 0));
  EXPECT_EQ(queue.refused(), 3U);
  EXPECT_TRUE(push(queue, 1, 1, 0, true)) << "what must be taken is";
  int kept = 501;
  while (push(queue, 1, 1, 0, true)) ++kept;
  EXPECT_LE(kept, 750) << "but a quarter is never one client's";
  while (push(queue, 4, 1, 0, true)) {}
  EXPECT_FALSE(queue.has_room());
}

// A participant that makes up clients gains nothing by it.
TEST(FairQueue, OwnersShareEvenlyHoweverManyClientsTheyHave) {
  FairQueue<int> queue(100'000);
  constexpr std::uint64_t kMany = 64;
  for (int i = 0; i < 100; ++i) {
    for (std::uint64_t client = 1; client <= kMany; ++client) {
      int item = 1;
      ASSERT_TRUE(queue.push({.client = client, .owner = 1, .cost = 10}, item));
    }
    int item = 2;
    for (int j = 0; j < 20; ++j) ASSERT_TRUE(queue.push({.client = 1'000, .owner = 2, .cost = 10}, item));
  }
  std::map<int, int> handed_out;
  for (int i = 0; i < 2'000; ++i) ++handed_out[queue.pop().value_or(0)];
  EXPECT_NEAR(handed_out[1], 1'000, 100);
  EXPECT_NEAR(handed_out[2], 1'000, 100);
}

TEST(FairQueue, ManyNumbersOfOneOwnerFillNoMoreThanOne) {
  FairQueue<int> queue(100);
  for (const bool is_kept : {false, true}) {
    int taken = 0;
    for (int i = 0; i < 1'000; ++i) {
      int item = i;
      const auto client = static_cast<std::uint64_t>(1 + i % 64);
      if (queue.push({.client = client, .owner = 7, .is_kept = is_kept}, item)) ++taken;
    }
    EXPECT_EQ(taken, is_kept ? 25 : 50) << "up to half of the room, and with what is kept three quarters";
  }
  int other = 0;
  EXPECT_TRUE(queue.push({.client = 1'000, .owner = 8}, other)) << "another still finds room";
}

TEST(FairQueue, RoomIsCountedInBytesToo) {
  FairQueue<int> queue(1'000, 1'000'000);
  int taken = 0;
  int item = 1;
  while (queue.push({.client = 1, .bytes = 10'000}, item)) ++taken;
  EXPECT_EQ(taken, 50) << "one alone fills half";
  EXPECT_EQ(queue.waiting_bytes(), 500'000U);
  EXPECT_FALSE(queue.has_room_for({.client = 1, .bytes = 10'000}));
  EXPECT_TRUE(queue.has_room_for({.client = 2, .bytes = 10'000})) << "another one finds room";
  EXPECT_TRUE(queue.push({.client = 1, .bytes = 10'000, .is_begun = true}, item)) << "what was begun is finished";
  for (int i = 0; i < taken; ++i) queue.pop();
  EXPECT_EQ(queue.waiting_bytes(), 10'000U);
  EXPECT_EQ(queue.waiting_cost(), 1);
  queue.pop();
  EXPECT_EQ(queue.waiting_bytes(), 0U);
  EXPECT_EQ(queue.waiting_cost(), 0);
}

TEST(FairQueue, TheServersOwnWorkComesFirst) {
  FairQueue<int> queue(10);
  ASSERT_TRUE(push(queue, 1, 1, 1));
  queue.push_own(2);
  queue.push_own(3);
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.pop(), 3);
  queue.close();
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), std::nullopt);
}

// Numbers of clients come from outside: a new one with each question must not take memory for ever, nor gain anything.
TEST(FairQueue, ManyNamesAreNoTrouble) {
  FairQueue<int> queue(100);
  for (int i = 0; i < 100'000; ++i) {
    ASSERT_TRUE(push(queue, static_cast<std::uint64_t>(i), 1e6, i));
    if (i % 10 == 9) {
      for (int j = 0; j < 10; ++j) ASSERT_TRUE(queue.pop());
    }
  }
}

TEST(FairQueue, EveryItemIsHandedOutOnceToManyThreads) {
  FairQueue<int> queue(1'000'000);
  constexpr int kItems = 20'000;
  std::vector<std::vector<int>> got(4);
  std::vector<std::thread> threads;
  for (auto& mine : got) {
    threads.emplace_back([&] {
      while (const auto item = queue.pop()) mine.push_back(*item);
    });
  }
  for (int i = 0; i < kItems; ++i) {
    if (i % 5 == 0) {
      queue.push_own(i);
    } else {
      ASSERT_TRUE(push(queue, static_cast<std::uint64_t>(i % 3), 1, i));
    }
  }
  queue.close();
  for (std::thread& thread : threads) thread.join();
  std::vector<int> count(kItems, 0);
  for (const auto& mine : got) {
    for (const int item : mine) ++count[static_cast<std::size_t>(item)];
  }
  EXPECT_EQ(std::count(count.begin(), count.end(), 1), kItems);
}

}  // namespace
}  // namespace collided::engine::service
