// Occupied cells are met exactly, and nothing is called free that reaches into unknown ones.
#include "server/world/query/unknown_space.hpp"

#include <gtest/gtest.h>

#include <random>

#include "server/intake/voxel_cells.hpp"
#include "server/world/groups/what_if.hpp"
#include "server/world/query/probes.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using oracle::Rational;

constexpr double kCell_m = 0.05000000074505806;
constexpr std::uint32_t kSide = 5;
constexpr std::int32_t kLow = -2;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::uint8_t> bits_of(const std::vector<bool>& cells) {
  std::vector<std::uint8_t> bytes((cells.size() + 7) / 8);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i]) bytes[i / 8] = static_cast<std::uint8_t>(bytes[i / 8] | 1U << (i % 8));
  }
  return bytes;
}

ObjectDefinition still(const std::string& name) {
  ObjectDefinition definition;
  definition.name = name;
  definition.moving = false;
  return definition;
}

ObjectDefinition cells_object(const std::string& name, const std::vector<bool>& cells, bool is_unknown) {
  const std::vector<std::uint8_t> bytes = bits_of(cells);
  const VoxelCells voxels{
      .cell_m = kCell_m, .low = {kLow, kLow, kLow}, .size = {kSide, kSide, kSide}, .occupied = bytes};
  EXPECT_EQ(flaw_of(voxels), "");
  ObjectDefinition definition = still(name);
  add_boxes_of(voxels, definition.shape.primitives);
  definition.shape.is_unknown = is_unknown;
  return definition;
}

/// A cube of cells, each occupied, unknown or free, in a world and as the boxes that they are.
struct Cells {
  explicit Cells(std::mt19937_64& random) {
    std::discrete_distribution<int> kind({80, 12, 8});
    std::vector<bool> are_occupied, are_unknown;
    for (std::uint32_t i = 0; i < kSide * kSide * kSide; ++i) {
      const int what = kind(random);
      are_occupied.push_back(what == 1);
      are_unknown.push_back(what == 2);
      const Vec3 number(i % kSide, i / kSide % kSide, i / kSide / kSide);
      const Box box{.center = (number.array() + (kLow + 0.5)).matrix() * kCell_m,
                    .half_m = Vec3::Constant(kCell_m / 2)};
      if (what == 1) occupied.push_back(box);
      if (what == 2) unknown.push_back(box);
    }
    define(cells_object("cells", are_occupied, false));
    define(cells_object("cells/unknown", are_unknown, true));
    EXPECT_TRUE(world.step(1, 1, {}));
  }
  void define(const ObjectDefinition& definition) {
    if (definition.shape.empty()) return;
    EXPECT_TRUE(std::holds_alternative<ObjectId>(world.define(definition)));
  }
  Answers ask(QuestionKind kind, const std::vector<double>& numbers, std::string_view skip = {}) {
    Answers answers;
    answer(*world.newest(), {.kind = kind, .skip = skip, .numbers = numbers}, answers, scratch);
    return answers;
  }
  World world{WorldOptions{}};
  QueryScratch scratch;
  std::vector<Box> occupied, unknown;
};

template <class Number>
std::optional<Number> least(const std::vector<Box>& boxes, const auto& of) {
  std::optional<Number> found;
  for (const Box& box : boxes) {
    const std::optional<Number> one = of(box);
    if (one && (!found || *one < *found)) found = one;
  }
  return found;
}

/// From a point to a box along the axes, by clamping in rationals.
Rational square_between(const Vec3& point, const Box& box) {
  Rational sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Rational at(point[axis]);
    const Rational low = Rational(box.center[axis]) - Rational(box.half_m[axis]);
    const Rational high = Rational(box.center[axis]) + Rational(box.half_m[axis]);
    const Rational off = at < low ? Rational(low - at) : at > high ? Rational(at - high) : Rational(0);
    sum += off * off;
  }
  return sum;
}

Vec3 random_point(std::mt19937_64& random) {
  // Some on the lattice of corners and middles.
  std::uniform_real_distribution<double> spread(-0.3, 0.3);
  std::uniform_int_distribution<int> number(-10, 10), is_odd(0, 3);
  Vec3 point;
  for (double& x : point) x = is_odd(random) == 0 ? number(random) * (kCell_m / 2) : spread(random);
  return point;
}

