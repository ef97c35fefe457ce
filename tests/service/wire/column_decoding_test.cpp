// Probe readings, columns of numbers, names and instants as they come over the wire.
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

TEST(ProbeDecoding, EveryFieldOfAReadingIsItsOwn) {
  Names names;
  ProbeMessage frame;
  std::vector<ProbeReading> readings;
  ASSERT_TRUE(client::decode(frame.message(), names, readings));
  ASSERT_EQ(readings.size(), 3u);
  const Clearance states[] = {Clearance::gap, Clearance::absent, Clearance::undecided};
  const char* probes[] = {"p", "q", "r"};
  const char* objects[] = {"car", "", "#3"};
  const char* met[] = {"road", "", "#6"};
  for (std::size_t i = 0; i < 3; ++i) {
    const ProbeReading& reading = readings[i];
    const double first = 100 + 8 * static_cast<double>(i);
    EXPECT_EQ(reading.probe, probes[i]);
    EXPECT_EQ(reading.object, objects[i]);
    EXPECT_EQ(reading.met, met[i]);
    EXPECT_EQ(reading.state, states[i]);
    EXPECT_EQ(reading.clearance_m, first);
    EXPECT_EQ(reading.error_m, first + 1);
    EXPECT_EQ(reading.point, three(first + 2));
    EXPECT_EQ(reading.normal, three(first + 5));
    EXPECT_EQ(reading.triangle, frame.triangles[i]);
    EXPECT_EQ(reading.epoch, 80u);
    EXPECT_EQ(reading.version, 81u);
    EXPECT_EQ(reading.world_time, nanoseconds(82));
  }
  const std::vector<std::pair<const char*, std::function<void(ProbeMessage&)>>> spoilers{
      {"states", [](ProbeMessage& f) { f.states.pop_back(); }},
      {"objects", [](ProbeMessage& f) { f.objects.pop_back(); }},
      {"met", [](ProbeMessage& f) { f.met.pop_back(); }},
      {"triangles", [](ProbeMessage& f) { f.triangles.pop_back(); }},
      {"numbers", [](ProbeMessage& f) { f.numbers.pop_back(); }},
      {"a name without its end", [](ProbeMessage& f) { f.probe_names.pop_back(); }},
  };
  for (const auto& [what, spoil] : spoilers) {
    ProbeMessage bad;
    spoil(bad);
    std::vector<ProbeReading> none;
    EXPECT_FALSE(client::decode(bad.message(), names, none)) << what;
    EXPECT_TRUE(none.empty()) << what;
  }
}

/// Whether `take` still takes a message of which one column of numbers, each in turn, is a number short.
template <class Message, class Take>
void expect_each_column_counts(Message& message, wire::Columns<Message> columns, Take&& take) {
  for (const wire::Column<Message>& column : columns) {
    dds_sequence_double& sequence = message.*column.sequence;
    --sequence._length;
    EXPECT_FALSE(take(message)) << "column " << &column - columns.data();
    ++sequence._length;
  }
  EXPECT_TRUE(take(message));
}

TEST(WireColumns, AMessageWithOneShortColumnIsRefused) {
  Names names;
  ReplyMessage reply;
  expect_each_column_counts<wire::Reply>(reply.message(), wire::kHitColumns, [](const wire::Reply& message) {
    Names own;
    return !AnswerCollector(3, 3, own).add(message);
  });
  FrameMessage frame;
  frame.message();
  expect_each_column_counts<wire::EventFrame>(frame.frame, wire::kEventColumns, [&](const wire::EventFrame& message) {
    return client::decode(message, names).has_value();
  });
  ShardMessage shard;
  shard.message();
  expect_each_column_counts<wire::ContactShard>(
      shard.shard, wire::kContactColumns,
      [&](const wire::ContactShard& message) { return client::decode(message, names).has_value(); });
  ProbeMessage probe;
  probe.message();
  expect_each_column_counts<wire::ProbeFrame>(probe.frame, wire::kProbeColumns, [&](const wire::ProbeFrame& message) {
    std::vector<ProbeReading> readings;
    return client::decode(message, names, readings);
  });
}

TEST(WireColumns, RowsComeBackAsTheyWere) {
  using wire_contract::QuestionKind;
  for (const QuestionKind kind : {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box, QuestionKind::near,
                                  QuestionKind::sweep, QuestionKind::inside}) {
    const wire::Columns<wire::Query> columns = wire::question_columns(kind);
    ASSERT_EQ(wire::width_of(columns), wire_contract::numbers_of(kind));
    dds::Sample<wire::Query> query;
    query->kind = static_cast<std::uint8_t>(kind);
    const std::vector<double> rows = counted<double>(3 * wire::width_of(columns), 1);
    test::put_questions(*query, rows);
    EXPECT_EQ(wire::question_count(*query), 3u);
    EXPECT_EQ(test::rows_of(*query, columns), rows);
    std::vector<double> memory;
    const std::vector<double> none;
    for (const QuestionKind other : {QuestionKind::ray, QuestionKind::box, QuestionKind::sphere, QuestionKind::sweep}) {
      for (const wire::Column<wire::Query>& column : wire::question_columns(other)) {
        const bool is_own = std::any_of(columns.begin(), columns.end(),
                                        [&](const auto& own) { return own.sequence == column.sequence; });
        if (is_own) continue;
        const std::vector<double> strange(3 * column.width);
        dds::borrow((*query).*column.sequence, strange);
        EXPECT_EQ(wire::question_count(*query), std::nullopt) << "a column of another kind";
        dds::borrow((*query).*column.sequence, none);
      }
    }
  }
}

TEST(NamesOfIds, ASlotUsedAgainHasItsNewName) {
  Names names;
  const std::uint64_t first = 5, second = 5 + (std::uint64_t{1} << 32), other = 6;
  names.learn(std::vector{first, other}, wire_contract::pack_names(std::vector<std::string>{"old", "other"}));
  EXPECT_EQ(names.name(first), "old");
  EXPECT_EQ(names.name(second), "#4294967301");
  names.learn(std::vector{second}, wire_contract::pack_names(std::vector<std::string>{"new"}));
  EXPECT_EQ(names.name(second), "new");
  EXPECT_EQ(names.name(first), "#5");
  EXPECT_EQ(names.name(other), "other");
  names.learn(std::vector{second}, wire_contract::pack_names(std::vector<std::string>{"renamed"}));
  EXPECT_EQ(names.name(second), "renamed");
}

TEST(AskedInstant, IsReadAsItIsWrittenAndNothingElseIs) {
  using wire_contract::asked_instant;
  using wire_contract::AskedInstant;
  using InstantKind = AskedInstant::Kind;
  for (const AskedInstant& instant :
       {AskedInstant{}, AskedInstant{InstantKind::settled, 0}, AskedInstant{InstantKind::at, 1'795'348'990'500'000'000},
        AskedInstant{InstantKind::at, 0}, AskedInstant{InstantKind::back, 0},
        AskedInstant{InstantKind::back, 2'000'000'000}}) {
    EXPECT_EQ(asked_instant(wire_contract::text_of(instant)), instant) << wire_contract::text_of(instant);
  }
  EXPECT_EQ(wire_contract::text_of(AskedInstant{InstantKind::back, 5}), "-5");
  for (const char* text : {"latest", "settled ", "-", "--5", "5s", " 5", "1e9", "99999999999999999999"}) {
    EXPECT_EQ(asked_instant(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace collided
