// Shared scratch, a cache warmed by the question before, a counter read as input: the same question gets other bits when
// others are asked beside it. Threads, batch sizes and order must not show.
#include <gtest/gtest.h>

#include <thread>

#include "tests/extreme/mixed.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::invariance_threads_test {
namespace {

std::size_t stride_of(QuestionKind kind) {
  if (kind == QuestionKind::ray) return kRayNumbers;
  return kind == QuestionKind::box ? kBoxNumbers : kSphereNumbers;
}

/// One question after the other, in batches of the given size: the answers' bits of each question.
std::vector<std::vector<std::uint64_t>> asked(const Snapshot& snapshot, QuestionKind kind,
                                              std::span<const double> numbers, std::size_t batch,
                                              QueryScratch& scratch) {
  std::vector<std::vector<std::uint64_t>> bits;
  const std::size_t step = batch * stride_of(kind);
  for (std::size_t begin = 0; begin < numbers.size(); begin += step) {
    Questions questions;
    questions.kind = kind;
    questions.mode = HitMode::all;
    questions.numbers = numbers.subspan(begin, std::min(step, numbers.size() - begin));
    Answers answers;
    answer(snapshot, questions, answers, scratch);
    std::size_t first_hit = 0;
    for (std::size_t i = 0; i < answers.answers.size(); ++i) {
      Answers one;
      one.answers = {answers.answers[i]};
      one.hit_counts = {answers.hit_counts[i]};
      const auto from = answers.hits.begin() + static_cast<std::ptrdiff_t>(first_hit);
      one.hits.assign(from, from + answers.hit_counts[i]);
      first_hit += answers.hit_counts[i];
      bits.push_back(extreme::bits_of(one));
    }
  }
  return bits;
}

class ExtremeInvarianceThreads : public testing::Test {
 protected:
  void SetUp() override {
    std::mt19937_64 random = oracle::seeded(421);
    extreme::Mixer mixer(random, extreme::Ground::lattice);
    extreme::build(stage, mixer.cast(60));
    for (const auto kind : extreme::kKinds) questions.push_back(mixer.questions(kind, 240));
  }
  extreme::Stage stage;
  std::vector<std::vector<double>> questions;
};

TEST_F(ExtremeInvarianceThreads, BatchSizesDoNotShow) {
  const auto lease = stage.world.newest();
  for (std::size_t k = 0; k < questions.size(); ++k) {
    QueryScratch scratch;
    const auto whole = asked(*lease, extreme::kKinds[k], questions[k], 240, scratch);
    for (const std::size_t batch : {1u, 7u, 64u}) {
      QueryScratch fresh;
      ASSERT_EQ(asked(*lease, extreme::kKinds[k], questions[k], batch, fresh), whole);
      ASSERT_EQ(asked(*lease, extreme::kKinds[k], questions[k], batch, scratch), whole) << "with used scratch";
    }
  }
}

TEST_F(ExtremeInvarianceThreads, OneToFourThreadsGiveTheSameBits) {
  const auto lease = stage.world.newest();
  for (std::size_t k = 0; k < questions.size(); ++k) {
    QueryScratch scratch;
    const auto alone = asked(*lease, extreme::kKinds[k], questions[k], 240, scratch);
    for (unsigned count = 1; count <= 4; ++count) {
      std::vector<std::vector<std::vector<std::uint64_t>>> results(count);
      std::vector<std::thread> threads;
      for (unsigned t = 0; t < count; ++t) {
        threads.emplace_back([&, t] {
          QueryScratch own;
          results[t] = asked(*lease, extreme::kKinds[k], questions[k], 1 + 10 * t, own);
        });
      }
      for (std::thread& thread : threads) thread.join();
      for (const auto& result : results) ASSERT_EQ(result, alone) << count << " threads";
    }
  }
}

TEST_F(ExtremeInvarianceThreads, TheOrderOfAskingDoesNotShow) {
  const auto lease = stage.world.newest();
  for (std::size_t k = 0; k < questions.size(); ++k) {
    QueryScratch scratch;
    auto forward = asked(*lease, extreme::kKinds[k], questions[k], 240, scratch);
    const std::size_t stride = stride_of(extreme::kKinds[k]);
    std::vector<double> reversed;
    for (std::size_t end = questions[k].size(); end > 0; end -= stride) {
      reversed.insert(reversed.end(), questions[k].begin() + static_cast<std::ptrdiff_t>(end - stride),
                      questions[k].begin() + static_cast<std::ptrdiff_t>(end));
    }
    std::reverse(forward.begin(), forward.end());
    ASSERT_EQ(asked(*lease, extreme::kKinds[k], reversed, 240, scratch), forward);
  }
}

// The build's own threads: one tree or another, the same answers.
TEST(ExtremeInvarianceBuild, TheNumberOfBuildingThreadsDoesNotShow) {
  std::mt19937_64 random = oracle::seeded(422);
  extreme::Mixer mixer(random, extreme::Ground::lattice);
  const TriangleMesh mesh = mixer.cast(0).scene;
  const std::vector<double> rays = mixer.rays(300);
  std::vector<std::uint64_t> first;
  for (unsigned threads = 1; threads <= 4; ++threads) {
    World world{WorldOptions{}};
    Scene scene{.name = "scene", .mesh = mesh};
    scene.parts = {{.name = "scene", .first_triangle = 0, .triangle_count = 60}};
    world.add_scene(World::index_scene(scene, {.threads = threads, .progress = {}, .cancelled = {}}));
    world.step(1, 1, {});
    Questions questions;
    questions.mode = HitMode::all;
    questions.numbers = rays;
    Answers answers;
    QueryScratch scratch;
    answer(*world.newest(), questions, answers, scratch);
    if (threads == 1) first = extreme::bits_of(answers);
    ASSERT_EQ(extreme::bits_of(answers), first) << threads;
  }
}

}  // namespace
}  // namespace collided::engine::invariance_threads_test
