#include <gtest/gtest.h>

#include <cmath>

#include "server/world/query/query.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/oracle/mixed_world.hpp"
#include "tests/oracle/seed.hpp"

// U1: who asks for less gets it cheaper, never worse than asked, and every yes and no stays what it was.
namespace collided::engine {
namespace {

using oracle::MixedWorld;

constexpr double kErrors_m[] = {1e-12, 1e-6, 1e-3, 0.1, 2, 1e9};

struct ErrorAsked {
  Answers exact;
  Answers loose;
  std::uint64_t exact_nodes = 0;
  std::uint64_t loose_nodes = 0;
};

ErrorAsked ask_both(const Snapshot& snapshot, Questions questions, double error_m) {
  ErrorAsked asked;
  QueryScratch scratch;
  answer(snapshot, questions, asked.exact, scratch);
  questions.error_m = error_m;
  answer(snapshot, questions, asked.loose, scratch);
  for (const std::uint32_t nodes : asked.exact.nodes) asked.exact_nodes += nodes;
  for (const std::uint32_t nodes : asked.loose.nodes) asked.loose_nodes += nodes;
  return asked;
}

void expect_promise_kept(const ErrorAsked& asked, double error_m) {
  ASSERT_EQ(asked.exact.answers, asked.loose.answers);
  ASSERT_EQ(asked.exact.hit_counts, asked.loose.hit_counts);
  for (std::size_t i = 0; i < asked.loose.hits.size(); ++i) {
    const AnswerHit& exact = asked.exact.hits[i];
    const AnswerHit& loose = asked.loose.hits[i];
    EXPECT_LE(loose.error_m, std::max(error_m, exact.error_m));
    EXPECT_LE(std::abs(loose.distance_m - exact.distance_m), loose.error_m + exact.error_m) << i;
  }
}

TEST(WorldAskedError, RaysAreNeverOffByMoreThanAsked) {
  std::mt19937_64 random = oracle::seeded(31);
  MixedWorld mixed(random);
  std::vector<double> numbers;
  for (int i = 0; i < 500; ++i) {
    const Vec3 origin = mixed.point(6), direction = mixed.point(3) - origin;
    numbers.insert(numbers.end(),
                   {origin.x(), origin.y(), origin.z(), direction.x(), direction.y(), direction.z(), INFINITY});
  }
  const auto state = (*mixed).newest();
  for (const double error_m : kErrors_m) {
    expect_promise_kept(ask_both(*state, {.kind = QuestionKind::ray, .numbers = numbers}, error_m), error_m);
  }
}

TEST(WorldAskedError, NearestDistancesAreNeverOffByMoreThanAskedAndCostLess) {
  std::mt19937_64 random = oracle::seeded(32);
  MixedWorld mixed(random);
  std::vector<double> numbers;
  for (int i = 0; i < 500; ++i) {
    const Vec3 point = mixed.point(6);
    numbers.insert(numbers.end(), {point.x(), point.y(), point.z(), INFINITY});
  }
  const auto state = (*mixed).newest();
  for (const std::uint32_t nearest : {1u, 4u}) {
    for (const double error_m : kErrors_m) {
      const ErrorAsked asked =
          ask_both(*state, {.kind = QuestionKind::near, .max_hits = nearest, .numbers = numbers}, error_m);
      expect_promise_kept(asked, error_m);
      EXPECT_LE(asked.loose_nodes, asked.exact_nodes);
      if (error_m >= 2) { EXPECT_LT(asked.loose_nodes, asked.exact_nodes) << "half a scene of slack saves nothing"; }
    }
  }
}

TEST(WorldAskedError, OverlapsKeepEveryDecision) {
  std::mt19937_64 random = oracle::seeded(33);
  MixedWorld mixed(random);
  std::vector<double> numbers;
  for (int i = 0; i < 300; ++i) {
    const Vec3 center = mixed.point(4);
    numbers.insert(numbers.end(), {center.x(), center.y(), center.z(), mixed.uniform(0, 1)});
  }
  const auto state = (*mixed).newest();
  const Questions questions{.kind = QuestionKind::sphere, .numbers = numbers};
  for (const double error_m : kErrors_m) {
    const ErrorAsked asked = ask_both(*state, questions, error_m);
    ASSERT_EQ(asked.exact.answers, asked.loose.answers);
    ASSERT_EQ(asked.exact.hit_counts, asked.loose.hit_counts);
  }
}

// The distance grazes a wall at 1e-9 rad: exactly it costs an expansion, to a millimetre it is free.
TEST(WorldAskedError, AGrazingDistanceIsSharpenedOnlyForWhoNeedsIt) {
  World world(WorldOptions{});
  ObjectDefinition wall;
  wall.name = "wall";
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{-1e3, -1e3, 0.1}, {1e3, -1e3, 0.3}, {0, 2e3, 0.7}};
  mesh->triangles = {{0, 1, 2}};
  wall.shape.mesh = mesh;
  world.define(wall);
  world.step(0, 1, {});
  const Vec3 normal = (mesh->vertices[1] - mesh->vertices[0]).cross(mesh->vertices[2] - mesh->vertices[0]).normalized();
  const Vec3 along = (mesh->vertices[2] - mesh->vertices[0]).normalized();
  const Vec3 target = (mesh->vertices[0] + mesh->vertices[1] + mesh->vertices[2]) / 3;
  const Vec3 direction = along - 1e-9 * normal;
  const Vec3 origin = target - 100 * direction;
  const std::vector<double> numbers{origin.x(),    origin.y(),    origin.z(), direction.x(),
                                    direction.y(), direction.z(), INFINITY};
  const ErrorAsked asked = ask_both(*world.newest(), {.kind = QuestionKind::ray, .numbers = numbers}, 1e-2);
  ASSERT_EQ(asked.exact.answers[0], Verdict::hit);
  expect_promise_kept(asked, 1e-2);
  EXPECT_LT(asked.exact.hits[0].error_m, 1e-7);
  EXPECT_GT(asked.loose.hits[0].error_m, asked.exact.hits[0].error_m) << "the exact distance was worked out for nobody";
}

TEST(WorldAskedError, ALadderThatEndsAtDoubleSaysUndecidedAndNeverMiss) {
  World world(WorldOptions{});
  ObjectDefinition ball;
  ball.name = "ball";
  ball.shape.primitives.push_back(Sphere{{0, 0, 0}, 0.25});
  world.define(ball);
  world.step(0, 1, {});
  // 3-4-5, but for the roundings of 0.3 and 0.4: apart by 1e-17 m, less than a rounding of the squares.
  const std::vector<double> numbers{0.3, 0.4, 0, 0.25};
  Answers exact, capped;
  QueryScratch scratch;
  Questions questions{.kind = QuestionKind::sphere, .numbers = numbers};
  answer(*world.newest(), questions, exact, scratch);
  ASSERT_EQ(exact.answers[0], Verdict::miss);
  questions.highest = Level::filter;
  answer(*world.newest(), questions, capped, scratch);
  EXPECT_EQ(capped.answers[0], Verdict::undecided);
}

}  // namespace
}  // namespace collided::engine
