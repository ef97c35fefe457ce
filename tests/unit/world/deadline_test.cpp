// A question that costs much ends at its deadline, from inside its walk, and says so; one that is answered in time has
// the same answer as without a deadline.
#include <gtest/gtest.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "idl/clocks.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/pair_report.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

constexpr int kShellLevels = 6;  // 81,920 triangles
constexpr std::uint32_t kEverything = 1'000'000;

/// Triangles one behind the other, each met by a ray along x.
TriangleMesh stack(std::uint32_t count) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = 100 + 0.01 * i;
    for (const Vec3& corner : {Vec3(x, -1, -1), Vec3(x, 1, -1), Vec3(x, 0, 1)}) mesh.vertices.push_back(corner);
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// What this thread has had of a processor: on a busy machine the rest of the time is others'. A deadline is of the clock that
/// goes on meanwhile, so it never leaves more than this.
std::int64_t busy_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

/// A question that has much to test, about what stands still or about what moves.
struct CostlyQuestion {
  std::string name;
  QuestionKind kind;
  HitMode mode;
  bool moving;
  std::vector<double> numbers;
};

void PrintTo(const CostlyQuestion& question, std::ostream* out) { *out << question.name; }

class CostlyQuestions : public testing::TestWithParam<CostlyQuestion> {
 protected:
  void SetUp() override {
    for (const auto& [name, mesh] :
         {std::pair("shell", scenes::icosphere(kShellLevels, 1)), std::pair("stack", stack(60'000))})
      GetParam().moving ? move(name, mesh) : load(name, mesh);
    ASSERT_TRUE(world_.step(1'000'000'000, 1, {}));
    Shape ball;
    ball.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = 0.999}};
    mover_ = without_world(ball);
  }
  void load(const std::string& name, const TriangleMesh& mesh) {
    Scene scene;
    scene.name = name;
    scene.mesh = mesh;
    scene.parts = {{.name = name,
                    .first_triangle = 0,
                    .triangle_count = static_cast<std::uint32_t>(mesh.triangles.size()),
                    .filter = {}}};
    auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world_.add_scene(indexed)));
  }
  void move(const std::string& name, const TriangleMesh& mesh) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.mesh = std::make_shared<const TriangleMesh>(mesh);
    definition.moving = true;
    ASSERT_TRUE(std::holds_alternative<ObjectId>(world_.define(definition)));
  }
  /// The processor's time that it took, ns; within_ns 0: no deadline.
  std::int64_t ask(std::int64_t within_ns) {
    const SnapshotRing::Lease state = world_.newest();
    const std::int64_t start_ns = wire_contract::steady_ns();
    const std::int64_t busy_before_ns = busy_ns();
    answer(*state,
           {.kind = GetParam().kind,
            .mode = GetParam().mode,
            .max_hits = kEverything,
            .deadline_ns = within_ns == 0 ? 0 : start_ns + within_ns,
            .numbers = GetParam().numbers,
            .mover = &mover_},
           answers_, scratch_);
    return busy_ns() - busy_before_ns;
  }

  World world_{WorldOptions{}};
  ObjectInfo mover_;
  Answers answers_;
  QueryScratch scratch_;
};

// Only the fastest of a few tries counts: others may have found the caches cold.
TEST_P(CostlyQuestions, EndAtTheirDeadlineAndSaySo) {
  std::int64_t whole_ns = ask(0);
  for (int i = 0; i < 2; ++i) whole_ns = std::min(whole_ns, ask(0));
  EXPECT_EQ(answers_.answers[0], Verdict::hit);
  const std::uint32_t whole_tests = answers_.exact_tests[0];
  const std::int64_t within_ns = whole_ns / 8;
  std::int64_t fastest_ns = whole_ns;
  for (int i = 0; i < 8; ++i) {
    fastest_ns = std::min(fastest_ns, ask(within_ns));
    ASSERT_EQ(answers_.answers[0], Verdict::undecided);
    ASSERT_EQ(answers_.reasons[0], UndecidedReason::deadline);
    ASSERT_EQ(answers_.hit_counts[0], 0U) << "what was found first need not be the nearest";
    ASSERT_TRUE(answers_.hits.empty());
    ASSERT_TRUE(answers_.brackets.empty());
    ASSERT_LT(answers_.exact_tests[0], whole_tests);
  }
  EXPECT_LE(fastest_ns, 2 * within_ns) << "of " << whole_ns << " ns without a deadline";
}

TEST_P(CostlyQuestions, InTimeAnswerAsWithoutADeadline) {
  ask(0);
  const Answers plain = answers_;
  ask(3'600'000'000'000);
  ASSERT_EQ(answers_.answers, plain.answers);
  EXPECT_EQ(answers_.exact_tests, plain.exact_tests);
  EXPECT_EQ(answers_.nodes, plain.nodes);
  ASSERT_EQ(answers_.hits.size(), plain.hits.size());
  for (std::size_t i = 0; i < plain.hits.size(); ++i) {
    ASSERT_EQ(answers_.hits[i].object, plain.hits[i].object);
    ASSERT_EQ(answers_.hits[i].triangle, plain.hits[i].triangle);
    ASSERT_EQ(answers_.hits[i].distance_m, plain.hits[i].distance_m);
    ASSERT_EQ(answers_.hits[i].error_m, plain.hits[i].error_m);
  }
}

// Whoever answers has others waiting and gives it up: it has no answer then, and those before it have theirs.
TEST_P(CostlyQuestions, AreGivenUpWithoutAnAnswer) {
  constexpr std::int64_t kLongAgo = 1;
  const SnapshotRing::Lease state = world_.newest();
  Questions asked{.kind = GetParam().kind,
                  .mode = GetParam().mode,
                  .max_hits = kEverything,
                  .give_up_ns = kLongAgo,
                  .numbers = GetParam().numbers,
                  .mover = &mover_};
  answer(*state, asked, answers_, scratch_);
  EXPECT_TRUE(answers_.answers.empty());
  EXPECT_TRUE(answers_.hits.empty());
  EXPECT_TRUE(answers_.brackets.empty());
  std::vector<double> two(GetParam().numbers.size(), std::numeric_limits<double>::quiet_NaN());
  two.insert(two.end(), GetParam().numbers.begin(), GetParam().numbers.end());
  asked.numbers = two;
  answer(*state, asked, answers_, scratch_);
  ASSERT_EQ(answers_.answers.size(), 1U);
  EXPECT_EQ(answers_.answers[0], Verdict::invalid);
  EXPECT_TRUE(answers_.hits.empty());
  asked.deadline_ns = kLongAgo + 1;
  answer(*state, asked, answers_, scratch_);
  ASSERT_EQ(answers_.answers.size(), 2U) << "no more time would help one whose deadline is over";
  EXPECT_EQ(answers_.reasons[1], UndecidedReason::deadline);
}

TEST_P(CostlyQuestions, InTimeAnswerAsThoughTheyCouldNotBeGivenUp) {
  ask(0);
  const Answers plain = answers_;
  std::atomic<bool> called_off{false};
  const SnapshotRing::Lease state = world_.newest();
  Questions asked{.kind = GetParam().kind,
                  .mode = GetParam().mode,
                  .max_hits = kEverything,
                  .give_up_ns = wire_contract::steady_ns() + 3'600'000'000'000,
                  .called_off = &called_off,
                  .numbers = GetParam().numbers,
                  .mover = &mover_};
  answer(*state, asked, answers_, scratch_);
  EXPECT_EQ(answers_.answers, plain.answers);
  EXPECT_EQ(answers_.exact_tests, plain.exact_tests);
  EXPECT_EQ(answers_.hits.size(), plain.hits.size());
  called_off.store(true);
  asked.give_up_ns = 0;
  answer(*state, asked, answers_, scratch_);
  ASSERT_EQ(answers_.answers.size(), 1U);
  EXPECT_EQ(answers_.answers[0], Verdict::undecided);
  EXPECT_EQ(answers_.reasons[0], UndecidedReason::deadline);
  EXPECT_LT(answers_.exact_tests[0], plain.exact_tests[0]);
}

std::vector<CostlyQuestion> costly_questions() {
  std::vector<CostlyQuestion> all;
  for (const bool moving : {false, true}) {
    const std::string of = moving ? "moving" : "static";
    all.push_back({"ray_" + of, QuestionKind::ray, HitMode::all, moving, {0, 0, 0, 1, 0, 0, 1e6}});
    all.push_back({"sphere_" + of, QuestionKind::sphere, HitMode::closest, moving, {0, 0, 0, 1.0005}});
    all.push_back({"box_" + of, QuestionKind::box, HitMode::closest, moving, {0, 0, 0, 2, 2, 2, 1, 0, 0, 0}});
    all.push_back({"near_" + of, QuestionKind::near, HitMode::closest, moving, {0, 0, 0, 10}});
    all.push_back(
        {"sweep_" + of, QuestionKind::sweep, HitMode::closest, moving, {0, 0, 0, 1, 0, 0, 0, 0, 0, 0.002, 1, 0, 0, 0}});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(EveryKind, CostlyQuestions, testing::ValuesIn(costly_questions()),
                         [](const auto& given) { return given.param.name; });

/// Two shells a millimetre apart, so that every triangle has others near it, or one in the other's surface.
class CostlyPairs : public testing::TestWithParam<bool> {
 protected:
  static ObjectDefinition shell(const std::string& name, double radius_m) {
    ObjectDefinition definition;
    definition.name = name;
    // Costly enough that the shortest deadline below is far longer than eight tests, between two looks at the clock.
    definition.shape.mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(kShellLevels + 1, radius_m));
    definition.moving = true;
    return definition;
  }
  void SetUp() override {
    inner_ = std::get<ObjectId>(world_.define(shell("inner", 0.999)));
    outer_ = std::get<ObjectId>(world_.define(shell("outer", GetParam() ? 0.9989 : 1)));
    ASSERT_TRUE(
        world_.move(outer_, {.position = {GetParam() ? 0.001 : 0, 0, 0}, .rotation = Quat::Identity()}, 1, false));
    ASSERT_TRUE(world_.step(1'000'000'000, 1, {}));
  }
  std::int64_t examine(std::int64_t within_ns, const std::atomic<bool>* called_off = nullptr) {
    const SnapshotRing::Lease state = world_.newest();
    const std::int64_t start_ns = wire_contract::steady_ns();
    const std::int64_t busy_before_ns = busy_ns();
    report_ = report_pair(
        *state, inner_, outer_,
        {.triangles = true, .deadline_ns = within_ns == 0 ? 0 : start_ns + within_ns, .called_off = called_off});
    return busy_ns() - busy_before_ns;
  }

  World world_{WorldOptions{}};
  ObjectId inner_ = 0;
  ObjectId outer_ = 0;
  PairReport report_;
};

TEST_P(CostlyPairs, EndAtTheirDeadlineAndSaySo) {
  const std::int64_t whole_ns = examine(0);
  const PairReport whole = report_;
  EXPECT_EQ(whole.touches, GetParam() ? Decision::yes : Decision::no);
  EXPECT_FALSE(whole.is_late);
  // A deadline that falls into each of the report's parts.
  for (const std::int64_t share : {64, 8, 4, 2}) {
    std::int64_t fastest_ns = whole_ns;
    for (int i = 0; i < 3; ++i) {
      fastest_ns = std::min(fastest_ns, examine(whole_ns / share));
      if (share < 8 && !report_.is_late) continue;  // it had become faster
      ASSERT_TRUE(report_.is_late);
      ASSERT_EQ(report_.touches, Decision::undecided);
      ASSERT_TRUE(report_.manifold.empty());
      ASSERT_TRUE(report_.crossings.empty());
    }
    EXPECT_LE(fastest_ns, 2 * (whole_ns / share)) << "of " << whole_ns << " ns without a deadline";
  }
  examine(3'600'000'000'000);
  EXPECT_EQ(report_.touches, whole.touches);
  EXPECT_EQ(report_.contact.depth_m, whole.contact.depth_m);
  EXPECT_EQ(report_.separation.distance_m, whole.separation.distance_m);
  EXPECT_EQ(report_.separation.error_m, whole.separation.error_m);
  EXPECT_EQ(report_.contained, whole.contained);
  EXPECT_EQ(report_.crossing_count, whole.crossing_count);
}

// Whoever asked may go away meanwhile; until then it is examined as ever.
TEST_P(CostlyPairs, EndWhenTheyAreCalledOff) {
  std::atomic<bool> called_off{false};
  const std::int64_t whole_ns = examine(0, &called_off);
  const PairReport whole = report_;
  EXPECT_EQ(whole.touches, GetParam() ? Decision::yes : Decision::no);
  std::int64_t fastest_ns = whole_ns;
  for (int i = 0; i < 8; ++i) {
    called_off.store(false);
    std::thread asker([&] {
      std::this_thread::sleep_for(std::chrono::nanoseconds(whole_ns / 8));
      called_off.store(true);
    });
    const std::int64_t took_ns = examine(0, &called_off);
    asker.join();
    if (!report_.is_late) continue;  // the thread came too late
    EXPECT_EQ(report_.touches, Decision::undecided);
    fastest_ns = std::min(fastest_ns, took_ns);
  }
  EXPECT_LT(fastest_ns, whole_ns / 2);
}

INSTANTIATE_TEST_SUITE_P(ApartAndTouching, CostlyPairs, testing::Bool());

}  // namespace
}  // namespace collided::engine
