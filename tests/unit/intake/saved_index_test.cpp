#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/intake/scene_file/scene_file.hpp"
#include "server/intake/scene_file/scene_index.hpp"
#include "server/world/world.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

SavedIndex index_of(const TriangleMesh& mesh) {
  const auto bytes = std::make_shared<const std::vector<std::byte>>(Bvh::build(mesh).saved(mesh));
  return {*bytes, bytes};
}

class IntakeSavedIndex : public testing::Test {
 protected:
  void SetUp() override {
    path_ = (std::filesystem::temp_directory_path() /
             ("index_" + std::to_string(::getpid()) + "_" +
              testing::UnitTest::GetInstance()->current_test_info()->name() + ".cscene"))
                .string();
    scene_ = {.name = "hill", .mesh = scenes::terrain(20, 10, 3), .parts = {{"hill", 0, 800, {}}}};
    scene_.index = index_of(scene_.mesh);
    for (const char* name : {"ball", "crate", "bare"}) scene_.objects.push_back({.name = name});
    scene_.objects[0].shape.mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(2, 1));
    scene_.objects[0].index = index_of(*scene_.objects[0].shape.mesh);
    scene_.objects[1].shape.primitives.push_back(Sphere{{0, 0, 0}, 1});
    scene_.objects[2].shape.mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(1, 1));
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::string saved() const {
    save_scene(path_, scene_);
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  std::shared_ptr<StaticScene> indexed(const LoadOptions& options = {}) {
    report_ = {};
    return World::index_scene(load_scene(path_, options, report_), {.threads = 1, .progress = {}, .cancelled = {}})
        .geometry;
  }

  std::string path_;
  Scene scene_;
  LoadReport report_;
};

TEST_F(IntakeSavedIndex, IsUsedWhereItIsAndBuiltWhereItIsNot) {
  saved();
  const auto scene = indexed();
  EXPECT_TRUE(scene->tree.report().is_loaded);
  ASSERT_EQ(scene->object_meshes.size(), 3u);
  EXPECT_TRUE(scene->object_meshes[0]->tree.report().is_loaded);
  EXPECT_EQ(scene->object_meshes[1], nullptr);
  EXPECT_FALSE(scene->object_meshes[2]->tree.report().is_loaded);
  EXPECT_TRUE(scene->warnings.empty());
}

TEST_F(IntakeSavedIndex, OutlivesTheScene) {
  const std::string bytes = saved();
  auto scene = std::make_optional(test::load("a.cscene", bytes).scene);
  const auto kept = World::index_scene(std::move(*scene), {.threads = 1, .progress = {}, .cancelled = {}});
  scene.reset();
  ASSERT_TRUE(kept.geometry->tree.report().is_loaded);
  WalkCost cost;
  std::uint32_t count = 0;
  const auto take = [&](std::uint32_t) { return ++count > 0; };
  kept.geometry->tree.walk_box(kept.geometry->tree.bounds(), take, cost);
  EXPECT_EQ(count, 800u);
}

TEST_F(IntakeSavedIndex, ProgramsThatKnowNoneReadTheTablesBeforeIt) {
  const std::string with = saved();
  forget_indexes(scene_);
  const std::string without = saved();
  EXPECT_EQ(with.substr(0, without.size()), without);
  EXPECT_EQ(table_bytes(with), without.size());
  EXPECT_EQ(table_bytes(without), without.size());
  const auto scene = indexed();
  EXPECT_FALSE(scene->tree.report().is_loaded);
  EXPECT_TRUE(scene->warnings.empty());
}

TEST_F(IntakeSavedIndex, LiesOnMultiplesOf64) {
  const std::string bytes = saved();
  for (std::size_t at = bytes.find("CBSPTREE"); at != std::string::npos; at = bytes.find("CBSPTREE", at + 1)) {
    EXPECT_EQ(at % 64, 0u);
  }
}

TEST_F(IntakeSavedIndex, OneThatDoesNotFitIsBuiltAnewAndAWarningTellsSo) {
  std::string bytes = saved();
  const std::size_t at = bytes.find("CBSPTREE");
  bytes[at + 300] = static_cast<char>(bytes[at + 300] ^ 4);
  write(bytes);
  const auto scene = indexed();
  EXPECT_FALSE(scene->tree.report().is_loaded);
  ASSERT_EQ(scene->warnings.size(), 1u);
  EXPECT_EQ(scene->warnings[0],
            "the saved index of the scene's mesh is not used, its checksum is not that of its bytes; it is built anew");
  EXPECT_TRUE(scene->object_meshes[0]->tree.report().is_loaded);
}

TEST_F(IntakeSavedIndex, ADamagedListGivesNoIndexAndAWarning) {
  std::string bytes = saved();
  bytes[bytes.size() - 64 - 48] = 9;  // the first entry's mesh
  write(bytes);
  EXPECT_FALSE(indexed()->tree.report().is_loaded);
  ASSERT_EQ(report_.warnings.size(), 1u);
  EXPECT_EQ(report_.warnings[0], "the list of saved indexes is damaged; they are built anew");
}

TEST_F(IntakeSavedIndex, OtherUnitsAndAxesAreAnotherMesh) {
  saved();
  for (const LoadOptions& options : {LoadOptions{.unit_m = 2}, LoadOptions{.up = 'y'}}) {
    const auto scene = indexed(options);
    EXPECT_FALSE(scene->tree.report().is_loaded);
    EXPECT_TRUE(scene->warnings.empty());
  }
}

TEST_F(IntakeSavedIndex, ReplacingTheFileLeavesTheMappedOneWhole) {
  saved();
  const auto first = indexed();
  scene_.mesh = scenes::terrain(20, 10, 4);
  scene_.index = index_of(scene_.mesh);
  saved();
  const auto second = indexed();
  EXPECT_TRUE(first->tree.report().is_loaded && second->tree.report().is_loaded);
  std::filesystem::remove(path_);
  WalkCost cost;
  std::uint32_t count = 0;
  const auto take = [&](std::uint32_t) { return ++count > 0; };
  first->tree.walk_box(first->tree.bounds(), take, cost);
  EXPECT_EQ(count, 800u);
}

}  // namespace
}  // namespace collided::engine
