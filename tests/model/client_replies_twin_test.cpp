#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "client/library/asking/answer_decoding.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/wire/rows.hpp"
#include "tests/model/rounds_asked.hpp"

// Replies in pieces, twice, out of turn, with holes and from other states of the world, beside a plain table of answers.
namespace collided {
namespace {

/// A reply with the memory that it borrows.
struct Piece {
  std::uint32_t first = 0;
  std::vector<std::uint8_t> verdicts, reasons, levels, flags;
  std::vector<std::uint32_t> hit_counts, nodes, tests, triangles;
  std::vector<std::uint64_t> objects;
  std::vector<double> numbers;
  std::uint64_t epoch = 3, version = 5;
  std::int64_t compute_ns = 0, age_ns = -1, world_time_ns = 77;

  std::optional<Error> give(client::AnswerCollector& collector) const {
    dds::Sample<wire::Reply> reply;
    reply->first_question = first;
    reply->epoch = epoch;
    reply->version = version;
    reply->compute_ns = compute_ns;
    reply->oldest_pose_age_ns = age_ns;
    reply->world_time_ns = world_time_ns;
    dds::borrow(reply->answers, verdicts);
    dds::borrow(reply->reasons, reasons);
    dds::borrow(reply->levels, levels);
    dds::borrow(reply->hit_counts, hit_counts);
    dds::borrow(reply->nodes, nodes);
    dds::borrow(reply->exact_tests, tests);
    dds::borrow(reply->objects, objects);
    dds::borrow(reply->triangles, triangles);
    dds::borrow(reply->hit_flags, flags);
    test::put_rows<wire::Reply>(*reply, wire::kHitColumns, numbers);
    return collector.add(*reply);
  }
};

class RepliesTwin : public testing::Test {
 protected:
  std::uint32_t below(std::uint32_t count) {
    return std::uniform_int_distribution<std::uint32_t>(0, count - 1)(random_);
  }
  bool chance(double probability) { return std::uniform_real_distribution<double>(0, 1)(random_) < probability; }

