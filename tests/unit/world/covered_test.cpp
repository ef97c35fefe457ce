// Free is said only of what the loaded geometry covers.
#include "server/world/query/covered.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "server/intake/scene.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/probes.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t kCoveredSecond = 1'000'000'000;

ObjectDefinition ball(const std::string& name, const Vec3& position, double radius_m) {
  Shape shape;
  shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = radius_m});
  return {.name = name,
          .scene = {},
          .shape = shape,
          .pose = {.position = position},
          .filter = {},
          .moving = false,
          .lost_policy = LostPolicy::freeze,
          .publisher = 0};
}

Aabb box(const Vec3& low, const Vec3& high) { return {.low = low, .high = high}; }

/// A post of radius 1 at the origin, and one at y = 14; covered from -10 to 10 along each axis unless said otherwise.
struct Covered {
  explicit Covered(std::vector<Aabb> covers = {box(Vec3::Constant(-10), Vec3::Constant(10))}) {
    static_cast<void>(world.define(ball("post", Vec3::Zero(), 1)));
    static_cast<void>(world.define(ball("far", {0, 14, 0}, 1)));
    world.state_covers("", covers);
    step();
  }
  void step() { ASSERT_TRUE(world.step(++seconds * kCoveredSecond, 1, {})); }
  Answers ask(QuestionKind kind, std::vector<double> numbers, HitMode mode = HitMode::closest,
              const ObjectInfo* mover = nullptr, std::uint32_t max_hits = 1'000) {
    Answers answers;
    answer(*world.newest(), {.kind = kind, .mode = mode, .max_hits = max_hits, .numbers = numbers, .mover = mover},
           answers, scratch);
    return answers;
  }
  Verdict verdict(QuestionKind kind, std::vector<double> numbers, HitMode mode = HitMode::closest) {
    return ask(kind, std::move(numbers), mode).answers[0];
  }
  World world{WorldOptions{}};
  QueryScratch scratch;
  std::int64_t seconds = 0;
};

/// Undecided for that reason, and it is said where the covered space ends.
void expect_not_covered(const Answers& answers, const Vec3& point, std::size_t hits = 0) {
  EXPECT_EQ(answers.answers[0], Verdict::undecided);
  EXPECT_EQ(answers.reasons[0], UndecidedReason::not_covered);
  EXPECT_EQ(answers.hits.size(), hits);
  EXPECT_EQ(answers.hit_counts[0], hits);
  ASSERT_EQ(answers.not_covered.size(), 1U);
  EXPECT_EQ(answers.not_covered[0].question, 0U);
  const Vec3& end = answers.not_covered[0].leaving.point;
  EXPECT_LT((end - point).norm(), 1e-9) << end.transpose();
}

TEST(Covered, AMissIsOneOnlyWhereAllThatWasAskedIsCovered) {
  Covered world;
  EXPECT_EQ(world.verdict(QuestionKind::ray, {0, 5, 0, 0, 0, 1, 9}), Verdict::miss);
  expect_not_covered(world.ask(QuestionKind::ray, {0, 5, 0, 0, 0, 2, 11}), {0, 5, 10});
  EXPECT_NEAR(world.ask(QuestionKind::ray, {0, 5, 0, 0, 0, 2, 11}).not_covered[0].leaving.covered_m, 10, 1e-9);
  expect_not_covered(world.ask(QuestionKind::ray, {0, 5, 0, 3, 4, 0, kInfinity}), {3.75, 10, 0});
  expect_not_covered(world.ask(QuestionKind::ray, {0, 50, 0, 0, 1, 0, 1}), {0, 50, 0});
  EXPECT_EQ(world.verdict(QuestionKind::sphere, {5, 5, 5, 4}), Verdict::miss);
  expect_not_covered(world.ask(QuestionKind::sphere, {5, 5, -7, 4}), {5, 5, -10});
  EXPECT_EQ(world.verdict(QuestionKind::box, {5, 5, 5, 1, 2, 5, 1, 0, 0, 0}), Verdict::miss);
  expect_not_covered(world.ask(QuestionKind::box, {5, 5, 5, 1, 6, 5, 1, 0, 0, 0}), {5, 10, 5});
  expect_not_covered(world.ask(QuestionKind::box, {8, 5, 5, 1, 4, 1, 0.6, 0, 0, 0.8}), {10, 5, 5});
  expect_not_covered(world.ask(QuestionKind::near, {5, 0, 0, 6}, HitMode::closest, nullptr, 2), {10, 0, 0}, 1);
}

