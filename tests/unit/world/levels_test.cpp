#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "server/exact_phase/distance/closest.hpp"
#include "server/intake/simplify/simplify.hpp"
#include "server/world/objects/scene_levels.hpp"
#include "server/world/objects/surface_distance.hpp"
#include "server/world/audit/audit.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

// Levels of detail: how far they are off, and what questions make of them.  // A13 A14 A15
namespace collided::engine {
namespace {

struct LevelSurface {
  TriangleMesh mesh;
  Bvh tree = Bvh::build(mesh);
  std::vector<std::uint32_t> part_of = std::vector<std::uint32_t>(mesh.triangles.size(), 0);
  PartedSurface parted() const { return {mesh, tree, part_of}; }
  double distance_m(const Vec3& p) const {
    double nearest = INFINITY;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
      nearest = std::min(nearest, closest(p, mesh.triangle(i)).distance_m);
    return nearest;
  }
};

Vec3 random_point(const TriangleMesh& mesh, std::mt19937_64& random) {
  const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
  std::uniform_real_distribution<double> unit(0, 1);
  double u = unit(random), v = unit(random);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return t.a + u * (t.b - t.a) + v * (t.c - t.a);
}

/// The largest distance that samples of one find to the other, both ways.
double sampled_m(const LevelSurface& a, const LevelSurface& b, std::mt19937_64& random, int count) {
  double farthest = 0;
  for (int i = 0; i < count; ++i) {
    farthest =
        std::max({farthest, b.distance_m(random_point(a.mesh, random)), a.distance_m(random_point(b.mesh, random))});
  }
  return farthest;
}

TEST(WorldSurfaceDistance, IsAtLeastWhatSamplesFindAndNotMuchMore) {
  std::mt19937_64 random = oracle::seeded(131);
  for (const TriangleMesh& mesh : {scenes::icosphere(3, 1), scenes::terrain(16, 10, 6)}) {
    SimplifyReport report;
    const CollapseOrder order = simplify(mesh, {}, report);
    const LevelSurface full{mesh};
    for (const std::size_t divisor : {2, 6, 20}) {
      const LevelSurface level{compact_mesh(mesh, level_with(mesh, order, mesh.triangles.size() / divisor))};
      const double bound_m = surface_distance(full.parted(), level.parted());
      const double found_m = sampled_m(full, level, random, 300);
      EXPECT_GE(bound_m, found_m) << divisor;
      EXPECT_LE(bound_m, 2 * found_m) << divisor;
      EXPECT_GE(surface_distance(level.parted(), full.parted()), found_m) << divisor;
    }
  }
}

TEST(WorldSurfaceDistance, KnownByHand) {
  // A square and the same square with a tent of height 1/4 over it: a quarter, whichever way it is asked.
  const LevelSurface flat{{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{0, 1, 2}, {0, 2, 3}}}};
  const LevelSurface tent{
      {{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 0.25}}, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}}};
  EXPECT_NEAR(surface_distance(flat.parted(), tent.parted()), 0.25, 0.01);
  EXPECT_GE(surface_distance(flat.parted(), tent.parted()), 0.25);
  // A triangle less leaves a hole, whose middle is as far from the rest as its inscribed circle is wide.
  const LevelSurface half{{flat.mesh.vertices, {{0, 1, 2}}}};
  EXPECT_NEAR(surface_distance(flat.parted(), half.parted()), std::sqrt(8.0), 0.1) << "the corner over the diagonal";
  EXPECT_GE(surface_distance(flat.parted(), half.parted()), std::sqrt(8.0));
  EXPECT_LE(surface_distance(flat.parted(), flat.parted()), 1e-5);
}

