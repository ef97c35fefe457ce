// What a thread keeps between questions belongs to the question before: with one thing changed, the next answer is that
// of a thread that was never asked anything.
#include <gtest/gtest.h>

#include <cmath>

#include "server/world/query/query.hpp"
#include "tests/oracle/mixed_world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using oracle::MixedWorld;

bool are_same(const AnswerHit& a, const AnswerHit& b) {
  return a.object == b.object && a.triangle == b.triangle && a.flags == b.flags && a.distance_m == b.distance_m &&
         a.error_m == b.error_m && a.exit_m == b.exit_m && a.point == b.point && a.point_error_m == b.point_error_m &&
         a.normal == b.normal && a.weights == b.weights;
}

bool are_same(const TimeBracket& a, const TimeBracket& b) { return a.low == b.low && a.high == b.high; }

bool are_same(const Answers& a, const Answers& b) {
  return a.answers == b.answers && a.reasons == b.reasons && a.levels == b.levels && a.hit_counts == b.hit_counts &&
         a.nodes == b.nodes && a.exact_tests == b.exact_tests && a.oldest_pose_ns == b.oldest_pose_ns &&
         std::equal(a.hits.begin(), a.hits.end(), b.hits.begin(), b.hits.end(),
                    [](const AnswerHit& x, const AnswerHit& y) { return are_same(x, y); }) &&
         std::equal(a.brackets.begin(), a.brackets.end(), b.brackets.begin(), b.brackets.end(),
                    [](const TimeBracket& x, const TimeBracket& y) { return are_same(x, y); });
}

std::vector<double> numbers_of(QuestionKind kind, MixedWorld& mixed, int count) {
  std::vector<double> numbers;
  for (int i = 0; i < count; ++i) {
    const Vec3 at = mixed.point(3);
    numbers.insert(numbers.end(), at.begin(), at.end());
    if (kind == QuestionKind::ray) {
      const Vec3 direction = mixed.point(3) - at;
      numbers.insert(numbers.end(), direction.begin(), direction.end());
      numbers.push_back(INFINITY);
    } else if (kind == QuestionKind::box) {
      numbers.insert(numbers.end(), {1, 0.5, 0.25, 0.6, 0, 0.8, 0});
    } else {
      numbers.push_back(1);
    }
  }
  return numbers;
}

/// Threads that answer: one that has been asked before, and a new one for every question.
struct Asked {
  Answers kept;
  QueryScratch scratch;
  Answers last;  // of the new thread

  bool agrees(const Snapshot& snapshot, const Questions& questions) {
    last = {};
    QueryScratch fresh;
    answer(snapshot, questions, last, fresh);
    answer(snapshot, questions, kept, scratch);
    return are_same(kept, last);
  }
};

class WorldAskedAgain : public testing::TestWithParam<QuestionKind> {
 protected:
  std::mt19937_64 random = oracle::seeded(71);
  MixedWorld mixed{random};
  std::vector<double> numbers = numbers_of(GetParam(), mixed, 100);
};

TEST_P(WorldAskedAgain, EachFilterIsThatOfItsOwnQuestion) {
  const Questions plain{.kind = GetParam(), .mode = HitMode::all, .numbers = numbers};
  std::vector<std::pair<const char*, Questions>> filters(7, {"", plain});
  filters[0] = {"none", plain};
  filters[1].first = "mask 1", filters[1].second.mask = 1;
  filters[2].first = "mask 2", filters[2].second.mask = 2;
  filters[3].first = "only objects", filters[3].second.only = "object*";
  filters[4].first = "only parts", filters[4].second.only = "sheet/1*";
  filters[5].first = "skip objects", filters[5].second.skip = "object*";
  filters[6].first = "skip parts", filters[6].second.skip = "sheet/1*";
  const auto state = (*mixed).newest();
  Asked asked;
  for (const auto& [before, first] : filters) {
    for (const auto& [now, second] : filters) {
      ASSERT_TRUE(asked.agrees(*state, first)) << before;
      const Answers of_first = asked.last;
      ASSERT_TRUE(asked.agrees(*state, second)) << now << " after " << before;
      EXPECT_TRUE(&first == &second || !are_same(asked.last, of_first))
          << now << " and " << before << " show no difference";
    }
  }
}