// A nearest hit says that nothing is nearer; that something is there needs no more than the hit.
TEST(Covered, AHitStaysWhereNothingUnknownCouldBeBeforeIt) {
  Covered world;
  EXPECT_EQ(world.verdict(QuestionKind::ray, {0, 0, 5, 0, 0, -1, kInfinity}), Verdict::hit);
  expect_not_covered(world.ask(QuestionKind::ray, {0, 0, 15, 0, 0, -1, kInfinity}), {0, 0, 15}, 1);
  EXPECT_EQ(world.verdict(QuestionKind::ray, {0, 0, 15, 0, 0, -1, kInfinity}, HitMode::any), Verdict::hit);
  expect_not_covered(world.ask(QuestionKind::ray, {0, 2, 0, 0, 1, 0, kInfinity}), {0, 10, 0}, 1);
  EXPECT_EQ(world.verdict(QuestionKind::ray, {0, 2, 0, 0, 1, 0, kInfinity}, HitMode::any), Verdict::hit);
  EXPECT_EQ(world.verdict(QuestionKind::ray, {0, 0, 5, 0, 0, -1, 15}, HitMode::all), Verdict::hit);
  expect_not_covered(world.ask(QuestionKind::ray, {0, 0, 5, 0, 0, -1, 16}, HitMode::all), {0, 0, -10}, 1);
  EXPECT_EQ(world.verdict(QuestionKind::sphere, {9, 0, 0, 8.5}), Verdict::hit);
  EXPECT_EQ(world.ask(QuestionKind::near, {5, 0, 0, kInfinity}, HitMode::closest, nullptr, 1).answers[0], Verdict::hit);
  EXPECT_EQ(world.ask(QuestionKind::near, {8, 0, 0, kInfinity}, HitMode::closest, nullptr, 1).answers[0],
            Verdict::undecided);
  Shape shape;
  shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 1});
  const ObjectInfo mover = without_world(shape);
  const auto sweep = [&](double from, double to) {
    return world.ask(QuestionKind::sweep, {from, 0, 0, 1, 0, 0, 0, to, 0, 0, 1, 0, 0, 0}, HitMode::closest, &mover);
  };
  EXPECT_EQ(sweep(8, 3).answers[0], Verdict::miss);
  EXPECT_EQ(sweep(8, -50).answers[0], Verdict::hit) << "what comes after the contact is not asked about";
  expect_not_covered(sweep(9.5, -50), {10, 0, 0}, 1);
}

// The border belongs to what is covered, and the next double does not.
TEST(Covered, TheBorderIsExact) {
  const double tenth = 0.1;  // no fraction of two: 3 * 0.1 and 0.3 differ
  Covered world({box({-1, -1, 0.25}, {tenth * 3, 5, 1})});
  const double length = 5 - 1.5;
  const auto up = [](double x) { return std::nextafter(x, kInfinity); };
  EXPECT_EQ(world.verdict(QuestionKind::ray, {0, 1.5, 0.3, 0, 1, 0, length}), Verdict::miss);
  EXPECT_EQ(world.verdict(QuestionKind::ray, {0, 1.5, 0.3, 0, 1, 0, up(length)}), Verdict::undecided);
  // 0.1 + 0.2 rounds to 0.3 and a bit, which is 3 * 0.1; the exact sum lies below it.
  EXPECT_EQ(world.verdict(QuestionKind::ray, {0.1, 2, 0.3, 1, 0, 0, 0.2}), Verdict::miss);
  EXPECT_EQ(world.verdict(QuestionKind::ray, {0.1, 2, 0.3, 1, 0, 0, up(up(0.2))}), Verdict::undecided);
  EXPECT_EQ(world.verdict(QuestionKind::sphere, {0.2, 2, 0.3, 0.3 - 0.25}), Verdict::miss);
  EXPECT_EQ(world.verdict(QuestionKind::sphere, {0.2, 2, 0.3, up(0.3 - 0.25)}), Verdict::undecided);
  // Where a direction's own length is rounded coarsely, or its square overflows.
  Covered slim({box({0, -9, -9}, {0.1, 9, 9})});
  const double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(slim.verdict(QuestionKind::ray, {0, 5, 0, 3 * least, 2 * least, 0, 0.123}), Verdict::undecided)
      << "it ends at 0.102";
  EXPECT_EQ(slim.verdict(QuestionKind::ray, {0, 5, 0, 1e290, 1e290, 1e290, 0.25}), Verdict::undecided)
      << "it ends at 0.144";
  EXPECT_EQ(slim.verdict(QuestionKind::ray, {0, 5, 0, 1e290, 1e290, 1e290, 0.09}), Verdict::miss);
}

