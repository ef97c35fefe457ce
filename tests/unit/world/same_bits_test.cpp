#include <gtest/gtest.h>

#include <hwy/targets.h>

#include <bit>
#include <cmath>
#include <thread>

#include "server/world/query/query.hpp"
#include "tests/oracle/mixed_world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

// Same state, same question, same bits: whatever the processor, the number of threads, and what is asked beside it.
namespace collided::engine {
namespace {

using oracle::MixedWorld;

constexpr std::size_t kQuestions = 400;

std::vector<double> random_numbers(MixedWorld& mixed, QuestionKind kind) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < kQuestions; ++i) {
    const Vec3 p = mixed.point(5);
    const Vec3 d = mixed.point(3) - p;
    numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
    if (kind == QuestionKind::ray) numbers.insert(numbers.end(), {d.x(), d.y(), d.z(), INFINITY});
    if (kind == QuestionKind::sphere) numbers.push_back(0.8);
    if (kind == QuestionKind::box) numbers.insert(numbers.end(), {0.5, 0.7, 0.3, 1, 0, 0, 0});
    if (kind == QuestionKind::near) numbers.push_back(INFINITY);
  }
  return numbers;
}

Questions question_of(QuestionKind kind, std::span<const double> numbers) {
  return {.kind = kind, .max_hits = kind == QuestionKind::near ? 4U : 1'000U, .numbers = numbers};
}

/// FNV-1a over everything that an answer says; what it cost is left out.
class Digest {
 public:
  void add(const Answers& answers) {
    for (const auto answer : answers.answers) add(static_cast<std::uint64_t>(answer));
    for (const std::uint32_t count : answers.hit_counts) add(count);
    for (const AnswerHit& hit : answers.hits) {
      add(hit.object);
      add(hit.triangle);
      add(hit.flags);
      for (const double x : {hit.distance_m, hit.error_m, hit.exit_m}) add(std::bit_cast<std::uint64_t>(x));
      for (const Vec3& v : {hit.point, hit.normal, hit.weights}) {
        for (const double x : v) add(std::bit_cast<std::uint64_t>(x));
      }
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3; }
  std::uint64_t value_ = 0xcbf29ce484222325;
};

std::uint64_t digest_of_all(const Snapshot& snapshot, const std::vector<std::vector<double>>& numbers) {
  Digest digest;
  Answers answers;
  QueryScratch scratch;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    answer(snapshot, question_of(kPlainQuestions[k], numbers[k]), answers, scratch);
    digest.add(answers);
  }
  return digest.value();
}

class WorldSameBits : public ::testing::Test {
 protected:
  WorldSameBits() {
    for (const QuestionKind kind : kPlainQuestions) numbers_.push_back(random_numbers(mixed_, kind));
  }
  const Snapshot& state() { return *lease_; }

  std::mt19937_64 random_ = oracle::seeded(61);
  MixedWorld mixed_{random_};
  SnapshotRing::Lease lease_ = (*mixed_).newest();
  std::vector<std::vector<double>> numbers_;
};

TEST_F(WorldSameBits, OnEveryInstructionSet) {
  const std::uint64_t expected = digest_of_all(state(), numbers_);
  int sets = 0;
  for (std::int64_t rest = hwy::SupportedTargets() | HWY_EMU128; rest != 0; rest &= rest - 1) {
    const std::int64_t target = rest & -rest;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    EXPECT_EQ(digest_of_all(state(), numbers_), expected) << hwy::TargetName(target);
    ++sets;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  EXPECT_GE(sets, 2);
}

TEST_F(WorldSameBits, FromAnyNumberOfThreads) {
  const std::uint64_t expected = digest_of_all(state(), numbers_);
  std::vector<std::uint64_t> digests(4);
  std::vector<std::thread> threads;
  for (std::uint64_t& digest : digests) {
    threads.emplace_back([&] { digest = digest_of_all(state(), numbers_); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t digest : digests) EXPECT_EQ(digest, expected);
}

TEST_F(WorldSameBits, AloneOrInAnyBatch) {
  QueryScratch scratch;
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const QuestionKind kind = kPlainQuestions[k];
    const std::span<const double> all = numbers_[k];
    const std::size_t stride = all.size() / kQuestions;
    Answers whole;
    answer(state(), question_of(kind, all), whole, scratch);
    Digest expected;
    expected.add({.answers = {},
                  .reasons = {},
                  .levels = {},
                  .hit_counts = {},
                  .nodes = {},
                  .exact_tests = {},
                  .hits = whole.hits});
    for (const std::size_t batch : {std::size_t{1}, std::size_t{7}, std::size_t{64}}) {
      std::vector<AnswerHit> hits;
      for (std::size_t i = 0; i < kQuestions; i += batch) {
        Answers part;
        const std::size_t count = std::min(batch, kQuestions - i);
        answer(state(), question_of(kind, all.subspan(i * stride, count * stride)), part, scratch);
        hits.insert(hits.end(), part.hits.begin(), part.hits.end());
      }
      Digest given;
      given.add(
          {.answers = {}, .reasons = {}, .levels = {}, .hit_counts = {}, .nodes = {}, .exact_tests = {}, .hits = hits});
      EXPECT_EQ(given.value(), expected.value()) << name_of(kind) << " by " << batch;
    }
  }
}

TEST_F(WorldSameBits, InOneGoOrWithPauses) {
  constexpr std::int64_t kLongAgo = 1;
  QueryScratch scratch;
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const QuestionKind kind = kPlainQuestions[k];
    Answers whole, part, joined;
    answer(state(), question_of(kind, numbers_[k]), whole, scratch);
    const std::size_t stride = numbers_[k].size() / kQuestions;
    int pauses = 0;
    while (joined.answers.size() < kQuestions) {
      Questions rest = question_of(kind, std::span<const double>(numbers_[k]).subspan(joined.answers.size() * stride));
      rest.pause_ns = kLongAgo;
      answer(state(), rest, part, scratch);
      ASSERT_FALSE(part.answers.empty()) << "each turn answers something";
      ASSERT_EQ(part.answers.size(), part.hit_counts.size());
      joined.answers.insert(joined.answers.end(), part.answers.begin(), part.answers.end());
      joined.hit_counts.insert(joined.hit_counts.end(), part.hit_counts.begin(), part.hit_counts.end());
      joined.hits.insert(joined.hits.end(), part.hits.begin(), part.hits.end());
      ++pauses;
    }
    EXPECT_GT(pauses, 4) << name_of(kind);
    Digest expected, given;
    expected.add(whole);
    given.add(joined);
    EXPECT_EQ(given.value(), expected.value()) << name_of(kind);
  }
}

// A large scene: rays of no common direction are walked in turn, those of a camera in packets, one by one neither.
class WorldRaysTogether : public ::testing::TestWithParam<bool> {};

TEST_P(WorldRaysTogether, GiveTheBitsOfEachAlone) {
  std::mt19937_64 random = oracle::seeded(62);
  Scene scene;
  scene.name = "terrain";
  scene.mesh = scenes::terrain(300, 300, random());
  scene.parts = {{.name = "terrain",
                  .first_triangle = 0,
                  .triangle_count = static_cast<std::uint32_t>(scene.mesh.triangles.size())}};
  World world(WorldOptions{});
  auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
  const Aabb bounds = indexed.geometry->tree.bounds();
  world.add_scene(indexed);
  world.step(0, 1, {});
  const auto state = world.newest();
  ASSERT_GT(state->scenes[0]->tree.report().bytes, 4u << 20);
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<double> numbers;
  const auto place = [&] {
    return Vec3(bounds.low + Vec3(part(random), part(random), part(random)).cwiseProduct(bounds.high - bounds.low));
  };
  for (std::size_t i = 0; i < 1'000; ++i) {
    const bool is_camera = GetParam();
    const Vec3 p = is_camera ? Vec3(bounds.high.cwiseProduct(Vec3(0, 0, 1)) + Vec3(0, 0, 30)) : place();
    const Vec3 d = is_camera ? Vec3(0.3 + 1e-4 * static_cast<double>(i), 0.2, -1) : Vec3(place() - p);
    // Some are no questions, some end early.
    numbers.insert(numbers.end(),
                   {p.x(), p.y(), i % 97 == 0 ? NAN : p.z(), d.x(), d.y(), d.z(), i % 5 == 0 ? 10 : INFINITY});
  }
  for (const auto mode : {HitMode::closest, HitMode::any, HitMode::all}) {
    Answers together, alone;
    QueryScratch scratch;
    Questions questions{.kind = QuestionKind::ray, .mode = mode, .numbers = numbers};
    answer(*state, questions, together, scratch);
    Digest expected, given;
    given.add(together);
    Answers joined;
    for (std::size_t i = 0; i < 1'000; ++i) {
      questions.numbers = std::span(numbers).subspan(i * kRayNumbers, kRayNumbers);
      answer(*state, questions, alone, scratch);
      joined.answers.push_back(alone.answers[0]);
      joined.hit_counts.push_back(alone.hit_counts[0]);
      joined.hits.insert(joined.hits.end(), alone.hits.begin(), alone.hits.end());
      if (!GetParam()) { ASSERT_EQ(together.nodes[i], alone.nodes[0]); }
    }
    expected.add(joined);
    EXPECT_EQ(given.value(), expected.value());
    EXPECT_GT(together.hits.size(), 100U);
  }
}

INSTANTIATE_TEST_SUITE_P(Batches, WorldRaysTogether, ::testing::Bool(),
                         [](const auto& of) { return of.param ? "Camera" : "Incoherent"; });

}  // namespace
}  // namespace collided::engine