TEST(UnknownSpace, RaysAreDecidedAsByRationals) {
  std::mt19937_64 random = oracle::seeded(251);
  int hit_count = 0, undecided_count = 0, miss_count = 0;
  for (int world = 0; world < 12; ++world) {
    Cells cells(random);
    for (int i = 0; i < 60; ++i) {
      const Vec3 from = random_point(random);
      const Vec3 along = random_point(random) - from;
      if (along.isZero(0)) continue;
      const Ray ray{.origin = from, .direction = along, .length_m = kInfinity};
      const auto parameter = [&](const Box& box) { return oracle::first_parameter(ray, box); };
      const std::optional<Rational> hit = least<Rational>(cells.occupied, parameter);
      const std::optional<Rational> unknown = least<Rational>(cells.unknown, parameter);
      const Answers answers =
          cells.ask(QuestionKind::ray, {from.x(), from.y(), from.z(), along.x(), along.y(), along.z(), kInfinity});
      if (answers.answers[0] == Verdict::hit) {
        ++hit_count;
        ASSERT_TRUE(hit);
        EXPECT_TRUE(!unknown || *unknown >= *hit);
      } else if (answers.answers[0] == Verdict::miss) {
        ++miss_count;
        EXPECT_FALSE(hit);
        EXPECT_FALSE(unknown);
      } else {
        ++undecided_count;
        EXPECT_EQ(answers.reasons[0], UndecidedReason::not_covered);
        ASSERT_TRUE(unknown);
        // Within the hit's own bound it is not told which comes first.
        if (hit) { EXPECT_LE(*unknown, *hit * (1 + Rational(1, std::int64_t{1} << 40))); }
        ASSERT_EQ(answers.not_covered.size(), 1U);
        const double reach_m = static_cast<double>(*unknown) * along.norm();
        EXPECT_NEAR(answers.not_covered[0].leaving.covered_m, reach_m, 1e-12);
      }
      if (!answers.hits.empty()) {
        ASSERT_TRUE(hit);
        const double distance_m = static_cast<double>(*hit) * along.norm();
        EXPECT_NEAR(answers.hits[0].distance_m, distance_m, answers.hits[0].error_m + 1e-15);
      }
    }
  }
  std::printf("%d hits, %d misses, %d undecided\n", hit_count, miss_count, undecided_count);
  EXPECT_GT(std::min({hit_count, miss_count, undecided_count}), 20);
}

TEST(UnknownSpace, SpheresAreDecidedAsByRationals) {
  std::mt19937_64 random = oracle::seeded(252);
  std::uniform_real_distribution<double> radius(0, 0.12);
  int counts[3] = {};
  for (int world = 0; world < 12; ++world) {
    Cells cells(random);
    for (int i = 0; i < 150; ++i) {
      const Sphere ball{.center = random_point(random), .radius_m = i % 4 == 0 ? kCell_m / 2 : radius(random)};
      const auto meets = [&](const Box& box) {
        const Rational radius_m(ball.radius_m);
        return square_between(ball.center, box) <= radius_m * radius_m ? std::optional<int>(1) : std::nullopt;
      };
      const bool is_hit = least<int>(cells.occupied, meets).has_value();
      const bool is_unknown = least<int>(cells.unknown, meets).has_value();
      const Verdict expected = is_hit ? Verdict::hit : is_unknown ? Verdict::undecided : Verdict::miss;
      const std::vector<double> numbers{ball.center.x(), ball.center.y(), ball.center.z(), ball.radius_m};
      EXPECT_EQ(cells.ask(QuestionKind::sphere, numbers).answers[0], expected);
      EXPECT_EQ(cells.ask(QuestionKind::sphere, numbers, "*unknown*").answers[0], is_hit ? Verdict::hit : Verdict::miss)
          << "left out by name, unknown space is free";
      ++counts[static_cast<int>(expected)];
    }
  }
  EXPECT_GT(std::min({counts[0], counts[1], counts[2]}), 20);
}

