#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <numeric>
#include <random>

#include "client/library/publishing/unacknowledged_poses.hpp"

namespace collided::client {
namespace {

// Against a list of all batches that are out, over random writes and words of the server.
TEST(UnacknowledgedPoses, CountsWhatIsOut) {
  constexpr std::uint64_t kSeed = 20;
  std::mt19937_64 random(kSeed);
  std::uint64_t times_full = 0, times_full_of_bytes = 0;
  for (int run = 0; run < 20; ++run) {
    UnacknowledgedPoses poses;
    struct Out {
      std::uint64_t sequence;
      std::size_t bytes;
    };
    std::deque<Out> out;
    const std::size_t most = run % 2 == 0 ? 300'000 : 1'000;
    std::uint64_t sequence = 0;
    for (int step = 0; step < 2'000; ++step) {
      const std::size_t bytes = std::accumulate(out.begin(), out.end(), std::size_t{0},
                                                [](std::size_t sum, const Out& batch) { return sum + batch.bytes; });
      const bool full_of_bytes = bytes >= UnacknowledgedPoses::kMostBytes;
      const bool full = out.size() >= UnacknowledgedPoses::kMostBatches || full_of_bytes;
      ASSERT_EQ(poses.is_full(), full) << "seed " << kSeed << ", run " << run << ", step " << step;
      times_full += full ? 1 : 0;
      times_full_of_bytes += full_of_bytes ? 1 : 0;
      if (!full && random() % 100 != 0) {
        sequence += random() % 4;  // definitions between; some batches have no number of their own
        out.push_back({sequence, random() % most});
        poses.note_written(out.back().sequence, out.back().bytes);
      } else if (random() % 4 == 0) {
        poses.note_all_known();
        out.clear();
      } else {
        const std::uint64_t known = random() % (sequence + 2);
        poses.note_known(known);
        while (!out.empty() && out.front().sequence <= known) out.pop_front();
      }
    }
  }
  EXPECT_GT(times_full, times_full_of_bytes);
  EXPECT_GT(times_full_of_bytes, 0u);
}

}  // namespace
}  // namespace collided::client
