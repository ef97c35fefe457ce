#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/oracle/mixed_world.hpp"
#include "tests/oracle/seed.hpp"

// The index, the filters and the walks against a twin that tests every part of every object.  // A43 A50 A51 B2
namespace collided::engine {
namespace {

using oracle::MixedWorld;

void expect_same_bits(const AnswerHit& a, const AnswerHit& b) {
  EXPECT_EQ(a.object, b.object);
  EXPECT_EQ(a.triangle, b.triangle);
  EXPECT_EQ(a.flags, b.flags);
  for (const auto& [x, y] :
       {std::pair(a.distance_m, b.distance_m), std::pair(a.error_m, b.error_m), std::pair(a.exit_m, b.exit_m)}) {
    EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0) << x << " " << y;
  }
  EXPECT_EQ(a.point, b.point);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.weights, b.weights);
}

void expect_equal(const Snapshot& snapshot, const Questions& questions) {
  Answers fast, slow;
  QueryScratch scratch;
  answer(snapshot, questions, fast, scratch);
  oracle::answer(snapshot, questions, slow);
  ASSERT_EQ(fast.answers, slow.answers);
  ASSERT_EQ(fast.hit_counts, slow.hit_counts);
  ASSERT_EQ(fast.hits.size(), slow.hits.size());
  for (std::size_t i = 0; i < fast.hits.size(); ++i) {
    expect_same_bits(fast.hits[i], slow.hits[i]);
    if (testing::Test::HasFailure()) FAIL() << "hit " << i << " of kind " << static_cast<int>(questions.kind);
  }
}

TEST(WorldOracle, EveryQuestionEqualsBruteForceBitForBit) {
  std::mt19937_64 random = oracle::seeded(11);
  MixedWorld mixed(random);
  mixed.add_half_spaces();
  const SnapshotRing::Lease lease = mixed.world.newest();
  for (const HitMode mode : {HitMode::closest, HitMode::all}) {
    Questions questions;
    questions.kind = QuestionKind::ray;
    questions.mode = mode;
    std::vector<double> numbers;
    for (int i = 0; i < 2'000; ++i) {
      const Vec3 from = mixed.point(6);
      const Vec3 direction = i % 4 == 0 ? Vec3(0, 0, -1) : mixed.point(1);
      const double length = i % 3 == 0 ? mixed.uniform(0, 8) : INFINITY;
      for (const double x : {from.x(), from.y(), from.z(), direction.x(), direction.y(), direction.z(), length}) {
        numbers.push_back(x);
      }
    }
    questions.numbers = numbers;
    questions.mask = mode == HitMode::all ? 2 : 0xffffffff;
    expect_equal(*lease, questions);
  }
  for (const QuestionKind kind : {QuestionKind::sphere, QuestionKind::box, QuestionKind::near}) {
    Questions questions;
    questions.kind = kind;
    std::vector<double> numbers;
    for (int i = 0; i < 500; ++i) {
      const Pose pose = mixed.pose();
      for (int k = 0; k < 3; ++k) numbers.push_back(pose.position[k]);
      if (kind == QuestionKind::near) numbers.push_back(i % 2 == 0 ? INFINITY : mixed.uniform(0, 3));
      if (kind == QuestionKind::sphere) numbers.push_back(mixed.uniform(0, 1.5));
      if (kind != QuestionKind::box) continue;
      for (int k = 0; k < 3; ++k) numbers.push_back(mixed.uniform(0, 1));
      for (const double x : {pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z()}) {
        numbers.push_back(x);
      }
    }
    questions.numbers = numbers;
    questions.max_hits = kind == QuestionKind::near ? 3 : 1000;
    expect_equal(*lease, questions);
  }
}

TEST(WorldOracle, OpenContactsEqualBruteForceAfterEveryStep) {
  std::mt19937_64 random = oracle::seeded(12);
  MixedWorld mixed(random);
  std::set<std::pair<ObjectId, ObjectId>> open_by_events;
  const auto apply = [&](const Event& event) {
    const auto pair = std::pair(event.of.a, event.of.b);
    if (event.kind == EventKind::began) {
      EXPECT_TRUE(open_by_events.insert(pair).second) << "began twice";
    } else {
      EXPECT_EQ(open_by_events.erase(pair), 1u) << "ended without began";
    }
  };
  for (const Event& event : mixed.world.events()) apply(event);
  std::uint64_t last_sequence = mixed.world.last_event_sequence();
  std::size_t contacts_seen = 0;
  for (std::int64_t step = 1; step <= 60; ++step) {
    for (const ObjectId id : mixed.movers()) {
      if (mixed.uniform(0, 1) < 0.4) mixed.world.move(id, mixed.pose(), step * 1'000'000, step % 10 == 0);
    }
    ASSERT_TRUE(mixed.world.step(step * 1'000'000, 1, {.contacts = step % 2 == 0, .persisted = false}));
    for (const Event& event : mixed.world.events()) {
      EXPECT_EQ(event.sequence, ++last_sequence) << "sequences have no gap";
      apply(event);
    }
    const auto expected = oracle::touching_pairs(*mixed.world.newest());
    EXPECT_EQ(open_by_events, expected) << "step " << step;
    contacts_seen += expected.size();
    if (HasFailure()) return;
  }
  EXPECT_GT(contacts_seen, 500u) << "the scene must be worth testing";
}

}  // namespace
}  // namespace collided::engine
