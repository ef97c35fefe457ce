#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "server/world/audit/menu.hpp"
#include "server/world/audit/random_questions.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/mixed_world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

// The price list is judged by rationals over every part: right answers are right, and an index that has lost triangles
// is found out by every kind of question that walks it.
namespace collided::engine {
namespace {

/// An index over the mesh that never offers every tenth triangle where it lies: it takes them all for one corner.
Bvh index_with_losses(TriangleMesh mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 10) mesh.triangles[i] = {0, 0, 0};
  return Bvh::build(mesh);
}

/// Hills as a static scene, and eight clouds of triangles above and in them: of these no two share a corner, by which a
/// lost one's neighbours would stand in for it.
class WorldMenu : public testing::Test {
 protected:
  static constexpr int kClouds = 8;

  void fill(bool with_losses) {
    Scene scene{.name = "hills", .mesh = scenes::terrain(24, 10, 6)};
    scene.parts = {{"hills/all", 0, static_cast<std::uint32_t>(scene.mesh.triangles.size()), {}}};
    const TriangleMesh hills = scene.mesh;
    auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
    if (with_losses) indexed.geometry->tree = index_with_losses(hills);
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world_.add_scene(indexed)));
    for (int i = 0; i < kClouds; ++i) {
      const auto cloud =
          std::make_shared<const TriangleMesh>(scenes::scattered(300, 0.3, static_cast<std::uint64_t>(i)));
      const Pose pose{.position = Vec3(1.1 * i - 4, 0.3 * i - 1, 0.2 * i + 1), .rotation = Quat::Identity()};
      const ObjectId id = std::get<ObjectId>(world_.define(
          {.name = "cloud" + std::to_string(i), .scene = {}, .shape = {{}, cloud}, .pose = pose, .filter = {}}));
      if (with_losses) const_cast<IndexedMesh&>(*world_.info(id)->mesh).tree = index_with_losses(*cloud);
    }
    world_.step(1, 1, {});
  }
  /// By what was asked of, the row of the method that claims to be exact.
  std::map<std::string, MenuRow> exact_rows(std::uint32_t questions) {
    std::map<std::string, MenuRow> rows;
    for (const MenuRow& row : menu_of(*world_.newest(), {.questions = questions, .seed = 11})) {
      if (row.method == "exact on doubt") rows[row.asked_of] = row;
    }
    return rows;
  }

  World world_{WorldOptions{}};
};

TEST_F(WorldMenu, ASoundIndexHasNothingWrong) {
  fill(false);
  const auto rows = exact_rows(200);
  ASSERT_EQ(rows.size(), 6u);
  for (const auto& [kind, row] : rows) {
    EXPECT_EQ(row.asked, 200u) << kind;
    EXPECT_GT(row.judged, 0u) << kind;
    EXPECT_EQ(row.wrong, 0u) << kind;
    EXPECT_EQ(row.undecided, 0u) << kind;
    EXPECT_LE(row.worst_error_m, row.worst_bound_m) << kind;
  }
}

TEST_F(WorldMenu, AnIndexThatLostEveryTenthTriangleIsFoundByEveryKind) {
  fill(true);
  const auto rows = exact_rows(600);
  for (const char* kind : {"ray", "sphere", "box", "near", "sweep", "mesh pair"}) {
    ASSERT_TRUE(rows.contains(kind)) << kind;
    EXPECT_GT(rows.at(kind).wrong, 0u) << kind;
  }
  // Of rays that meet the hills, about one in ten.
  EXPECT_GT(rows.at("ray").wrong, rows.at("ray").judged / 50);
}

TEST_F(WorldMenu, EveryShapeIsJudgedAndNoneIsWrong) {
  std::mt19937_64 random = oracle::seeded(61);
  oracle::MixedWorld mixed(random);
  std::set<std::string> kinds;
  for (const MenuRow& row : menu_of(*(*mixed).newest(), {.questions = 60, .seed = 3})) {
    kinds.insert(row.asked_of);
    if (row.method == "boxes only") continue;
    EXPECT_EQ(row.wrong, 0u) << row.asked_of << " by " << row.method;
    EXPECT_LE(row.worst_error_m, row.worst_bound_m) << row.asked_of << " by " << row.method;
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"ray", "sphere", "box", "near", "sweep", "pair", "mesh pair"}));
}

// Its bounds have no end: questions at no place ended the server.
TEST_F(WorldMenu, AHalfSpaceWithoutEndIsAskedAboutNearItsPoint) {
  fill(false);
  const Pose pose{.position = {0, 0, -3}, .rotation = Quat(1, 0.1, 0.2, 0).normalized()};
  ObjectDefinition ground;
  ground.name = "ground";
  ground.pose = pose;
  ground.moving = false;
  ground.shape.primitives = {HalfSpace{Vec3::Zero(), Vec3::UnitZ()}};
  ASSERT_TRUE(std::holds_alternative<ObjectId>(world_.define(ground)));
  world_.step(2, 1, {});
  RandomQuestions random(*world_.newest(), 7);
  for (const double number : random.question(QuestionKind::sphere)) EXPECT_TRUE(std::isfinite(number)) << number;
  for (const auto& [kind, row] : exact_rows(60)) {
    EXPECT_GT(row.judged, 0u) << kind;
    EXPECT_EQ(row.wrong, 0u) << kind;
  }
}

TEST_F(WorldMenu, BoxesAloneAreOftenWrong) {
  fill(false);
  for (const MenuRow& row : menu_of(*world_.newest(), {.questions = 200, .seed = 11})) {
    if (row.method != "boxes only" || row.asked_of == "near") continue;
    EXPECT_GT(row.wrong, 0u) << row.asked_of;
  }
}

// However large the world, the rationals take no longer than allowed: what they had no time for is timed only, and said.
TEST_F(WorldMenu, WithoutTimeOneQuestionOfAKindIsJudged) {
  fill(false);
  for (const MenuRow& row : menu_of(*world_.newest(), {.questions = 20, .seed = 1, .judging_ns = 0})) {
    EXPECT_EQ(row.asked, 20u) << row.asked_of;
    EXPECT_EQ(row.judged, 1u) << row.asked_of;
  }
}

TEST_F(WorldMenu, AnEmptyWorldHasNoRows) { EXPECT_TRUE(menu_of(*world_.newest(), {}).empty()); }

}  // namespace
}  // namespace collided::engine
