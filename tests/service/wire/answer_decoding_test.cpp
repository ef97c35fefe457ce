// Answers as they come over the wire, field by field, and which are refused.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numeric>

#include "client/library/asking/answer_decoding.hpp"
#include "client/library/watching/probes.hpp"
#include "client/library/watching/watch_decoding.hpp"
#include "idl/instant.hpp"
#include "idl/topics.hpp"
#include "tests/service/wire/decoding_messages.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided {
namespace {

TEST(AnswerDecoding, EveryFieldOfAnAnswerIsItsOwn) {
  Names names;
  AnswerCollector collector(3, 3, names);
  ReplyMessage reply;
  ASSERT_FALSE(collector.add(reply.message()));
  ASSERT_TRUE(collector.complete());
  EXPECT_EQ(collector.chunks_answered(), 1u);
  const Answers answers = collector.take();
  EXPECT_EQ(answers.epoch, 40u);
  EXPECT_EQ(answers.version, 41u);
  EXPECT_EQ(answers.world_time, nanoseconds(42));
  EXPECT_EQ(answers.oldest_pose_age, nanoseconds(43));
  EXPECT_EQ(answers.compute, nanoseconds(44));
  ASSERT_EQ(answers.answers.size(), 3u);
  const Verdict verdicts[] = {Verdict::miss, Verdict::hit, Verdict::undecided};
  const UndecidedReason reasons[] = {UndecidedReason::none, UndecidedReason::none, UndecidedReason::truncated};
  const int levels[] = {1, 2, 0};
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Answer& answer = answers.answers[i];
    EXPECT_EQ(answer.verdict, verdicts[i]);
    EXPECT_EQ(answer.reason, reasons[i]);
    EXPECT_EQ(answer.cost.nodes, 10 + i);
    EXPECT_EQ(answer.cost.exact_tests, 20 + i);
    EXPECT_EQ(answer.cost.level, levels[i]);
    EXPECT_EQ(answer.hits.size(), i == 1 ? 2u : 0u);
    EXPECT_FALSE(answer.uncovered);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const Hit& hit = answers.answers[1].hits[i];
    const double first = 100 + 13 * static_cast<double>(i);
    EXPECT_EQ(hit.object, i == 0 ? "seven" : "nine");
    EXPECT_EQ(hit.object_id, reply.objects[i]);
    EXPECT_EQ(hit.triangle, i == 0 ? 30u : kNoTriangle);
    EXPECT_EQ(hit.distance_m, first);
    EXPECT_EQ(hit.error_m, first + 1);
    EXPECT_EQ(hit.exit_m, first + 2);
    EXPECT_EQ(hit.point, three(first + 3));
    EXPECT_EQ(hit.normal, three(first + 6));
    EXPECT_EQ(hit.weights, three(first + 9));
    EXPECT_EQ(hit.point_error_m, first + 12);
    EXPECT_EQ(hit.inside, i == 0);
    EXPECT_EQ(hit.stale, i == 1);
  }
}

/// A reply with one miss of so many nodes for each of the questions from `first` on.
ReplyMessage misses(std::uint32_t first, std::size_t count) {
  ReplyMessage reply;
  reply.reply.first_question = first;
  reply.answers.assign(count, 0);
  reply.reasons.assign(count, 0);
  reply.levels.assign(count, 0);
  reply.hit_counts.assign(count, 0);
  reply.nodes = counted<std::uint32_t>(count, first + 1);
  reply.exact_tests.assign(count, 0);
  reply.objects.clear();
  reply.triangles.clear();
  reply.hit_flags.clear();
  reply.numbers.clear();
  return reply;
}

// Of two chunks one was answered on another state of the world: no answer is better than half of each.
TEST(AnswerDecoding, OneRequestAnsweredOnTwoStatesIsRefused) {
  const auto second_of = [](const std::function<void(wire::Reply&)>& change) {
    Names names;
    AnswerCollector collector(4, 2, names);
    ReplyMessage first = misses(0, 2);
    ReplyMessage second = misses(2, 2);
    EXPECT_FALSE(collector.add(first.message()));
    change(second.reply);
    return collector.add(second.message());
  };
  EXPECT_FALSE(second_of([](wire::Reply&) {}));
  for (const auto& change : std::vector<std::function<void(wire::Reply&)>>{
           [](wire::Reply& reply) { ++reply.version; }, [](wire::Reply& reply) { --reply.version; },
           [](wire::Reply& reply) { ++reply.epoch; }, [](wire::Reply& reply) { --reply.epoch; }}) {
    const std::optional<Error> error = second_of(change);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code, ErrorCode::internal);
    EXPECT_EQ(error->message.find("the server's reply makes no sense: one request answered on versions 41 and "), 0u)
        << error->message;
  }
}