TEST(UnknownSpace, BoxesAndNearestAreDecidedAsByRationals) {
  std::mt19937_64 random = oracle::seeded(253);
  std::uniform_real_distribution<double> half(0.001, 0.06), reach(0, 0.2);
  for (int world = 0; world < 8; ++world) {
    Cells cells(random);
    for (int i = 0; i < 40; ++i) {
      const Vec3 at = random_point(random);
      const Box asked{.center = at, .half_m = {half(random), half(random), half(random)}};
      const auto meets = [&](const Box& box) {
        return oracle::overlaps_by_clipping(asked, box) ? std::optional<int>(1) : std::nullopt;
      };
      const bool is_hit = least<int>(cells.occupied, meets).has_value();
      const bool is_unknown = least<int>(cells.unknown, meets).has_value();
      const Vec3& h = asked.half_m;
      const Answers box = cells.ask(QuestionKind::box, {at.x(), at.y(), at.z(), h.x(), h.y(), h.z(), 1, 0, 0, 0});
      EXPECT_EQ(box.answers[0], is_hit ? Verdict::hit : is_unknown ? Verdict::undecided : Verdict::miss);

      const double within_m = reach(random);
      const auto square = [&](const Box& to) -> std::optional<Rational> {
        const Rational found = square_between(at, to);
        return found <= Rational(within_m) * Rational(within_m) ? std::optional(found) : std::nullopt;
      };
      const std::optional<Rational> nearest = least<Rational>(cells.occupied, square);
      const std::optional<Rational> unknown = least<Rational>(cells.unknown, square);
      Answers near;
      const std::vector<double> numbers{at.x(), at.y(), at.z(), within_m};
      answer(*cells.world.newest(), {.kind = QuestionKind::near, .max_hits = 1, .numbers = numbers}, near,
             cells.scratch);
      const Rational slack = 1 + Rational(1, std::int64_t{1} << 40);
      if (near.answers[0] == Verdict::hit) {
        EXPECT_TRUE(nearest && (!unknown || *nearest <= *unknown));
      } else if (near.answers[0] == Verdict::miss) {
        EXPECT_TRUE(!nearest && !unknown);
      } else {
        EXPECT_EQ(near.reasons[0], UndecidedReason::not_covered);
        EXPECT_TRUE(unknown && (!nearest || *unknown <= *nearest * slack));
      }
      EXPECT_EQ(near.hits.size(), nearest ? 1U : 0U);
    }
  }
}

TEST(UnknownSpace, NothingPassesBetweenNeighbours) {
  // A wall of single cells, and rays right at the borders and corners between them.
  std::vector<bool> wall(kSide * kSide * kSide, false);
  for (std::size_t i = 0; i < wall.size(); i += kSide) wall[i] = true;
  World world{WorldOptions{}};
  ASSERT_TRUE(std::holds_alternative<ObjectId>(world.define(cells_object("wall", wall, false))));
  ASSERT_TRUE(world.step(1, 1, {}));
  QueryScratch scratch;
  for (int y = 2 * kLow; y <= 2 * (kLow + 5); ++y) {
    for (int z = 2 * kLow; z <= 2 * (kLow + 5); ++z) {
      for (const double skew : {0.0, 1e-17, -0x1p-60}) {
        const std::vector<double> ray{-3, y * (kCell_m / 2), z * (kCell_m / 2), 1, 0, skew, kInfinity};
        Answers answers;
        answer(*world.newest(), {.kind = QuestionKind::ray, .numbers = ray}, answers, scratch);
        const bool is_beside = z == 2 * kLow && skew < 0;
        const bool is_above = z == 2 * (kLow + 5) && skew > 0;
        if (!is_beside && !is_above) { EXPECT_EQ(answers.answers[0], Verdict::hit) << y << ' ' << z << ' ' << skew; }
      }
    }
  }
}

TEST(UnknownSpace, ASweepIsUndecidedFromWhereItReachesIn) {
  std::vector<bool> unknown(kSide * kSide * kSide, false);
  unknown[0] = true;  // from -0.1 to -0.05 along each axis
  World world{WorldOptions{}};
  ASSERT_TRUE(std::holds_alternative<ObjectId>(world.define(cells_object("scan/unknown", unknown, true))));
  ObjectDefinition post = still("post");
  post.shape.primitives.emplace_back(Sphere{.center = {1, -0.075, -0.075}, .radius_m = 0.1});
  ASSERT_TRUE(std::holds_alternative<ObjectId>(world.define(post)));
  ASSERT_TRUE(world.step(1, 1, {}));
  ObjectInfo mover;
  mover.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = 0.01}};
  QueryScratch scratch;
  const auto sweep = [&](double from, double to) {
    Answers answers;
    const std::vector<double> numbers{from, -0.075, -0.075, 1, 0, 0, 0, to, -0.075, -0.075, 1, 0, 0, 0};
    answer(*world.newest(), {.kind = QuestionKind::sweep, .numbers = numbers, .mover = &mover}, answers, scratch);
    return answers;
  };
  EXPECT_EQ(sweep(0, 0.5).answers[0], Verdict::miss);
  EXPECT_EQ(sweep(0, 1).answers[0], Verdict::hit);
  EXPECT_EQ(sweep(-1, -0.5).answers[0], Verdict::miss);
  const Answers through = sweep(-1, 1);
  EXPECT_EQ(through.answers[0], Verdict::undecided);
  EXPECT_EQ(through.reasons[0], UndecidedReason::not_covered);
  EXPECT_EQ(through.hits.size(), 1U) << "what was found stays in the answer";
  EXPECT_NEAR(through.not_covered.at(0).leaving.point.x(), -0.11, 1e-6);
}