TEST(Covered, NothingIsStatedByDefaultAndUnsaidByTakingAway) {
  World world{WorldOptions{}};
  QueryScratch scratch;
  std::int64_t time_ns = 0;
  const auto verdict = [&](double aside = 0) {
    EXPECT_TRUE(world.step(++time_ns, 1, {}));
    const std::vector<double> numbers{0, 5, 0, 0, aside, 1, 9};
    Answers answers;
    answer(*world.newest(), {.kind = QuestionKind::ray, .numbers = numbers}, answers, scratch);
    return answers.answers[0];
  };
  EXPECT_EQ(verdict(), Verdict::miss);
  world.state_covers("hall", {{box({-1, -1, -1}, {1, 10, 10})}});
  EXPECT_EQ(verdict(), Verdict::miss);
  world.remove_scene("shed");
  EXPECT_EQ(verdict(), Verdict::miss);
  world.remove_scene("hall");
  EXPECT_EQ(verdict(), Verdict::undecided) << "with the hall went the knowledge, not the doubt";
  world.state_covers("", {{box(Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity))}});
  EXPECT_EQ(verdict(), Verdict::miss);
  // Two that touch contain the ray together.
  world.state_covers("", {{box({-1, -1, -1}, {1, 10, 5})}});
  EXPECT_EQ(verdict(), Verdict::undecided);
  world.state_covers("next", {{box({-1, -1, 5}, {1, 10, 10})}});
  EXPECT_EQ(verdict(), Verdict::miss);
  EXPECT_EQ(verdict(0.1), Verdict::miss);
  world.state_covers("next", {{box({-1, -1, std::nextafter(5, 6)}, {1, 10, 10})}});
  EXPECT_EQ(verdict(), Verdict::undecided) << "there is a gap of one double";
  EXPECT_EQ(verdict(0.1), Verdict::undecided);
}

TEST(Covered, AProbeThatLooksOutOfItIsUndecided) {
  Covered world;
  static_cast<void>(world.world.define(ball("carrier", {6, 0, 0}, 0.5)));
  world.step();
  Probes probes;
  const auto state = [&](double reach_m, const Vec3& direction) {
    EXPECT_FALSE(probes.set({.name = "eye",
                             .object = "carrier",
                             .origin = {0, 0, 0},
                             .direction = direction,
                             .reach_m = reach_m,
                             .back_m = 0}));
    std::vector<ProbeReading> readings;
    probes.read(
        *world.world.newest(), [&](std::string_view name) { return world.world.find(name); }, readings);
    return readings.at(0).state;
  };
  EXPECT_EQ(state(3, {1, 0, 0}), ProbeState::nothing);
  EXPECT_EQ(state(5, {1, 0, 0}), ProbeState::undecided);
  EXPECT_EQ(state(100, {-1, 0, 0}), ProbeState::gap);
}

