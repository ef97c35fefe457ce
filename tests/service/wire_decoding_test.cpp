// What comes over the wire, field by field, and what of it is refused.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numeric>

#include "client/library/asking/answer_decoding.hpp"
#include "client/library/watching/probes.hpp"
#include "client/library/watching/watch_decoding.hpp"
#include "idl/instant.hpp"
#include "idl/topics.hpp"
#include "tests/service/wire_rows.hpp"

namespace collided {
namespace {

using client::AnswerCollector;
using client::Names;
using std::chrono::nanoseconds;

/// n, n + 1, ... as the elements of a message's list.
template <class Number>
std::vector<Number> counted(std::size_t count, double first) {
  std::vector<Number> numbers(count);
  std::iota(numbers.begin(), numbers.end(), static_cast<Number>(first));
  return numbers;
}

Vec3 three(double first) { return {first, first + 1, first + 2}; }

/// The answers to three questions, a miss, one with two hits, one undecided: every field has a number of its own.
struct ReplyMessage {
  wire::Reply reply{};
  std::vector<std::uint8_t> answers{0, 1, 2}, reasons{0, 0, 4}, levels{1, 2, 0},
      hit_flags{wire_contract::kInside, wire_contract::kStale};
  std::vector<std::uint32_t> hit_counts{0, 2, 0}, nodes{10, 11, 12}, exact_tests{20, 21, 22},
      triangles{30, wire_contract::kNoTriangle};
  std::vector<std::uint64_t> objects{7, 9 + (std::uint64_t{3} << 32)};
  std::vector<double> numbers = counted<double>(2 * wire_contract::kHitNumbers, 100), columns;
  std::vector<std::uint64_t> named_ids{9 + (std::uint64_t{3} << 32), 7};
  std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"nine", "seven"});

  ReplyMessage() {
    reply.epoch = 40;
    reply.version = 41;
    reply.world_time_ns = 42;
    reply.oldest_pose_age_ns = 43;
    reply.compute_ns = 44;
  }
  wire::Reply& message() {
    dds::borrow(reply.answers, answers);
    dds::borrow(reply.reasons, reasons);
    dds::borrow(reply.levels, levels);
    dds::borrow(reply.hit_flags, hit_flags);
    dds::borrow(reply.hit_counts, hit_counts);
    dds::borrow(reply.nodes, nodes);
    dds::borrow(reply.exact_tests, exact_tests);
    dds::borrow(reply.triangles, triangles);
    dds::borrow(reply.objects, objects);
    wire::lend_columns<wire::Reply>(numbers, wire::kHitColumns, columns, reply);
    dds::borrow(reply.named_ids, named_ids);
    dds::borrow(reply.names, names);
    return reply;
  }
};

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

struct FrameMessage {
  wire::EventFrame frame{};
  std::vector<std::uint8_t> kinds{0, 1, 2}, reasons{0, 0, 7}, doubts{0, 0, 0}, shards{40, 41, 42};
  std::vector<std::uint64_t> a{1, 2, 3}, b{4, 5, 6}, episodes{50, 51, 52};
  std::vector<std::uint32_t> a_triangles{60, 61, wire_contract::kNoTriangle},
      b_triangles{70, wire_contract::kNoTriangle, 72};
  std::vector<double> numbers = counted<double>(3 * wire::width_of<wire::EventFrame>(wire::kEventColumns), 100),
                      columns;
  std::vector<std::uint64_t> named_ids{1, 5};
  std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"one", "five"});

  FrameMessage() {
    frame.server = 80;
    frame.epoch = 81;
    frame.first_sequence = 82;
    frame.version = 83;
    frame.world_time_ns = 84;
  }
  const wire::EventFrame& message() {
    dds::borrow(frame.kinds, kinds);
    dds::borrow(frame.reasons, reasons);
    dds::borrow(frame.shards, shards);
    dds::borrow(frame.a, a);
    dds::borrow(frame.b, b);
    dds::borrow(frame.episodes, episodes);
    dds::borrow(frame.a_triangles, a_triangles);
    dds::borrow(frame.b_triangles, b_triangles);
    dds::borrow(frame.doubts, doubts);
    wire::lend_columns<wire::EventFrame>(numbers, wire::kEventColumns, columns, frame);
    dds::borrow(frame.named_ids, named_ids);
    dds::borrow(frame.names, names);
    return frame;
  }
};

