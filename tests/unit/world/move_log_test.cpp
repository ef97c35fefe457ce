#include "server/world/query/move_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>

#include "tests/oracle/seed.hpp"

namespace collided::engine::move_log_test {
namespace {

Move move_until(std::int64_t to_ns) {
  return {.from_ns = to_ns - 1, .to_ns = to_ns, .pose = {.position = {1e-9 * static_cast<double>(to_ns), 0, 0}}};
}

/// How many moves lie beside the first, one after the other in memory.
std::size_t moves_in_first_block(const MoveLog& log) {
  const Move* const end = log.end_of_first_block();
  return end == nullptr ? log.size() : static_cast<std::size_t>(end - &log.front()) + 1;
}

// A step must not stand still where a thousand objects' logs grow in it.
TEST(MoveLog, GrowingMovesNothing) {
  MoveLog log;
  log.push_back(move_until(1));
  const Move* const first = &log.front();
  for (std::int64_t i = 2; i <= 10'000; ++i) log.push_back(move_until(i));
  EXPECT_EQ(&log.front(), first);
  const Move* const last = &log.back();
  for (std::int64_t i = 1; i < 10'000; ++i) log.pop_front();
  EXPECT_EQ(&log.front(), last) << "and forgetting neither";
}

// Against a plain queue that is searched from its beginning.
TEST(MoveLog, FindsWhatAPlainQueueFinds) {
  std::mt19937_64 random = oracle::seeded(20'261);
  for (int round = 0; round < 200; ++round) {
    MoveLog log;
    std::deque<Move> twin;
    std::int64_t end_ns = 0;
    for (int i = 0; i < 200; ++i) {
      const std::size_t in_first_block = log.empty() ? 0 : moves_in_first_block(log);
      const Move* const end = log.end_of_first_block();
      ASSERT_EQ(end != nullptr, in_first_block < twin.size());
      if (end != nullptr) { ASSERT_EQ(end->to_ns, twin[in_first_block - 1].to_ns); }
      if (end != nullptr && random() % 20 == 0) {
        ASSERT_EQ(log.pop_block(), in_first_block);
        twin.erase(twin.begin(), twin.begin() + static_cast<std::ptrdiff_t>(in_first_block));
      } else if (random() % 3 > 0 || twin.empty()) {
        const bool begins_block = log.is_full();
        const Move* const last = log.empty() ? nullptr : &log.back();
        end_ns += static_cast<std::int64_t>(random() % 3);  // several may end at one time
        log.push_back(move_until(end_ns));
        twin.push_back(move_until(end_ns));
        if (!begins_block) { ASSERT_EQ(&log.back(), last + 1); }
      } else {
        log.pop_front();
        twin.pop_front();
      }
      ASSERT_EQ(log.size(), twin.size());
      ASSERT_EQ(log.empty(), twin.empty());
      const auto time_ns = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(end_ns + 3)) - 1;
      const auto next = std::find_if(twin.begin(), twin.end(), [&](const Move& move) { return move.to_ns > time_ns; });
      const MoveLog::Around around = log.around(time_ns);
      ASSERT_EQ(around.next != nullptr, next != twin.end());
      ASSERT_EQ(around.before != nullptr, next != twin.begin());
      if (around.next != nullptr) { ASSERT_EQ(around.next->to_ns, next->to_ns); }
      if (around.before == nullptr) continue;
      ASSERT_EQ(around.before->to_ns, std::prev(next)->to_ns);
    }
  }
}

}  // namespace
}  // namespace collided::engine::move_log_test