/// Numbers of a question near the origin.
std::vector<double> any_question(QuestionKind kind, std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-12, 12);
  std::uniform_real_distribution<double> size(0, 5);
  const auto point = [&] { return Vec3(coordinate(random), coordinate(random), coordinate(random)); };
  const Vec3 p = point();
  const Vec3 q = point();
  switch (kind) {
    case QuestionKind::ray: return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), 4 * size(random)};
    case QuestionKind::sphere: return {p.x(), p.y(), p.z(), size(random)};
    case QuestionKind::box: return {p.x(), p.y(), p.z(), size(random), size(random), size(random), 0.6, 0, 0.8, 0};
    case QuestionKind::near: return {p.x(), p.y(), p.z(), 4 * size(random)};
    default: return {p.x(), p.y(), p.z(), 1, 0, 0, 0, q.x(), q.y(), q.z(), 0.6, 0, 0.8, 0};
  }
}

/// A block of covered space in pieces that touch, cut at random planes; one of them may be missing.
std::vector<Aabb> pieces(std::mt19937_64& random, bool all) {
  std::uniform_real_distribution<double> coordinate(-10, 10);
  std::vector<double> cuts[3];
  for (std::vector<double>& along : cuts) {
    along = {-10, 10};
    for (int i = 0; i < 4; ++i) along.push_back(coordinate(random));
    std::sort(along.begin(), along.end());
  }
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < 125; ++i) {
    const std::size_t at[3] = {i % 5, i / 5 % 5, i / 25};
    Aabb piece;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      piece.low[static_cast<int>(axis)] = cuts[axis][at[axis]];
      piece.high[static_cast<int>(axis)] = cuts[axis][at[axis] + 1];
    }
    boxes.push_back(piece);
  }
  std::shuffle(boxes.begin(), boxes.end(), random);
  if (!all) boxes.pop_back();
  return boxes;
}