TEST(WatchDecoding, ADoubtHasItsReason) {
  Names names;
  for (const Doubt why : {Doubt::numeric, Doubt::cost_limit, Doubt::publisher_lost}) {
    FrameMessage frame;
    frame.doubts[0] = static_cast<std::uint8_t>(why);
    const auto heard = client::decode(frame.message(), names);
    ASSERT_TRUE(heard);
    EXPECT_EQ(heard->entries[0].event.doubt, why);
    EXPECT_EQ(heard->entries[1].event.doubt, Doubt::none);
  }
  FrameMessage frame;
  frame.doubts[0] = 9;
  EXPECT_EQ(client::decode(frame.message(), names)->entries[0].event.doubt, Doubt::numeric) << "one that came later";
}

TEST(WatchDecoding, EveryFieldOfAnEventIsItsOwn) {
  Names names;
  FrameMessage frame;
  const auto heard = client::decode(frame.message(), names);
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->from.server, 80u);
  EXPECT_EQ(heard->from.epoch, 81u);
  EXPECT_EQ(heard->first_sequence, 82u);
  ASSERT_EQ(heard->entries.size(), 3u);
  const EventKind whats[] = {EventKind::began, EventKind::persisted, EventKind::ended};
  const EndReason whys[] = {EndReason::none, EndReason::none, EndReason::server_restarted};
  const char* a_names[] = {"one", "#2", "#3"};
  const char* b_names[] = {"#4", "five", "#6"};
  for (std::size_t i = 0; i < 3; ++i) {
    const Event& event = heard->entries[i].event;
    const double first = 100 + 19 * static_cast<double>(i);
    EXPECT_EQ(heard->entries[i].shard, 40 + i);
    EXPECT_EQ(event.kind, whats[i]);
    EXPECT_EQ(event.reason, whys[i]);
    EXPECT_FALSE(event.resync);
    EXPECT_EQ(event.a, a_names[i]);
    EXPECT_EQ(event.b, b_names[i]);
    EXPECT_EQ(event.a_id, 1 + i);
    EXPECT_EQ(event.b_id, 4 + i);
    EXPECT_EQ(event.a_triangle, frame.a_triangles[i]);
    EXPECT_EQ(event.b_triangle, frame.b_triangles[i]);
    EXPECT_EQ(event.epoch, 81u);
    EXPECT_EQ(event.episode, 50 + i);
    EXPECT_EQ(event.world_time, nanoseconds(84));
    EXPECT_EQ(event.point, three(first));
    EXPECT_EQ(event.normal, three(first + 3));
    EXPECT_EQ(event.depth_m, first + 6);
    EXPECT_EQ(event.depth_error_m, first + 7);
    EXPECT_EQ(event.surface_normal, three(first + 8));
    EXPECT_EQ(event.surface_depth_m, first + 11);
    EXPECT_EQ(event.surface_depth_error_m, first + 12);
    EXPECT_EQ(event.bracket_low_s, first + 13);
    EXPECT_EQ(event.bracket_high_s, first + 14);
    EXPECT_EQ(event.relative_velocity, three(first + 15));
    EXPECT_EQ(event.velocity_error, first + 18);
  }
}

TEST(WatchDecoding, AFrameWhoseListsDifferIsRefused) {
  const std::vector<std::pair<const char*, std::function<void(FrameMessage&)>>> spoilers{
      {"kinds", [](FrameMessage& f) { f.kinds.pop_back(); }},
      {"reasons", [](FrameMessage& f) { f.reasons.pop_back(); }},
      {"doubts", [](FrameMessage& f) { f.doubts.pop_back(); }},
      {"shards", [](FrameMessage& f) { f.shards.pop_back(); }},
      {"a", [](FrameMessage& f) { f.a.pop_back(); }},
      {"b", [](FrameMessage& f) { f.b.pop_back(); }},
      {"a triangles", [](FrameMessage& f) { f.a_triangles.pop_back(); }},
      {"b triangles", [](FrameMessage& f) { f.b_triangles.pop_back(); }},
      {"episodes", [](FrameMessage& f) { f.episodes.pop_back(); }},
      {"numbers", [](FrameMessage& f) { f.numbers.pop_back(); }},
      {"an unknown kind", [](FrameMessage& f) { f.kinds[1] = 3; }},
      {"an unknown reason", [](FrameMessage& f) { f.reasons[1] = 9; }},
  };
  for (const auto& [what, spoil] : spoilers) {
    Names names;
    FrameMessage bad;
    spoil(bad);
    EXPECT_FALSE(client::decode(bad.message(), names)) << what;
  }
}

