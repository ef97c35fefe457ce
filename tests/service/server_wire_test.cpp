#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "server/intake/scene.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/eventually.hpp"
#include "tests/service/server_process.hpp"
#include "tests/service/server_wire_asker.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::engine {
namespace {

using namespace std::chrono_literals;
using testing_support::WireAsker;
using wire_contract::QuestionKind;
using wire_contract::ReplyStatus;
using wire_contract::Verdict;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ServerWire : public testing_support::ServerProcess {
 protected:
  void SetUp() override {
    start();
    asker.emplace(domain_);
    ASSERT_TRUE(asker->greet());
  }
  static void set(wire::Query& query, QuestionKind kind, const std::vector<double>& numbers) {
    query.kind = static_cast<std::uint8_t>(kind);
    query.mask = 0xffffffff;
    query.max_hits = 1'000;
    test::put_questions(query, numbers);
  }
  std::optional<WireAsker> asker;
};

bool is_refused(const std::optional<WireAsker::Heard>& reply) {
  return reply && reply->status == static_cast<std::uint8_t>(ReplyStatus::refused);
}

TEST_F(ServerWire, RaysOfTheEmbeddedSceneEqualBruteForce) {
  Scene scene = embedded_scene();
  World twin{WorldOptions{}};
  const auto indexed = World::index_scene(scene, {});
  ASSERT_TRUE(std::holds_alternative<std::uint32_t>(twin.add_scene(indexed)));
  twin.step(1, 1, {});
  std::mt19937_64 random = oracle::seeded(11);
  std::uniform_real_distribution<double> x(-9, 9), y(-7, 7), z(-0.5, 4.5);
  std::vector<double> numbers;
  for (int i = 0; i < 1'000; ++i) {
    numbers.insert(numbers.end(),
                   {x(random), y(random), z(random), x(random), y(random), z(random), i % 2 ? kInfinity : 0.3});
  }
  dds::Sample<wire::Query> query;
  set(*query, QuestionKind::ray, numbers);
  const WireAsker::Heard reply = WireAsker::whole(asker->ask_all(*query, 1'000));
  ASSERT_EQ(reply.answers.size(), 1'000U);
  Answers expected;
  Questions questions;
  questions.numbers = numbers;
  oracle::answer(*twin.newest(), questions, expected);
  std::size_t hit = 0;
  for (std::size_t i = 0; i < 1'000; ++i) {
    ASSERT_EQ(reply.answers[i], static_cast<std::uint8_t>(expected.answers[i])) << i;
    ASSERT_EQ(reply.hit_counts[i], expected.hit_counts[i]) << i;
    for (std::uint32_t h = 0; h < expected.hit_counts[i]; ++h, ++hit) {
      // Both worlds load the same scene in the same order, so even the ids are the same.
      ASSERT_EQ(reply.objects[hit], expected.hits[hit].object) << i;
      ASSERT_EQ(reply.triangles[hit], expected.hits[hit].triangle) << i;
      ASSERT_EQ(reply.numbers[hit * wire_contract::kHitNumbers], expected.hits[hit].distance_m) << i;
    }
  }
  EXPECT_GT(hit, 300U);
}

// Each malformed question is answered `invalid` for itself; its neighbours are answered.
TEST_F(ServerWire, InvalidQuestionsDoNotSpoilTheirNeighbours) {
  const std::vector<double> numbers{6, 0, 5, 0,         0, -1, kInfinity, kNan, 0, 5, 0, 0, -1, 1,
                                    6, 0, 5, 0,         0, 0,  1,         6,    0, 5, 0, 0, -1, -1,
                                    6, 0, 5, kInfinity, 0, 0,  1,         6,    0, 5, 0, 0, -2, kInfinity};
  dds::Sample<wire::Query> query;
  set(*query, QuestionKind::ray, numbers);
  const auto reply = asker->ask(*query);
  ASSERT_TRUE(reply);
  const auto hit = static_cast<std::uint8_t>(Verdict::hit);
  const auto invalid = static_cast<std::uint8_t>(Verdict::invalid);
  EXPECT_EQ(reply->answers, (std::vector<std::uint8_t>{hit, invalid, invalid, invalid, invalid, hit}));
}

TEST_F(ServerWire, BadRequestsAreRefusedWithASentence) {
  const std::vector<double> ray{6, 0, 5, 0, 0, -1, kInfinity};
  const std::vector<double> eight{6, 0, 5, 0, 0, -1, 1, 1};
  const std::vector<double> many(7 * 1'001, 1.0);
  const std::vector<double> none;
  struct Bad {
    const char* what;
    std::function<void(wire::Query&)> spoil;
    const char* said;
  };
  const std::vector<Bad> all{
      {"kind", [](wire::Query& q) { q.kind = 99; }, "question kind 99"},
      {"mode", [](wire::Query& q) { q.mode = 7; }, "hit mode 7"},
      {"columns", [&](wire::Query& q) { dds::borrow(q.directions, eight); }, "not of one length"},
      {"no questions", [&](wire::Query& q) { test::put_questions(q, none); }, "are empty"},
      {"too many", [&](wire::Query& q) { test::put_questions(q, many); }, "1001 questions"},
      {"chunk",
       [](wire::Query& q) {
         q.chunk_index = 3;
         q.chunk_count = 3;
       },
       "chunk number 3 of 3"},
      {"chunks", [](wire::Query& q) { q.chunk_count = 0xffffffff; }, "4294967295 chunks"},
      {"first", [](wire::Query& q) { q.first_question = 0xffffffff; }, "question 4294967295"},
      {"no hits", [](wire::Query& q) { q.max_hits = 0; }, "max_hits 0"},
      {"hits", [](wire::Query& q) { q.max_hits = 1'000'000; }, "max_hits 1000000"},
      {"deadline", [](wire::Query& q) { q.deadline_ns = -5; }, "deadline -5"},
      {"error", [](wire::Query& q) { q.error_asked = kNan; }, "error asked nan"},
      {"pattern", [](wire::Query& q) { std::strcpy(q.only, "\xff\xfe"); }, "not text"},
      {"later chunk",
       [](wire::Query& q) {
         q.chunk_index = 2;
         q.chunk_count = 3;
       },
       "no longer kept"},
      {"barrier",
       [](wire::Query& q) {
         q.barrier_publisher = 77;
         q.barrier_sequence = 1;
       },
       "not known"},
      {"command",
       [](wire::Query& q) {
         q.kind = 5;
         std::strcpy(q.text, "{\"command\": \"laod\"}");
       },
       "did you mean 'load'"},
      {"not JSON",
       [](wire::Query& q) {
         q.kind = 5;
         std::strcpy(q.text, "{\"command\":");
       },
       "not a JSON object"},
  };
  for (const Bad& bad : all) {
    dds::Sample<wire::Query> query;
    set(*query, QuestionKind::ray, ray);
    bad.spoil(*query);
    const auto reply = asker->ask(*query);
    ASSERT_TRUE(is_refused(reply)) << bad.what;
    EXPECT_NE(reply->text.find(bad.said), std::string::npos) << bad.what << ": " << reply->text;
  }
  const std::size_t count = all.size();
  EXPECT_TRUE(asker->status_becomes([&](const wire::Status& status) { return status.questions_refused == count; }));
  dds::Sample<wire::Query> good;
  set(*good, QuestionKind::ray, ray);
  EXPECT_EQ(asker->ask(*good)->answers, std::vector<std::uint8_t>{static_cast<std::uint8_t>(Verdict::hit)});
}

// A reply that would outgrow a message comes as several, each with whole questions.
TEST_F(ServerWire, LargeAnswersAreSplitAndNothingIsLost) {
  constexpr std::size_t kQuestions = 400;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < kQuestions; ++i) numbers.insert(numbers.end(), {0, 0, 0, 100});
  dds::Sample<wire::Query> query;
  set(*query, QuestionKind::sphere, numbers);
  const WireAsker::Replies replies = asker->ask_all(*query, kQuestions);
  for (const auto& [first, reply] : replies) EXPECT_LE(reply.objects.size(), wire_contract::kMaxHitsPerChunk);
  const WireAsker::Heard all = WireAsker::whole(replies);
  EXPECT_EQ(all.answers.size(), kQuestions);
  EXPECT_EQ(all.objects.size(), kQuestions * 31);  // 25 parts and 6 pallets each
  EXPECT_GT(replies.size(), 1U);
}

class HostilePublisher : public ServerWire {
 protected:
  void define(std::uint32_t number, std::uint64_t sequence, const std::string& name, bool removed = false) {
    Shape ball;
    ball.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.1});
    const std::vector<std::byte> encoded = encode_shape(ball);
    std::vector<std::uint8_t> bytes;
    for (const std::byte byte : encoded) bytes.push_back(static_cast<std::uint8_t>(byte));
    dds::Sample<wire::Definition> definition;
    definition->publisher = 9;
    definition->incarnation = 1;
    definition->removed = removed;
    definition->object_number = number;
    definition->sequence_number = sequence;
    definition->moving = true;
    definition->layers = 1;
    definition->mask = 0xffffffff;
    const double pose[] = {6, 0, 3, 1, 0, 0, 0};
    std::copy_n(pose, 3, definition->position);
    std::copy_n(pose + 3, 4, definition->orientation);
    ASSERT_TRUE(dds::set_text(definition->name, name));
    dds::borrow(definition->shape, bytes);
    by().define(*definition);
  }
  void pose(std::uint64_t sequence, const std::vector<std::uint32_t>& numbers, const std::vector<double>& poses,
            std::uint64_t incarnation = 1) {
    dds::Sample<wire::PoseBatch> batch;
    batch->publisher = 9;
    batch->incarnation = incarnation;
    batch->sequence_number = sequence;
    batch->definitions_through = 1;
    dds::borrow(batch->object_numbers, numbers);
    test::put_poses(*batch, poses);
    by().pose(*batch);
  }
  /// By a ray from above.
  void expect_ball_at(double z) {
    dds::Sample<wire::Query> query;
    const std::vector<double> ray{6, 0, 5, 0, 0, -1, kInfinity};
    set(*query, QuestionKind::ray, ray);
    const auto reply = asker->ask(*query);
    ASSERT_TRUE(reply);
    EXPECT_NEAR(reply->numbers[0], 5 - z - 0.1, 1e-12);
  }
  WireAsker& by() { return other_ ? *other_ : *asker; }
  bool dropped(std::uint64_t count) {
    return asker->status_becomes([&](const wire::Status& status) { return status.poses_dropped == count; });
  }
  std::optional<WireAsker> other_;  // sends in the asker's place where there is one
};

TEST_F(HostilePublisher, BadPosesAreCountedAndTheRestOfTheBatchApplied) {
  define(1, 1, "ball");
  pose(2, {1, 2}, {6, 0, 2, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});  // number 2 is unknown
  EXPECT_TRUE(dropped(1));
  pose(3, {1}, {6, 0, kNan, 1, 0, 0, 0});
  EXPECT_TRUE(dropped(2));
  pose(4, {1}, {6, 0, 1, 0.9, 0, 0, 0});
  EXPECT_TRUE(dropped(3));
  pose(5, {1, 1}, {6, 0, 1.5, 1, 0, 0, 0, 6, 0, 1, 1, 0, 0, 0});  // twice in one batch: the first counts
  EXPECT_TRUE(dropped(4));
  pose(5, {1}, {6, 0, 1, 1, 0, 0, 0});  // the same sequence again
  EXPECT_TRUE(dropped(5));
  expect_ball_at(1.5);
}

TEST_F(HostilePublisher, MalformedBatchesAndShapesDoNotStopTheServer) {
  define(1, 1, "ball");
  pose(2, {1}, {6, 0, 2});
  pose(3, std::vector<std::uint32_t>(5'000, 1), std::vector<double>(35'000, 0.0));
  dds::Sample<wire::Definition> garbage;
  garbage->publisher = 9;
  garbage->incarnation = 1;
  garbage->object_number = 2;
  garbage->sequence_number = 4;
  garbage->lost_policy = 200;
  const std::vector<std::uint8_t> bytes(1'000, 0xff);
  dds::borrow(garbage->shape, bytes);
  asker->define(*garbage);
  pose(5, {1}, {6, 0, 2, 1, 0, 0, 0});
  EXPECT_TRUE(asker->status_becomes([](const wire::Status& status) {
    return status.poses_applied == 1 && status.applied_sequences._length == 1 &&
           status.applied_sequences._buffer[0] == 5;
  }));
  EXPECT_TRUE(asker->status_becomes([](const wire::Status& status) { return status.moving_count == 1; }));
}

// Each of these samples alone froze, moved, retired or removed the ball for good. The outsider's going was its loss, too.
TEST_F(HostilePublisher, NobodyElseMovesRetiresOrRemovesWhatItHasWhileItLives) {
  define(1, 1, "ball");
  pose(2, {1}, {6, 0, 2, 1, 0, 0, 0});
  ASSERT_TRUE(asker->status_becomes([](const wire::Status& status) { return status.poses_applied == 1; }));
  other_.emplace(domain_, 0x9999, domain_ + 300'000);
  ASSERT_TRUE(other_->greet());
  pose(std::numeric_limits<std::uint64_t>::max(), {1}, {6, 0, 1, 1, 0, 0, 0});
  pose(3, {}, {}, 2);
  define(1, 1'000, "ball", true);
  define(2, 1'001, "ghost");
  EXPECT_TRUE(test::eventually([&] {
    return servers_.back()->errors().find("another process has sent under its number") != std::string::npos;
  })) << servers_.back()->errors();
  other_.reset();
  pose(3, {1}, {6, 0, 1.5, 1, 0, 0, 0});
  EXPECT_TRUE(asker->status_becomes([](const wire::Status& status) { return status.poses_applied == 2; }));
  EXPECT_TRUE(asker->status_becomes([](const wire::Status& status) { return status.moving_count == 1; }));
  expect_ball_at(1.5);
}

// The answer to another's question under one's own number would be taken for the answer to one's own.
TEST_F(ServerWire, NobodyElseAsksUnderAClientsNumber) {
  WireAsker outsider(domain_, 0x1234, domain_ + 300'000);
  ASSERT_TRUE(outsider.status_becomes([](const wire::Status&) { return true; }));
  dds::Sample<wire::Query> query;
  const std::vector<double> ray{1e6, 0, 5, 0, 0, -1, 1};
  set(*query, QuestionKind::ray, ray);
  query->request = 77;
  EXPECT_FALSE(outsider.ask(*query, 300ms));
  EXPECT_FALSE(asker->reply_to(77, 300ms));
  const std::vector<double> own{0, 0, 5, 0, 0, -1, kInfinity};
  dds::Sample<wire::Query> next;
  set(*next, QuestionKind::ray, own);
  EXPECT_TRUE(asker->ask(*next)) << "the number's owner is answered";
}

// Poses that come before their definition wait for it.
TEST_F(HostilePublisher, PosesWaitForTheirDefinition) {
  pose(2, {1}, {6, 0, 1, 1, 0, 0, 0});
  EXPECT_FALSE(asker->status_becomes([](const wire::Status& status) { return status.poses_applied > 0; }, 300ms));
  define(1, 1, "ball");
  EXPECT_TRUE(asker->status_becomes([](const wire::Status& status) { return status.poses_applied == 1; }));
}

}  // namespace
}  // namespace collided::engine