// A fold under the surface, a sheet twice in the same place, a border: what looks covered and is not must not count.
TEST(WorldSurfaceDistance, SheetsThatFoldOrEndAreNotTakenForACover) {
  std::mt19937_64 random = oracle::seeded(132);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const auto soup = [&](int count) {
      TriangleMesh mesh;
      for (int k = 0; k < 6; ++k)
        mesh.vertices.emplace_back(coordinate(random), coordinate(random), 0.2 * coordinate(random));
      for (int k = 0; k < count; ++k) {
        const auto a = static_cast<std::uint32_t>(random() % 6);
        const auto b = static_cast<std::uint32_t>((a + 1 + random() % 5) % 6);
        auto c = static_cast<std::uint32_t>(random() % 6);
        while (c == a || c == b) c = (c + 1) % 6;
        mesh.triangles.push_back({a, b, c});
      }
      return mesh;
    };
    const LevelSurface a{soup(4)};
    const LevelSurface b{soup(8)};
    const double bound_m = surface_distance(a.parted(), b.parted(), {.pieces_at_most = 2000});
    EXPECT_GE(bound_m, sampled_m(a, b, random, 200)) << i;
  }
}

TEST(WorldSurfaceDistance, APartIsMeasuredToItselfAlone) {
  TriangleMesh two = scenes::box({1, 1, 1});
  scenes::append(two, scenes::box({1, 1, 1}, {2.5, 0, 0}));
  LevelSurface both{two};
  std::fill(both.part_of.begin() + 12, both.part_of.end(), 1u);
  LevelSurface swapped{two};
  std::fill(swapped.part_of.begin(), swapped.part_of.begin() + 12, 1u);
  EXPECT_GE(surface_distance(both.parted(), swapped.parted()), 2.5);
  EXPECT_LE(surface_distance(both.parted(), both.parted()), 1e-5);
  LevelSurface one{scenes::box({1, 1, 1})};
  EXPECT_EQ(surface_distance(both.parted(), one.parted()), INFINITY) << "part 1 is not there at all";
}

/// A world of terrain in two parts, some spheres, with levels.
struct LevelledWorld {
  World world{WorldOptions{}};
  std::size_t level_count = 0;
  double finest_m = 0;
  double coarsest_m = 0;

  explicit LevelledWorld(bool with_levels) {
    Scene scene;
    scene.name = "hills";
    scene.mesh = scenes::terrain(48, 20, 9);
    const auto half = static_cast<std::uint32_t>(scene.mesh.triangles.size() / 2);
    scene.parts = {{"hills/south", 0, half}, {"hills/north", half, half}};
    SimplifyReport report;
    const std::vector<std::uint32_t> ends = ends_of_parts(scene.parts);
    if (with_levels) scene.collapses = simplify(scene.mesh, {.part_ends = ends}, report);
    auto indexed = World::index_scene(scene, {.progress = {}, .cancelled = {}});
    level_count = indexed.geometry->levels.size();
    if (level_count > 0) {
      finest_m = indexed.geometry->levels.front()->off_by_m;
      coarsest_m = indexed.geometry->levels.back()->off_by_m;
    }
    world.add_scene(indexed);
    for (int i = 0; i < 5; ++i) {
      ObjectDefinition ball;
      ball.name = "ball" + std::to_string(i);
      ball.shape.primitives = {Sphere{Vec3::Zero(), 0.3}};
      ball.pose.position = {4.0 * i - 8, 1, 3};
      world.define(ball);
    }
    world.step(0, 1, {});
  }
};

Answers asked_near(const LevelledWorld& levelled, const std::vector<double>& numbers, std::uint32_t nearest,
                   double error_m) {
  Answers answers;
  QueryScratch scratch;
  answer(*levelled.world.newest(),
         {.kind = QuestionKind::near, .max_hits = nearest, .error_m = error_m, .numbers = numbers}, answers, scratch);
  return answers;
}

/// COLLIDED_LEVELS asks for another number.
int question_count() {
  const char* asked = std::getenv("COLLIDED_LEVELS");
  return asked != nullptr ? std::atoi(asked) : 3000;
}