struct ShardMessage {
  wire::ContactShard shard{};
  std::vector<std::uint8_t> doubts{0, 2};
  std::vector<std::uint64_t> a{1, 2}, b{4, 5}, episodes{50, 51};
  std::vector<std::uint32_t> a_triangles{60, wire_contract::kNoTriangle}, b_triangles{70, 71};
  std::vector<std::int64_t> began_ns{90, 91};
  std::vector<double> numbers = counted<double>(2 * wire::width_of<wire::ContactShard>(wire::kContactColumns), 100),
                      columns;
  std::vector<std::uint64_t> named_ids{2};
  std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"two"});

  ShardMessage() {
    shard.server = 80;
    shard.shard = 81;
    shard.epoch = 82;
    shard.version = 83;
    shard.as_of_sequence = 84;
  }
  const wire::ContactShard& message() {
    dds::borrow(shard.a, a);
    dds::borrow(shard.b, b);
    dds::borrow(shard.a_triangles, a_triangles);
    dds::borrow(shard.b_triangles, b_triangles);
    dds::borrow(shard.episodes, episodes);
    dds::borrow(shard.began_ns, began_ns);
    dds::borrow(shard.doubts, doubts);
    wire::lend_columns<wire::ContactShard>(numbers, wire::kContactColumns, columns, shard);
    dds::borrow(shard.named_ids, named_ids);
    dds::borrow(shard.names, names);
    return shard;
  }
};

TEST(WatchDecoding, EveryFieldOfAContactIsItsOwn) {
  Names names;
  ShardMessage shard;
  const auto heard = client::decode(shard.message(), names);
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->from.server, 80u);
  EXPECT_EQ(heard->from.epoch, 82u);
  EXPECT_EQ(heard->shard, 81);
  EXPECT_EQ(heard->as_of_sequence, 84u);
  ASSERT_EQ(heard->contacts.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Event& contact = heard->contacts[i];
    const double first = 100 + 13 * static_cast<double>(i);
    EXPECT_EQ(contact.kind, EventKind::open);
    EXPECT_EQ(contact.a, i == 0 ? "#1" : "two");
    EXPECT_EQ(contact.b, i == 0 ? "#4" : "#5");
    EXPECT_EQ(contact.a_id, 1 + i);
    EXPECT_EQ(contact.b_id, 4 + i);
    EXPECT_EQ(contact.a_triangle, shard.a_triangles[i]);
    EXPECT_EQ(contact.b_triangle, shard.b_triangles[i]);
    EXPECT_EQ(contact.epoch, 82u);
    EXPECT_EQ(contact.episode, 50 + i);
    EXPECT_EQ(contact.began, nanoseconds(90 + i));
    EXPECT_EQ(contact.world_time, nanoseconds(90 + i));
    EXPECT_EQ(contact.point, three(first));
    EXPECT_EQ(contact.normal, three(first + 3));
    EXPECT_EQ(contact.depth_m, first + 6);
    EXPECT_EQ(contact.depth_error_m, first + 7);
    EXPECT_EQ(contact.surface_normal, three(first + 8));
    EXPECT_EQ(contact.surface_depth_m, first + 11);
    EXPECT_EQ(contact.surface_depth_error_m, first + 12);
    EXPECT_EQ(contact.doubt, i == 0 ? Doubt::none : Doubt::cost_limit);
  }
}

TEST(WatchDecoding, AShardWhoseListsDifferIsRefused) {
  const std::vector<std::pair<const char*, std::function<void(ShardMessage&)>>> spoilers{
      {"a", [](ShardMessage& s) { s.a.pop_back(); }},
      {"b", [](ShardMessage& s) { s.b.pop_back(); }},
      {"a triangles", [](ShardMessage& s) { s.a_triangles.pop_back(); }},
      {"b triangles", [](ShardMessage& s) { s.b_triangles.pop_back(); }},
      {"episodes", [](ShardMessage& s) { s.episodes.pop_back(); }},
      {"doubts", [](ShardMessage& s) { s.doubts.pop_back(); }},
      {"began", [](ShardMessage& s) { s.began_ns.pop_back(); }},
      {"numbers", [](ShardMessage& s) { s.numbers.pop_back(); }},
  };
  for (const auto& [what, spoil] : spoilers) {
    Names names;
    ShardMessage bad;
    spoil(bad);
    EXPECT_FALSE(client::decode(bad.message(), names)) << what;
  }
}