  Piece piece(std::uint32_t first, std::uint32_t count) {
    Piece made;
    made.first = first;
    for (std::uint32_t i = 0; i < count; ++i) {
      made.verdicts.push_back(static_cast<std::uint8_t>(below(4)));
      made.reasons.push_back(static_cast<std::uint8_t>(below(7)));
      made.levels.push_back(static_cast<std::uint8_t>(below(5)));
      made.nodes.push_back(below(1'000));
      made.tests.push_back(below(1'000));
      made.hit_counts.push_back(below(4));
      for (std::uint32_t k = 0; k < made.hit_counts.back(); ++k) {
        made.objects.push_back(1 + below(9));
        made.triangles.push_back(below(99));
        made.flags.push_back(static_cast<std::uint8_t>((chance(0.3) ? wire_contract::kHitInside : 0) |
                                                       (chance(0.3) ? wire_contract::kHitStale : 0)));
        for (std::uint32_t n = 0; n < wire_contract::kHitNumbers; ++n) made.numbers.push_back(below(1'000'000) * 0.001);
      }
    }
    made.compute_ns = below(1'000);
    made.age_ns = chance(0.5) ? -1 : static_cast<std::int64_t>(below(1'000));
    return made;
  }
  static void expect_answer(const Answer& answer, const Piece& from, std::size_t i, std::size_t hit) {
    EXPECT_EQ(static_cast<int>(answer.verdict), from.verdicts[i]);
    EXPECT_EQ(static_cast<int>(answer.reason), from.reasons[i]);
    EXPECT_EQ(answer.cost.nodes, from.nodes[i]);
    EXPECT_EQ(answer.cost.exact_tests, from.tests[i]);
    EXPECT_EQ(answer.cost.level, from.levels[i]);
    ASSERT_EQ(answer.hits.size(), from.hit_counts[i]);
    for (const Hit& told : answer.hits) {
      const double* n = &from.numbers[hit * wire_contract::kHitNumbers];
      EXPECT_EQ(told.object_id, from.objects[hit]);
      EXPECT_EQ(told.object, "#" + std::to_string(from.objects[hit]));
      EXPECT_EQ(told.triangle, from.triangles[hit]);
      EXPECT_EQ(told.inside, (from.flags[hit] & wire_contract::kHitInside) != 0);
      EXPECT_EQ(told.stale, (from.flags[hit] & wire_contract::kHitStale) != 0);
      EXPECT_EQ(told.distance_m, n[0]);
      EXPECT_EQ(told.error_m, n[1]);
      EXPECT_EQ(told.exit_m, n[2]);
      EXPECT_EQ(told.point, Vec3(n[3], n[4], n[5]));
      EXPECT_EQ(told.normal, Vec3(n[6], n[7], n[8]));
      EXPECT_EQ(told.weights, Vec3(n[9], n[10], n[11]));
      EXPECT_EQ(told.point_error_m, n[12]);
      ++hit;
    }
  }
  /// Pieces of one or more questions each, none across another's border.
  std::vector<Piece> cut(std::uint32_t questions) {
    std::vector<Piece> pieces;
    for (std::uint32_t first = 0; first < questions;) {
      const std::uint32_t count = std::min(questions - first, 1 + below(4));
      pieces.push_back(piece(first, count));
      first += count;
    }
    return pieces;
  }
  void expect_odd_one_refused(client::AnswerCollector& collector, std::uint32_t questions, bool has_state) {
    Piece odd = piece(below(questions), 1);
    const std::uint32_t kind = below(has_state ? 5 : 3);
    if (kind == 0) odd.first = questions;
    if (kind == 1) odd.verdicts[0] = 4;
    if (kind == 2) odd.nodes.push_back(1);
    if (kind == 3) ++odd.version;
    if (kind == 4) ++odd.epoch;
    const std::size_t chunks = collector.chunks_answered();
    const bool was_complete = collector.complete();
    EXPECT_TRUE(odd.give(collector).has_value()) << "kind " << kind;
    EXPECT_EQ(collector.chunks_answered(), chunks);
    EXPECT_EQ(collector.complete(), was_complete);
  }
  void run_one() {
    const std::uint32_t questions = 1 + below(20), chunk = 1 + below(6);
    client::Names names;
    client::AnswerCollector collector(questions, chunk, names);
    std::vector<Piece> pieces = cut(questions);
    std::shuffle(pieces.begin(), pieces.end(), random_);
    std::vector<bool> seen(questions, false);
    std::int64_t compute_ns = 0, age_ns = -1;
    for (std::size_t next = 0; next < pieces.size(); ++next) {
      EXPECT_FALSE(collector.complete()) << "a piece is missing";
      if (chance(0.3)) expect_odd_one_refused(collector, questions, next > 0);
      const Piece& given = pieces[next];
      EXPECT_FALSE(given.give(collector));
      for (std::size_t i = 0; i < given.verdicts.size(); ++i) seen[given.first + i] = true;
      compute_ns += given.compute_ns;
      age_ns = std::max(age_ns, given.age_ns);
      // The same questions again, with other answers: the first ones stay.
      Piece again = chance(0.5) ? given : piece(given.first, static_cast<std::uint32_t>(given.verdicts.size()));
      again.age_ns = -1;
      const bool is_refused = chance(0.4) && again.give(collector).has_value();
      EXPECT_FALSE(is_refused);
      std::size_t whole = 0;
      for (std::uint32_t from = 0; from < questions; from += chunk) {
        const auto end = seen.begin() + std::min(questions, from + chunk);
        whole += std::find(seen.begin() + from, end, false) == end ? 1 : 0;
      }
      EXPECT_EQ(collector.chunks_answered(), whole);
    }
    ASSERT_TRUE(collector.complete());
    const Answers answers = collector.take();
    EXPECT_EQ(answers.epoch, 3u);
    EXPECT_EQ(answers.version, 5u);
    EXPECT_EQ(answers.world_time.count(), 77);
    EXPECT_EQ(answers.compute.count(), compute_ns);
    EXPECT_EQ(answers.oldest_pose_age ? answers.oldest_pose_age->count() : -1, age_ns);
    for (const Piece& given : pieces) {
      std::size_t hit = 0;
      for (std::size_t i = 0; i < given.verdicts.size(); hit += given.hit_counts[i++]) {
        expect_answer(answers.answers[given.first + i], given, i, hit);
      }
    }
  }
  std::mt19937_64 random_{0};
};

TEST_F(RepliesTwin, PiecesTwiceOutOfTurnAndOfOtherStatesMakeTheAnswersThatWereGivenFirst) {
  random_ = oracle::seeded(176);
  for (int round = 0; round < rounds_asked(500) && !HasFailure(); ++round) run_one();
}

}  // namespace
}  // namespace collided