// Many distances: none is off by more than its bound, the bound is no wider than asked, yes and no are those of the scene.
TEST(WorldLevels, DistancesHoldTheirBoundAndReachIsExact) {
  const LevelledWorld plain(false);
  const LevelledWorld levelled(true);
  ASSERT_EQ(plain.level_count, 0u);
  ASSERT_GE(levelled.level_count, 2u);
  std::mt19937_64 random = oracle::seeded(151);
  std::uniform_real_distribution<double> coordinate(-11, 11);
  std::uint64_t nodes_plain = 0;
  std::uint64_t nodes_levelled = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<double> numbers;
    for (int i = 0; i < question_count() / 20; ++i) {
      const double reach_m = round % 2 == 0 ? INFINITY : std::abs(coordinate(random)) / 3;
      numbers.insert(numbers.end(), {coordinate(random), coordinate(random), coordinate(random) / 3, reach_m});
    }
    const std::uint32_t nearest = round % 4 < 2 ? 1 : 7;
    const double error_m = 4 * (round % 3 == 0 ? levelled.finest_m : levelled.coarsest_m) * (1 + 1e-9);
    const Answers exact = asked_near(plain, numbers, nearest, 0);
    const Answers loose = asked_near(plain, numbers, nearest, error_m);
    const Answers simpler = asked_near(levelled, numbers, nearest, error_m);
    ASSERT_EQ(simpler.answers, exact.answers) << round;
    ASSERT_EQ(simpler.hit_counts, exact.hit_counts) << round;
    for (std::size_t i = 0; i < simpler.hits.size(); ++i) {
      EXPECT_LE(simpler.hits[i].error_m, error_m * (1 + 1e-9));
      EXPECT_LE(std::abs(simpler.hits[i].distance_m - exact.hits[i].distance_m),
                simpler.hits[i].error_m + exact.hits[i].error_m)
          << i;
    }
    for (const std::uint32_t n : loose.nodes) nodes_plain += n;
    for (const std::uint32_t n : simpler.nodes) nodes_levelled += n;
    if (HasFailure()) FAIL() << "round " << round;
  }
  EXPECT_LT(nodes_levelled, nodes_plain) << "levels must save work";
  std::printf("nodes of a question: %.1f without levels, %.1f with\n",
              static_cast<double>(nodes_plain) / question_count(),
              static_cast<double>(nodes_levelled) / question_count());
}

TEST(WorldLevels, AnswersAskedExactlyComeFromTheScene) {
  const LevelledWorld plain(false);
  const LevelledWorld levelled(true);
  std::mt19937_64 random = oracle::seeded(152);
  std::uniform_real_distribution<double> coordinate(-11, 11);
  std::vector<double> numbers;
  for (int i = 0; i < 100; ++i)
    numbers.insert(numbers.end(), {coordinate(random), coordinate(random), coordinate(random), INFINITY});
  for (const double error_m : {0.0, levelled.finest_m}) {
    const Answers a = asked_near(plain, numbers, 3, error_m);
    const Answers b = asked_near(levelled, numbers, 3, error_m);
    ASSERT_EQ(a.hits.size(), b.hits.size());
    for (std::size_t i = 0; i < a.hits.size(); ++i) {
      EXPECT_EQ(a.hits[i].distance_m, b.hits[i].distance_m);
      EXPECT_EQ(a.hits[i].triangle, b.hits[i].triangle);
    }
  }
}

TEST(WorldLevels, TheAuditAgrees) {
  const LevelledWorld levelled(true);
  std::mt19937_64 random = oracle::seeded(153);
  std::uniform_real_distribution<double> coordinate(-11, 11);
  for (int i = 0; i < 30; ++i) {
    const std::vector<double> numbers{coordinate(random), coordinate(random), coordinate(random),
                                      i % 2 == 0 ? INFINITY : 2.0};
    const Questions question{
        .kind = QuestionKind::near, .max_hits = 2, .error_m = 4.1 * levelled.coarsest_m, .numbers = numbers};
    Answers answers;
    QueryScratch scratch;
    answer(*levelled.world.newest(), question, answers, scratch);
    EXPECT_EQ(audit(*levelled.world.newest(), question, answers), "");
  }
}

}  // namespace
}  // namespace collided::engine