TEST(WatchDecoding, ABookmarkIsThatOfItsStatus) {
  wire::Status status{};
  status.server = 1;
  status.epoch = 2;
  status.world_time_ns = 3;
  status.last_event_sequence = 4;
  status.contact_count = 5;
  status.contact_hash = 6;
  const auto settled = [&](wire_contract::ServerState state) {
    status.state = static_cast<std::uint8_t>(state);
    return client::decode(status).settled;
  };
  EXPECT_FALSE(settled(wire_contract::ServerState::starting));
  EXPECT_FALSE(settled(wire_contract::ServerState::recovering));
  EXPECT_TRUE(settled(wire_contract::ServerState::ready));
  EXPECT_TRUE(settled(wire_contract::ServerState::stopping));
  const client::HeardBookmark bookmark = client::decode(status);
  EXPECT_EQ(bookmark.from.server, 1u);
  EXPECT_EQ(bookmark.from.epoch, 2u);
  EXPECT_EQ(bookmark.world_time, nanoseconds(3));
  EXPECT_EQ(bookmark.last_event_sequence, 4u);
  EXPECT_EQ(bookmark.contact_count, 5u);
  EXPECT_EQ(bookmark.contact_hash, 6u);
}

struct ProbeMessage {
  wire::ProbeFrame frame{};
  std::vector<std::uint8_t> states{2, 0, 99};
  std::vector<std::uint64_t> objects{1, 0, 3}, met{4, 0, 6};
  std::vector<std::uint32_t> triangles{70, wire_contract::kNoTriangle, 72};
  std::vector<double> numbers = counted<double>(3 * wire::width_of<wire::ProbeFrame>(wire::kProbeColumns), 100),
                      columns;
  std::vector<std::uint8_t> probe_names = wire_contract::pack_names(std::vector<std::string>{"p", "q", "r"});
  std::vector<std::uint64_t> named_ids{1, 4};
  std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"car", "road"});

  ProbeMessage() {
    frame.epoch = 80;
    frame.version = 81;
    frame.world_time_ns = 82;
  }
  const wire::ProbeFrame& message() {
    dds::borrow(frame.states, states);
    dds::borrow(frame.objects, objects);
    dds::borrow(frame.met, met);
    dds::borrow(frame.triangles, triangles);
    wire::lend_columns<wire::ProbeFrame>(numbers, wire::kProbeColumns, columns, frame);
    dds::borrow(frame.probe_names, probe_names);
    dds::borrow(frame.named_ids, named_ids);
    dds::borrow(frame.names, names);
    return frame;
  }
};

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
  using wire_contract::QueryKind;
  for (const QueryKind kind : {QueryKind::ray, QueryKind::sphere, QueryKind::box, QueryKind::near, QueryKind::sweep}) {
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
    for (const QueryKind other : {QueryKind::ray, QueryKind::box, QueryKind::sphere, QueryKind::sweep}) {
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

// Of a sweep the bracket comes in columns of its own; a program finds it where it always was.
TEST(AnswerDecoding, ASweepsBracketIsTheDistanceOfItsHit) {
  Names names;
  AnswerCollector collector(3, 3, names);
  ReplyMessage reply;
  reply.message();
  for (auto* column : {&reply.reply.distances, &reply.reply.distance_errors, &reply.reply.exits}) *column = {};
  std::vector<double> memory;
  wire::lend_columns<wire::Reply>(reply.numbers, wire::kSweepHitColumns, memory, reply.reply);
  ASSERT_FALSE(collector.add(reply.reply));
  const Answers answers = collector.take();
  ASSERT_EQ(answers.answers[1].hits.size(), 2u);
  EXPECT_EQ(answers.answers[1].hits[1].distance_m, 113);
  EXPECT_EQ(answers.answers[1].hits[1].error_m, 114);
  EXPECT_EQ(answers.answers[1].hits[1].exit_m, 115);
  EXPECT_EQ(answers.answers[1].hits[1].point, three(116));
}

// A slot that is used again has the newer object's name, and an id that is not known has none of another's.
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
  using Kind = AskedInstant::Kind;
  for (const AskedInstant& instant :
       {AskedInstant{}, AskedInstant{Kind::settled, 0}, AskedInstant{Kind::at, 1'795'348'990'500'000'000},
        AskedInstant{Kind::at, 0}, AskedInstant{Kind::back, 0}, AskedInstant{Kind::back, 2'000'000'000}}) {
    EXPECT_EQ(asked_instant(wire_contract::text_of(instant)), instant) << wire_contract::text_of(instant);
  }
  EXPECT_EQ(wire_contract::text_of(AskedInstant{Kind::back, 5}), "-5");
  for (const char* text : {"latest", "settled ", "-", "--5", "5s", " 5", "1e9", "99999999999999999999"}) {
    EXPECT_EQ(asked_instant(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace collided