// The first reply brings the state, also where the memory of an earlier request comes with another.
TEST(AnswerDecoding, TheMemoryOfAnEarlierRequestBringsNoState) {
  Names names;
  Answers earlier;
  earlier.epoch = 1;
  earlier.version = 2;
  earlier.oldest_pose_age = nanoseconds(900);
  earlier.compute = nanoseconds(901);
  earlier.answers.resize(5);
  for (Answer& answer : earlier.answers) {
    answer.verdict = Verdict::hit;
    answer.hits.resize(3);
    answer.uncovered = Uncovered{};
  }
  AnswerCollector collector(2, 2, names, std::move(earlier));
  ReplyMessage reply = misses(0, 2);
  reply.reply.oldest_pose_age_ns = -1;
  ASSERT_FALSE(collector.add(reply.message()));
  const Answers answers = collector.take();
  EXPECT_EQ(answers.version, 41u);
  EXPECT_EQ(answers.compute, nanoseconds(44));
  EXPECT_FALSE(answers.oldest_pose_age);
  ASSERT_EQ(answers.answers.size(), 2u);
  for (const Answer& answer : answers.answers) {
    EXPECT_EQ(answer.verdict, Verdict::miss);
    EXPECT_TRUE(answer.hits.empty());
    EXPECT_FALSE(answer.uncovered);
  }
}

// In any order, some twice: each question is answered once, by the first that came.
TEST(AnswerDecoding, ChunksOutOfOrderAndTwiceAreEachTakenOnce) {
  Names names;
  AnswerCollector collector(7, 3, names);
  const auto add = [&](std::uint32_t first, std::size_t count, std::int64_t age_ns, std::uint32_t nodes_more = 0) {
    ReplyMessage reply = misses(first, count);
    reply.reply.oldest_pose_age_ns = age_ns;
    for (std::uint32_t& nodes : reply.nodes) nodes += nodes_more;
    EXPECT_FALSE(collector.add(reply.message()));
  };
  add(6, 1, 50);
  EXPECT_EQ(collector.chunks_answered(), 1u);
  add(3, 3, 70);
  EXPECT_EQ(collector.chunks_answered(), 2u);
  add(3, 3, 9'000, 1'000);
  add(6, 1, 9'000, 1'000);
  EXPECT_EQ(collector.chunks_answered(), 2u) << "twice is once";
  EXPECT_FALSE(collector.complete());
  add(0, 2, -1);
  EXPECT_EQ(collector.chunks_answered(), 2u) << "not all of it";
  EXPECT_FALSE(collector.complete());
  add(1, 2, 60, 100);  // 1 is answered, 2 is not
  EXPECT_EQ(collector.chunks_answered(), 3u);
  ASSERT_TRUE(collector.complete());
  const Answers answers = collector.take();
  const std::uint32_t nodes[] = {1, 2, 103, 4, 5, 6, 7};
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(answers.answers[i].cost.nodes, nodes[i]) << i;
  EXPECT_EQ(answers.oldest_pose_age, nanoseconds(70)) << "the oldest of those that were taken";
  EXPECT_EQ(answers.compute, nanoseconds(4 * 44)) << "of those that were taken";
}

