#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <variant>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/service/questions/question_samples.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {
namespace {

constexpr std::uint64_t kReader = 1;
constexpr std::uint64_t kOther = 2;

class QuestionSamplesTest : public ::testing::Test {
 protected:
  QuestionSamplesTest() {
    EXPECT_TRUE(std::holds_alternative<std::uint32_t>(world_.add_scene(World::index_scene(embedded_scene(), {}))));
    EXPECT_TRUE(world_.step(1, 1, {}));
  }
  /// Answers rays that look down from 5 m at x = 0, 1, 2, ... as a worker does; the first meets a shelf, the ones from 100 on nothing.
  void ask(std::int64_t taken_ns, std::size_t count = 1, double first_x = 0, std::uint64_t client = kOther) {
    std::vector<double> rows;
    for (std::size_t i = 0; i < count; ++i)
      rows.insert(rows.end(), {first_x + static_cast<double>(i), 0, 5, 0, 0, -1, 20});
    const Questions asked{.kind = QuestionKind::ray, .numbers = rows};
    const SnapshotRing::Lease state = world_.newest();
    answer(*state, asked, answers_, scratch_);
    if (samples_.wants(taken_ns)) samples_.take(*state, asked, answers_, client, taken_ns);
  }
  std::vector<SampledQuestion> read(std::uint64_t since, std::int64_t now_ns) {
    return samples_.read(since, kReader, now_ns);
  }

  World world_{WorldOptions{}};
  Answers answers_;
  QueryScratch scratch_;
  QuestionSamples samples_;
};

TEST_F(QuestionSamplesTest, NothingIsWantedWhileNobodyReads) {
  EXPECT_FALSE(samples_.wants(0));
  EXPECT_FALSE(samples_.wants(std::int64_t{1} << 62));
  EXPECT_TRUE(read(0, 1'000).empty());
  EXPECT_TRUE(samples_.wants(1'000));
  // The first question after the reader has gone is looked at, and no other.
  const std::int64_t gone_ns = 1'001 + QuestionSamples::kReaderNs;
  EXPECT_TRUE(samples_.wants(gone_ns));
  ask(gone_ns);
  EXPECT_FALSE(samples_.wants(gone_ns + 1));
  EXPECT_TRUE(read(0, gone_ns + 2).empty());
  EXPECT_TRUE(samples_.wants(gone_ns + 2)) << "somebody reads again";
}

TEST_F(QuestionSamplesTest, ASampleHasTheQuestionAndItsFirstHit) {
  read(0, 0);
  ask(10);
  ask(10 + QuestionSamples::kPauseNs, 1, 100);
  const std::vector<SampledQuestion> samples = read(0, 20);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].kind, QuestionKind::ray);
  EXPECT_EQ(samples[0].numbers[2], 5);
  EXPECT_EQ(samples[0].numbers[6], 20);
  EXPECT_EQ(samples[0].taken_ns, 10);
  EXPECT_EQ(samples[0].verdict, Verdict::hit);
  ASSERT_TRUE(samples[0].has_hit);
  EXPECT_NEAR(samples[0].hit.distance_m, 3.8, 1e-6);
  EXPECT_STREQ(samples[0].object.data(), "warehouse/shelf_3/top");
  EXPECT_EQ(samples[1].verdict, Verdict::miss);
  EXPECT_FALSE(samples[1].has_hit);
  EXPECT_STREQ(samples[1].object.data(), "");
}

TEST_F(QuestionSamplesTest, ThereAreTwentyASecondAndTheNewestAreKept) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  std::uint64_t since = 0;
  std::size_t heard = 0;
  for (std::int64_t now_ns = 0; now_ns < kSecond; now_ns += 1'000'000) {
    if (now_ns % 250'000'000 == 0) {
      for (const SampledQuestion& sample : read(since, now_ns)) since = sample.sequence, ++heard;
    }
    ask(now_ns);
  }
  heard += read(since, kSecond).size();
  EXPECT_EQ(heard, 20U);
  for (std::int64_t now_ns = kSecond; now_ns < 11 * kSecond; now_ns += QuestionSamples::kPauseNs) {
    if (now_ns % kSecond == 0) read(~0ULL, now_ns);
    ask(now_ns);
  }
  const std::vector<SampledQuestion> kept = read(0, 11 * kSecond);
  ASSERT_EQ(kept.size(), QuestionSamples::kKept);
  for (std::size_t i = 1; i < kept.size(); ++i) EXPECT_EQ(kept[i].sequence, kept[i - 1].sequence + 1);
}

// Each hit belongs to its question: the hits of a batch stand one after the other.
TEST_F(QuestionSamplesTest, AnyQuestionOfABatchMayBeTheSample) {
  read(0, 0);
  std::set<double> seen;
  for (std::int64_t round = 0; round < 60; ++round) {
    const std::int64_t now_ns = round * QuestionSamples::kPauseNs + round;
    ask(now_ns, 5, -2);
    read(~0ULL, now_ns);
  }
  for (const SampledQuestion& sample : read(0, 0)) {
    seen.insert(sample.numbers[0]);
    ASSERT_TRUE(sample.has_hit);
    EXPECT_EQ(sample.hit.point.x(), sample.numbers[0]);
  }
  EXPECT_EQ(seen, (std::set<double>{-2, -1, 0, 1, 2}));
}

TEST_F(QuestionSamplesTest, OnesOwnAreNotTold) {
  read(0, 0);
  ask(0, 1, 0, kReader);
  ask(QuestionSamples::kPauseNs);
  const std::vector<SampledQuestion> samples = read(0, QuestionSamples::kPauseNs);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].client, kOther);
  EXPECT_EQ(samples_.read(0, kOther, QuestionSamples::kPauseNs).size(), 1U) << "the other reader's";
}

// As after a restart of the server.
TEST_F(QuestionSamplesTest, ANumberFromBeforeARestartMeansAll) {
  read(0, 0);
  ask(0);
  EXPECT_EQ(read(4'711, 1).size(), 1U);
  EXPECT_TRUE(read(1, 1).empty());
}

}  // namespace
}  // namespace collided::engine::service
