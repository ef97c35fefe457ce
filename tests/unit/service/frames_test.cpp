// What travels of events, contacts, readings and answers: each column has the value of its own field.
#include "idl/columns.hpp"
#include "server/service/events/frames.hpp"

#include <gtest/gtest.h>

#include "server/service/questions/reply_columns.hpp"

namespace collided::engine::service {
namespace {

using Names = std::vector<std::string>;

Names split(const std::vector<std::uint8_t>& bytes) {
  Names names;
  std::string name;
  for (const std::uint8_t byte : bytes) {
    if (byte != 0) {
      name += static_cast<char>(byte);
      continue;
    }
    names.push_back(name);
    name.clear();
  }
  EXPECT_TRUE(name.empty()) << "the last name has no end";
  return names;
}

/// The columns of numbers, row by row.
template <class Message, class Columns>
std::vector<double> numbers_in(const Columns& columns, wire::Columns<Message> of) {
  dds::Sample<Message> message;
  wire::lend(columns, *message);
  std::vector<double> rows;
  wire::gather_rows<Message>(*message, of, rows);
  return rows;
}

class ServiceFrames : public testing::Test {
 protected:
  ObjectId define(const std::string& name, const Vec3& at, bool moving = true) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.5});
    definition.pose.position = at;
    definition.moving = moving;
    return std::get<ObjectId>(world.define(definition));
  }
  static OpenContact contact_of(ObjectId a, ObjectId b) {
    return {.a = a,
            .b = b,
            .a_triangle = 3,
            .b_triangle = 5,
            .episode = 11,
            .began_ns = 13,
            .contact = {.point = {1, 2, 3}, .normal = {4, 5, 6}, .depth_m = 7, .depth_error_m = 8},
            .surface = {.point = {1, 2, 3}, .normal = {9, 10, 11}, .depth_m = 12, .depth_error_m = 13}};
  }
  World world{WorldOptions{}};
  NameBook book;
};

TEST_F(ServiceFrames, AnEventTravelsWithEveryFieldInItsPlace) {
  const ObjectId a = define("left", {0, 0, 0});
  const ObjectId b = define("right", {3, 0, 0});
  const Event event{.kind = EventKind::ended,
                    .reason = EndReason::teleported,
                    .sequence = 21,
                    .of = contact_of(a, b),
                    .bracket_low_s = 14,
                    .bracket_high_s = 15,
                    .relative_velocity = {16, 17, 18},
                    .velocity_error = 19};
  book.note(event.of, world);
  EventColumns columns;
  columns.add(event, book);
  Event second = event;
  second.sequence = 22;
  second.kind = EventKind::began;
  columns.add(second, book, true);
  put_names(columns, [&](ObjectId id) { return book.name(id); });
  EXPECT_EQ(columns.first_sequence, 21U);
  EXPECT_EQ(columns.size(), 2U);
  EXPECT_EQ(columns.kinds, (std::vector<std::uint8_t>{2, 0}));
  EXPECT_EQ(columns.reasons, (std::vector<std::uint8_t>{4, 4}));
  EXPECT_EQ(columns.doubts[1], columns.doubts[0] | wire_contract::kDoubtPosesMerged);
  EXPECT_EQ(columns.shards, std::vector<std::uint8_t>(2, wire_contract::contact_shard(a, b)));
  EXPECT_EQ(columns.a, std::vector<std::uint64_t>(2, a));
  EXPECT_EQ(columns.b, std::vector<std::uint64_t>(2, b));
  EXPECT_EQ(columns.a_triangles, std::vector<std::uint32_t>(2, 3));
  EXPECT_EQ(columns.b_triangles, std::vector<std::uint32_t>(2, 5));
  EXPECT_EQ(columns.episodes, std::vector<std::uint64_t>(2, 11));
  const std::vector<double> rows = numbers_in<wire::EventFrame>(columns, wire::kEventColumns);
  ASSERT_EQ(rows.size(), 2U * wire::width_of<wire::EventFrame>(wire::kEventColumns));
  for (std::size_t i = 0; i < rows.size() / 2; ++i) EXPECT_EQ(rows[i], static_cast<double>(i + 1)) << i;
  EXPECT_EQ(columns.named_ids, (std::vector<std::uint64_t>{a, b})) << "each once";
  EXPECT_EQ(split(columns.names), (Names{"left", "right"}));
  wire::clear(columns);
  columns.add(second, book);
  EXPECT_EQ(columns.first_sequence, 22U) << "the next frame starts where this one ended";
  EXPECT_EQ(numbers_in<wire::EventFrame>(columns, wire::kEventColumns).size(), rows.size() / 2);
}