TEST(UnknownSpace, MoversMeetItWithoutAContact) {
  std::vector<bool> unknown(kSide * kSide * kSide, true);
  World world{WorldOptions{}};
  ASSERT_TRUE(std::holds_alternative<ObjectId>(world.define(cells_object("scan/unknown", unknown, true))));
  ObjectDefinition drone = still("drone");
  drone.moving = true;
  drone.shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.1});
  const auto id = world.define(drone);
  ASSERT_TRUE(std::holds_alternative<ObjectId>(id));
  ASSERT_TRUE(world.step(1, 1, {}));
  EXPECT_TRUE(world.contacts().empty());
  // But where it is thought to be free, and where a probe looks, that is undecided.
  const auto at = unknown_near(*world.newest(), std::vector{Aabb{Vec3::Constant(-0.4), Vec3::Constant(-0.3)}}, 0.1);
  EXPECT_FALSE(at);
  EXPECT_TRUE(unknown_near(*world.newest(), std::vector{Aabb{Vec3::Constant(-0.4), Vec3::Constant(-0.3)}}, 0.21));
}

TEST(UnknownSpace, BoxesHoldTheirCellsOnceEach) {
  std::mt19937_64 random = oracle::seeded(254);
  std::bernoulli_distribution is_set(0.6);
  for (int i = 0; i < 50; ++i) {
    std::vector<bool> cells(kSide * kSide * kSide);
    for (auto cell : cells) cell = is_set(random);
    const std::vector<std::uint8_t> bytes = bits_of(cells);
    const VoxelCells voxels{.cell_m = 1, .low = {0, 0, 0}, .size = {kSide, kSide, kSide}, .occupied = bytes};
    std::vector<Primitive> boxes;
    add_boxes_of(voxels, boxes);
    std::vector<int> filled(cells.size(), 0);
    for (const Primitive& any : boxes) {
      const Box& box = std::get<Box>(any);
      for (std::size_t at = 0; at < cells.size(); ++at) {
        const Vec3 middle(static_cast<double>(at % kSide) + 0.5, static_cast<double>(at / kSide % kSide) + 0.5,
                          static_cast<double>(at / kSide / kSide) + 0.5);
        filled[at] += ((middle - box.center).cwiseAbs().array() < box.half_m.array()).all() ? 1 : 0;
      }
    }
    for (std::size_t at = 0; at < cells.size(); ++at) EXPECT_EQ(filled[at], cells[at] ? 1 : 0);
  }
}

// A busy machine may hold an answering thread up between a question and its look at unknown space.
TEST(UnknownSpace, AQuestionWhoseTurnIsOverIsNotUndecidedForThat) {
  std::vector<bool> corners(kSide * kSide * kSide, false);
  corners.front() = corners.back() = true;
  World world{WorldOptions{}};
  ASSERT_TRUE(std::holds_alternative<ObjectId>(world.define(cells_object("corners/unknown", corners, true))));
  ASSERT_TRUE(world.step(1, 1, {}));
  QueryScratch scratch;
  Answers answers;
  constexpr std::int64_t kLongAgo = 1;
  // Past an edge of the first cell, so near that it has to be tested.
  const std::vector<double> ray{-1.04995, 0.95005, -0.075, 1, -1, 0, kInfinity};
  answer(*world.newest(), {.kind = QuestionKind::ray, .give_up_ns = kLongAgo, .numbers = ray}, answers, scratch);
  ASSERT_EQ(answers.answers.size(), 1U);
  EXPECT_EQ(answers.answers[0], Verdict::miss);
  EXPECT_GT(answers.exact_tests[0], 0U);
}

}  // namespace
}  // namespace collided::engine