// Pieces that touch cover what the block covers, however it is cut: rays from piece to piece, and balls over many.
TEST(Covered, PiecesThatTouchAreAsGoodAsTheWhole) {
  std::mt19937_64 random = oracle::seeded(44);
  Shape shape;
  shape.primitives.emplace_back(Sphere{.center = {0, 0, 0}, .radius_m = 1});
  const ObjectInfo mover = without_world(shape);
  Covered whole;
  int covered = 0, not_covered = 0;
  constexpr QuestionKind kKinds[] = {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box, QuestionKind::near,
                                     QuestionKind::sweep};
  for (int cut = 0; cut < 30; ++cut) {
    Covered parts(pieces(random, true));
    for (int i = 0; i < 200; ++i) {
      const QuestionKind kind = kKinds[i % 5];
      const std::vector<double> numbers = any_question(kind, random);
      const Answers of_whole = whole.ask(kind, numbers, HitMode::closest, &mover, 1);
      const Answers of_parts = parts.ask(kind, numbers, HitMode::closest, &mover, 1);
      ASSERT_EQ(of_parts.reasons[0], of_whole.reasons[0]) << "cut " << cut << ", question " << i;
      const bool is_covered = of_whole.reasons[0] != UndecidedReason::not_covered;
      covered += is_covered ? 1 : 0;
      not_covered += is_covered ? 0 : 1;
      if (!is_covered && kind == QuestionKind::ray) {
        EXPECT_NEAR(of_parts.not_covered[0].leaving.covered_m, of_whole.not_covered[0].leaving.covered_m, 1e-9);
      }
    }
  }
  EXPECT_GT(covered, 1'000);
  EXPECT_GT(not_covered, 1'000);
}

// Along and across the seams, on them and through edges and corners where pieces meet.
TEST(Covered, SeamsLetNothingThroughAndHoldNothingUp) {
  std::vector<Aabb> tiles;
  for (int i = 0; i < 64; ++i) {
    const Vec3 low(i % 4, i / 4 % 4, i / 16);
    tiles.push_back(box(low, low + Vec3::Ones()));
  }
  Covered world(tiles);
  const std::vector<double> within[] = {{0, 0, 0, 4, 4, 4, 6.928},   {0.5, 2, 1.5, 3, 0, 0.25, 3},
                                        {2, 2, 0, 0, 0, 1, 4},       {0.25, 1, 0.5, 0.3, 0, 0.4, 3},
                                        {0.1, 0.2, 0.3, 1, 1, 1, 6}, {4, 4, 0.5, -1, -1, 0, 5.6}};
  for (const std::vector<double>& ray : within)
    EXPECT_EQ(world.ask(QuestionKind::ray, ray, HitMode::all).reasons[0], UndecidedReason::none)
        << ray[3] << ' ' << ray[4];
  EXPECT_EQ(world.verdict(QuestionKind::sphere, {2, 2, 2, 0.99999}),
            world.verdict(QuestionKind::sphere, {2, 2, 2, 0.5}));
  // Without one of them.
  tiles.erase(tiles.begin() + 21);  // from 1, 1, 1
  Covered holed(tiles);
  EXPECT_EQ(holed.ask(QuestionKind::ray, {0, 0, 0, 4, 4, 4, 6.928}, HitMode::all).reasons[0],
            UndecidedReason::not_covered);
  EXPECT_NEAR(holed.ask(QuestionKind::ray, {0, 0, 0, 4, 4, 4, 6.928}, HitMode::all).not_covered[0].leaving.covered_m,
              std::sqrt(3.0), 1e-9);
  EXPECT_EQ(holed.ask(QuestionKind::near, {1.5, 1.5, 3, 0.9}).reasons[0], UndecidedReason::none);
  expect_not_covered(holed.ask(QuestionKind::sphere, {2.5, 2.5, 1.5, 0.75}), {2, 2, 1.5}, 0);
}

// The slow twin puts something to many places outside of what is covered: wherever that changes an answer, the answer given
// without knowing was in doubt.
TEST(Covered, NothingOutsideContradictsWhatWasAnswered) {
  std::mt19937_64 random = oracle::seeded(43);
  std::uniform_real_distribution<double> coordinate(-13, 13);
  Covered world({box(Vec3::Constant(-10), Vec3(10, 10, 4)), box(Vec3(-3, -3, 4), Vec3(3, 3, 15))});
  Covered there({box(Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity))});
  const auto stranger = std::get<ObjectId>(there.world.define(ball("stranger", {50, 0, 0}, 1)));
  Shape shape;
  shape.primitives.emplace_back(Sphere{.center = {0, 0, 0}, .radius_m = 1});
  const ObjectInfo mover = without_world(shape);
  const auto outside = [&] {
    for (;;) {
      const Vec3 center(coordinate(random), coordinate(random), coordinate(random));
      const Aabb around = bounds(Sphere{center, 1});
      const auto& covers = *world.world.newest()->covers;
      if (std::none_of(covers.begin(), covers.end(), [&](const Aabb& cover) { return overlaps(around, cover); }))
        return center;
    }
  };
  constexpr QuestionKind kKinds[] = {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box, QuestionKind::near,
                                     QuestionKind::sweep};
  int contradicted = 0, doubted = 0, sure = 0, changed = 0;
  for (int place = 0; place < 1'000; ++place) {
    there.world.move(stranger, {.position = outside()}, (place + 1) * kCoveredSecond, true);
    there.step();
    for (int i = 0; i < 40; ++i) {
      const QuestionKind kind = kKinds[i % 5];
      const std::vector<double> numbers = any_question(kind, random);
      const Answers given = world.ask(kind, numbers, HitMode::closest, &mover, 1);
      const Answers truth = there.ask(kind, numbers, HitMode::closest, &mover, 1);
      const bool is_of_stranger = !truth.hits.empty() && truth.hits[0].object == stranger;
      const bool is_overlap = kind == QuestionKind::sphere || kind == QuestionKind::box;
      const bool differs = truth.answers[0] == Verdict::hit && is_of_stranger &&
                           (!is_overlap || given.hits.empty() || given.answers[0] != Verdict::hit);
      changed += differs ? 1 : 0;
      doubted += given.reasons[0] == UndecidedReason::not_covered ? 1 : 0;
      sure += given.answers[0] != Verdict::undecided ? 1 : 0;
      contradicted += differs && given.answers[0] != Verdict::undecided ? 1 : 0;
    }
  }
  EXPECT_EQ(contradicted, 0);
  EXPECT_GT(changed, 300);
  EXPECT_GT(doubted, 1'000);
  EXPECT_GT(sure, 1'000);
}

}  // namespace
}  // namespace collided::engine