TEST_F(ServiceFrames, AContactTravelsWithEveryFieldInItsPlace) {
  const ObjectId a = define("left", {0, 0, 0});
  const ObjectId b = define("right", {3, 0, 0});
  book.note(contact_of(a, b), world);
  ContactColumns columns;
  columns.add(contact_of(a, b), book);
  put_names(columns, [&](ObjectId id) { return book.name(id); });
  EXPECT_EQ(columns.a, std::vector<std::uint64_t>{a});
  EXPECT_EQ(columns.b, std::vector<std::uint64_t>{b});
  EXPECT_EQ(columns.a_triangles, std::vector<std::uint32_t>{3});
  EXPECT_EQ(columns.b_triangles, std::vector<std::uint32_t>{5});
  EXPECT_EQ(columns.episodes, std::vector<std::uint64_t>{11});
  EXPECT_EQ(columns.began_ns, std::vector<std::int64_t>{13});
  EXPECT_EQ(numbers_in<wire::ContactShard>(columns, wire::kContactColumns),
            (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}));
  EXPECT_EQ(split(columns.names), (Names{"left", "right"}));
  EXPECT_EQ(columns.bytes(), 1 + 5U * 8 + 13 * 8 + 2 * 8 + sizeof "left" + sizeof "right");
}

// Two contacts of one object: its name stays until both are over, and is its own when its slot is used again.
TEST_F(ServiceFrames, ANameIsKnownAsLongAsAContactOfItsObjectIsToldOf) {
  const ObjectId a = define("left", {0, 0, 0});
  const ObjectId b = define("right", {3, 0, 0});
  const ObjectId c = define("third", {6, 0, 0});
  book.note(contact_of(a, b), world);
  book.note(contact_of(a, c), world);
  world.remove(a, EndReason::removed);
  world.step(1, 1, {});
  book.forget(contact_of(a, b));
  EXPECT_EQ(book.name(a), "left");
  EXPECT_EQ(book.name(b), "");
  EXPECT_EQ(book.name(c), "third");
  book.forget(contact_of(a, c));
  EXPECT_EQ(book.name(a), "");
  const ObjectId again = define("again", {0, 0, 0});
  ASSERT_EQ(slot_of(again), slot_of(a));
  book.note(contact_of(again, c), world);
  EXPECT_EQ(book.name(again), "again");
  EXPECT_EQ(book.name(a), "");
}

TEST_F(ServiceFrames, AHitOnWhatIsNotInTheStateHasNoNameBesideIt) {
  define("left", {0, 0, 0});
  world.step(1, 1, {});
  const auto state = world.newest();
  const ObjectId beyond = state->objects.size();
  Answers answers;
  answers.answers = {Verdict::hit};
  answers.reasons = {UndecidedReason::none};
  answers.levels = {0};
  answers.hit_counts = {1};
  answers.nodes = answers.exact_tests = {0};
  answers.hits = {{.object = beyond, .triangle = 5}};
  std::vector<std::uint64_t> named_in;
  named_in.reserve(state->objects.size() + 1);
  std::uint64_t reply_number = 0;
  ReplyFiller filler(*state, answers, named_in, reply_number);
  ReplyColumns columns;
  ASSERT_TRUE(filler.fill(columns));
  EXPECT_EQ(columns.objects, std::vector<std::uint64_t>{beyond});
  EXPECT_EQ(columns.triangles, std::vector<std::uint32_t>{5});
  EXPECT_TRUE(columns.named_ids.empty());
}