TEST(AnswerDecoding, AReplyThatDoesNotFitIsRefused) {
  const std::vector<std::pair<const char*, std::function<void(ReplyMessage&)>>> spoilers{
      {"a question beyond the last", [](ReplyMessage& r) { r.reply.first_question = 1; }},
      {"far beyond", [](ReplyMessage& r) { r.reply.first_question = 0xffffffff; }},
      {"reasons", [](ReplyMessage& r) { r.reasons.pop_back(); }},
      {"levels", [](ReplyMessage& r) { r.levels.pop_back(); }},
      {"hit counts", [](ReplyMessage& r) { r.hit_counts.pop_back(); }},
      {"nodes", [](ReplyMessage& r) { r.nodes.pop_back(); }},
      {"exact tests", [](ReplyMessage& r) { r.exact_tests.pop_back(); }},
      {"fewer hits than said", [](ReplyMessage& r) { r.hit_counts[1] = 1; }},
      {"more hits than said", [](ReplyMessage& r) { r.hit_counts[2] = 1; }},
      {"objects", [](ReplyMessage& r) { r.objects.pop_back(); }},
      {"triangles", [](ReplyMessage& r) { r.triangles.pop_back(); }},
      {"flags", [](ReplyMessage& r) { r.hit_flags.pop_back(); }},
      {"numbers", [](ReplyMessage& r) { r.numbers.pop_back(); }},
      {"an unknown answer", [](ReplyMessage& r) { r.answers[2] = 4; }},
      {"an unknown reason", [](ReplyMessage& r) { r.reasons[2] = 7; }},
  };
  for (const auto& [what, spoil] : spoilers) {
    Names names;
    AnswerCollector collector(3, 3, names);
    ReplyMessage bad;
    spoil(bad);
    const std::optional<Error> error = collector.add(bad.message());
    ASSERT_TRUE(error) << what;
    EXPECT_EQ(error->code, ErrorCode::internal) << what;
    EXPECT_FALSE(collector.complete());
    ReplyMessage good;
    EXPECT_FALSE(collector.add(good.message())) << "what was refused left nothing behind: " << what;
  }
  Names names;
  AnswerCollector collector(3, 3, names);
  ReplyMessage edge;
  edge.answers[2] = 3;
  edge.reasons[2] = 6;
  ASSERT_FALSE(collector.add(edge.message()));
  const Answers answers = collector.take();
  EXPECT_EQ(answers.answers[2].verdict, Verdict::invalid);
  EXPECT_EQ(answers.answers[2].reason, UndecidedReason::not_covered);
}

TEST(AnswerDecoding, ARefusalIsItsTextWhateverThatIs) {
  EXPECT_EQ(client::refusal(R"({"error":"no","hint":"do"})").message, "server refused: no");
  EXPECT_EQ(client::refusal(R"({"error":"no","hint":"do"})").hint, "do");
  EXPECT_EQ(client::refusal(R"({"error":"no"})").hint, "");
  for (const char* odd : {"", "plain words", "[1]", "{", R"({"error":7})"})
    EXPECT_EQ(client::refusal(odd).message, std::string("server refused: ") + odd);
}

TEST(AnswerDecoding, WhatIsNotCoveredIsOfItsQuestionAndNoHit) {
  Names names;
  AnswerCollector collector(3, 3, names);
  ReplyMessage reply;
  reply.answers[2] = 2;
  reply.reasons[2] = static_cast<std::uint8_t>(UndecidedReason::not_covered);
  const std::vector<std::uint32_t> questions{2};
  const std::vector<double> where{7, 8, 9, 10};
  std::vector<double> memory;
  dds::borrow(reply.reply.uncovered_questions, questions);
  wire::lend_columns<wire::Reply>(where, wire::kUncoveredColumns, memory, reply.reply);
  ASSERT_FALSE(collector.add(reply.message()));
  const Answers answers = collector.take();
  EXPECT_FALSE(answers.answers[0].uncovered);
  EXPECT_FALSE(answers.answers[1].uncovered);
  ASSERT_TRUE(answers.answers[2].uncovered);
  EXPECT_EQ(answers.answers[2].uncovered->point, Vec3(7, 8, 9));
  EXPECT_EQ(answers.answers[2].uncovered->covered_m, 10);
  EXPECT_TRUE(answers.answers[2].hits.empty());
}

// Also where the memory of the answers held rays before.
TEST(AnswerDecoding, ASweepsBracketIsTheTimesOfItsHit) {
  Names names;
  AnswerCollector of_rays(3, 3, names);
  ReplyMessage reply;
  ASSERT_FALSE(of_rays.add(reply.message()));
  AnswerCollector collector(3, 3, names, of_rays.take());
  for (auto* column : {&reply.reply.distances, &reply.reply.distance_errors, &reply.reply.exits}) *column = {};
  std::vector<double> memory;
  wire::lend_columns<wire::Reply>(reply.numbers, wire::kSweepHitColumns, memory, reply.reply);
  ASSERT_FALSE(collector.add(reply.reply));
  const Answers answers = collector.take();
  ASSERT_EQ(answers.answers[1].hits.size(), 2u);
  EXPECT_EQ(answers.answers[1].hits[1].time_high, 113);
  EXPECT_EQ(answers.answers[1].hits[1].time_low, 115);
  EXPECT_EQ(answers.answers[1].hits[1].distance_m, 0);
  EXPECT_EQ(answers.answers[1].hits[1].error_m, 0);
  EXPECT_EQ(answers.answers[1].hits[1].exit_m, 0);
  EXPECT_EQ(answers.answers[1].hits[1].point, three(116));
}

// A slot that is used again has the newer object's name, and an id that is not known has none of another's.

}  // namespace
}  // namespace collided