TEST_P(WorldAskedAgain, EveryOtherWordIsThatOfItsOwnQuestion) {
  const Questions plain{.kind = GetParam(), .numbers = numbers};
  std::vector<Questions> all(7, plain);
  all[1].mode = HitMode::any;
  all[2].mode = HitMode::all;
  all[3].max_hits = 1;
  all[4].error_m = 0.1;
  all[5].highest = Level::filter;
  all[6].deadline_ns = 1;
  const auto state = (*mixed).newest();
  Asked asked;
  for (const Questions& first : all) {
    for (const Questions& second : all) {
      ASSERT_TRUE(asked.agrees(*state, first));
      ASSERT_TRUE(asked.agrees(*state, second));
    }
  }
}

// Objects come, go and take each other's slots; scenes come and go. What may answer is worked out anew.
TEST_P(WorldAskedAgain, WhatCameOrWentSinceIsSeen) {
  const Questions questions{.kind = GetParam(), .mode = HitMode::all, .only = "[gs]*", .numbers = numbers};
  Asked asked;
  std::optional<ObjectId> giant;
  std::int64_t time_ns = 1;
  for (const bool is_there : {false, true, false, true}) {
    if (is_there) {
      ObjectDefinition definition;
      definition.name = "giant";
      definition.shape.primitives.push_back(Sphere{Vec3::Zero(), 2.5});
      giant = std::get<ObjectId>((*mixed).define(definition));
    } else if (giant) {
      (*mixed).remove(*giant, EndReason::removed);
    }
    (*mixed).step(++time_ns, 1, {});
    ASSERT_TRUE(asked.agrees(*(*mixed).newest(), questions));
    const bool is_found = std::any_of(asked.last.hits.begin(), asked.last.hits.end(),
                                      [&](const AnswerHit& hit) { return giant && hit.object == *giant; });
    EXPECT_EQ(is_found, is_there);
  }
  (*mixed).remove_scene("sheet");
  (*mixed).step(++time_ns, 1, {});
  ASSERT_TRUE(asked.agrees(*(*mixed).newest(), questions));
}

// A server keeps one world, but its audit and a replay ask several with one thread.
TEST_P(WorldAskedAgain, AnotherWorldIsAnotherOne) {
  std::mt19937_64 other_random = oracle::seeded(72);
  MixedWorld other(other_random);
  ObjectDefinition definition;
  definition.name = "object_more";
  definition.shape.primitives.push_back(Sphere{Vec3::Zero(), 2.5});
  (*other).define(definition);
  (*other).step(2, 1, {});
  definition.name = "more";
  (*mixed).define(definition);
  (*mixed).step(2, 1, {});
  const Questions questions{.kind = GetParam(), .mode = HitMode::all, .only = "object*", .numbers = numbers};
  const auto one = (*mixed).newest();
  const auto two = (*other).newest();
  ASSERT_NE(one->objects.version(), two->objects.version());
  Asked asked;
  for (const Snapshot* state : {&*one, &*two, &*one}) ASSERT_TRUE(asked.agrees(*state, questions));
}

// A state that is still held is not changed by what came after it, nor by who asked about that.
TEST_P(WorldAskedAgain, AnOlderStateIsAnsweredAsItWas) {
  const Questions questions{.kind = GetParam(), .mode = HitMode::all, .skip = "many*", .numbers = numbers};
  Asked asked;
  const auto before = (*mixed).newest();
  ASSERT_TRUE(asked.agrees(*before, questions));
  const Answers first = asked.last;
  ObjectDefinition definition;
  definition.name = "giant";
  definition.shape.primitives.push_back(Sphere{Vec3::Zero(), 2.5});
  (*mixed).define(definition);
  for (const ObjectId id : mixed.movers()) (*mixed).move(id, mixed.pose(), 1, true);
  (*mixed).step(2, 1, {});
  ASSERT_TRUE(asked.agrees(*(*mixed).newest(), questions));
  EXPECT_FALSE(are_same(first, asked.last));
  ASSERT_TRUE(asked.agrees(*before, questions));
  EXPECT_TRUE(are_same(first, asked.last));
}

INSTANTIATE_TEST_SUITE_P(EveryKind, WorldAskedAgain,
                         testing::Values(QuestionKind::ray, QuestionKind::sphere, QuestionKind::box,
                                         QuestionKind::near),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

}  // namespace
}  // namespace collided::engine