TEST_F(ServiceFrames, AReadingTravelsWithEveryFieldInItsPlace) {
  const ObjectId head = define("head", {0, 0, 3});
  const ObjectId wall = define("wall", {0, 0, 0});
  ProbeColumns columns;
  columns.add("nozzle", {.object = head,
                         .state = ProbeState::collision,
                         .clearance_m = 1,
                         .error_m = 2,
                         .met = wall,
                         .triangle = 5,
                         .point = {3, 4, 5},
                         .normal = {6, 7, 8}});
  columns.add("other", {.object = head, .state = ProbeState::nothing});
  columns.add("none", {.state = ProbeState::absent});
  put_names(columns, [&](ObjectId id) { return world.info(id)->name; });
  EXPECT_EQ(columns.states, (std::vector<std::uint8_t>{4, 1, 0}));
  EXPECT_EQ(columns.objects, (std::vector<std::uint64_t>{head, head, 0}));
  EXPECT_EQ(columns.met, (std::vector<std::uint64_t>{wall, 0, 0}));
  EXPECT_EQ(columns.triangles[0], 5U);
  EXPECT_EQ(columns.triangles[1], kNoTriangle);
  const std::vector<double> rows = numbers_in<wire::ProbeFrame>(columns, wire::kProbeColumns);
  EXPECT_EQ(std::vector<double>(rows.begin(), rows.begin() + 8), (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(rows.size(), 24U);
  EXPECT_EQ(split(columns.probe_names), (Names{"nozzle", "other", "none"}));
  EXPECT_EQ(columns.named_ids, (std::vector<std::uint64_t>{head, wall}));
  EXPECT_EQ(split(columns.names), (Names{"head", "wall"}));
}

// A reply's columns have the answers' values; a name comes with the first hit of its object in each reply.
TEST_F(ServiceFrames, AnAnswerTravelsWithEveryFieldInItsPlace) {
  const ObjectId a = define("left", {0, 0, 0});
  const ObjectId b = define("right", {3, 0, 0});
  world.step(1, 1, {});
  Answers answers;
  answers.answers = {Verdict::hit, Verdict::miss, Verdict::undecided, Verdict::invalid};
  answers.reasons = {UndecidedReason::none, UndecidedReason::none, UndecidedReason::not_covered, UndecidedReason::none};
  answers.levels = {2, 0, 1, 0};
  answers.hit_counts = {2, 0, 1, 0};
  answers.nodes = {10, 11, 12, 13};
  answers.exact_tests = {20, 21, 22, 23};
  const AnswerHit hit{.object = b,
                      .triangle = 5,
                      .flags = kHitInside,
                      .distance_m = 1,
                      .error_m = 2,
                      .exit_m = 3,
                      .point = {4, 5, 6},
                      .point_error_m = 13,
                      .normal = {7, 8, 9},
                      .weights = {10, 11, 12}};
  answers.hits = {hit, {.object = a, .distance_m = 4}, {.object = b, .flags = kHitStale}};
  answers.not_covered = {{.question = 2, .leaving = {.point = {7, 8, 9}, .covered_m = 6}}};
  std::vector<std::uint64_t> named_in;
  std::uint64_t reply_number = 0;
  for (int reply = 0; reply < 2; ++reply) {
    const auto state = world.newest();
    ReplyFiller filler(*state, answers, named_in, reply_number);
    ReplyColumns columns;
    ASSERT_TRUE(filler.fill(columns));
    EXPECT_EQ(filler.first(), 0U);
    EXPECT_EQ(filler.undecided(), 1U);
    EXPECT_EQ(columns.answers, (std::vector<std::uint8_t>{1, 0, 2, 3}));
    EXPECT_EQ(columns.reasons, (std::vector<std::uint8_t>{0, 0, 6, 0}));
    EXPECT_EQ(columns.levels, (std::vector<std::uint8_t>{2, 0, 1, 0}));
    EXPECT_EQ(columns.hit_counts, (std::vector<std::uint32_t>{2, 0, 1, 0}));
    EXPECT_EQ(columns.nodes, (std::vector<std::uint32_t>{10, 11, 12, 13}));
    EXPECT_EQ(columns.exact_tests, (std::vector<std::uint32_t>{20, 21, 22, 23}));
    EXPECT_EQ(columns.objects, (std::vector<std::uint64_t>{b, a, b}));
    EXPECT_EQ(columns.triangles[0], 5U);
    EXPECT_EQ(columns.hit_flags, (std::vector<std::uint8_t>{kHitInside, 0, kHitStale}));
    EXPECT_EQ(columns.distances, (std::vector<double>{1, 4, 0}));
    EXPECT_EQ(columns.distance_errors, (std::vector<double>{2, 0, 0}));
    EXPECT_EQ(columns.exits, (std::vector<double>{3, 0, 0}));
    EXPECT_TRUE(columns.sweep_ends.empty() && columns.sweep_widths.empty() && columns.sweep_begins.empty());
    EXPECT_EQ(columns.points, (std::vector<double>{4, 5, 6, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(columns.normals, (std::vector<double>{7, 8, 9, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(columns.weights, (std::vector<double>{10, 11, 12, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(columns.point_errors, (std::vector<double>{13, INFINITY, INFINITY}));
    EXPECT_EQ(columns.uncovered_questions, std::vector<std::uint32_t>{2});
    EXPECT_EQ(columns.uncovered_points, (std::vector<double>{7, 8, 9}));
    EXPECT_EQ(columns.uncovered_distances, std::vector<double>{6});
    EXPECT_EQ(columns.named_ids, (std::vector<std::uint64_t>{b, a})) << "anew in every reply";
    EXPECT_EQ(split(columns.names), (Names{"right", "left"}));
    EXPECT_FALSE(filler.fill(columns));
  }
}

// A sweep's bracket has columns of its own, and the columns of distances stay empty; what one reply held is not in the
// next one.
TEST_F(ServiceFrames, ASweepsBracketTravelsInColumnsOfItsOwn) {
  const ObjectId a = define("left", {0, 0, 0});
  world.step(1, 1, {});
  Answers answers;
  answers.answers = {Verdict::miss, Verdict::hit};
  answers.reasons = {UndecidedReason::none, UndecidedReason::none};
  answers.levels = {0, 0};
  answers.hit_counts = {0, 1};
  answers.nodes = answers.exact_tests = {1, 1};
  answers.hits = {{.object = a, .point = {4, 5, 6}}};
  answers.brackets = {{.low = 0.25, .high = 0.75}};
  std::vector<std::uint64_t> named_in;
  std::uint64_t reply_number = 0;
  const auto state = world.newest();
  ReplyColumns columns;
  ASSERT_TRUE(ReplyFiller(*state, answers, named_in, reply_number).fill(columns));
  EXPECT_TRUE(columns.distances.empty() && columns.distance_errors.empty() && columns.exits.empty());
  EXPECT_EQ(columns.sweep_ends, std::vector<double>{0.75});
  EXPECT_EQ(columns.sweep_widths, std::vector<double>{0.5});
  EXPECT_EQ(columns.sweep_begins, std::vector<double>{0.25});
  EXPECT_EQ(columns.points, (std::vector<double>{4, 5, 6}));
  answers.brackets.clear();
  ASSERT_TRUE(ReplyFiller(*state, answers, named_in, reply_number).fill(columns));
  EXPECT_TRUE(columns.sweep_ends.empty() && columns.sweep_widths.empty() && columns.sweep_begins.empty());
  EXPECT_EQ(columns.distances, std::vector<double>{0});
}

}  // namespace
}  // namespace collided::engine::service
