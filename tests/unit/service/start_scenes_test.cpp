// The scenes of the command line are read as the options say.
#include "server/service/start_scenes.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "server/service/commands/scene_loading.hpp"

namespace collided::engine::service {
namespace {

class ServiceStartScenes : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// What it prints, once they are in the world.
  std::string load(const Options& options) {
    testing::internal::CaptureStdout();
    load_start_scenes(options, world_, 1);
    return testing::internal::GetCapturedStdout();
  }
  World world_{WorldOptions{}};
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("collided_start_scenes_" + std::to_string(getpid()));
};

TEST_F(ServiceStartScenes, TheirUnitAndWhatPointsUpAreThoseOfTheOptions) {
  Options options;
  options.scenes = {file("plate.obj", "v 0 0 0\nv 1000 0 0\nv 1000 2000 0\nv 0 2000 500\nf 1 2 3\nf 1 3 4\n")};
  options.unit_m = 1e-3;
  options.up = 'y';
  const std::string said = load(options);
  EXPECT_NE(said.find("plate: 2 triangles"), std::string::npos) << said;
  const SnapshotRing::Lease state = world_.newest();
  ASSERT_EQ(state->scenes.size(), 1U);
  // (x, y, z) -> (x, -z, y), and a thousandth of it.
  Aabb bounds;
  for (const Vec3& vertex : state->scenes[0]->mesh.vertices) bounds.extend(vertex);
  EXPECT_LE((bounds.low - Vec3(0, -0.5, 0)).norm(), 1e-9);
  EXPECT_LE((bounds.high - Vec3(1, 0, 2)).norm(), 1e-9);
}

TEST_F(ServiceStartScenes, AFileThatLooksLikeMillimetresIsWarnedOf) {
  const std::string plate = file("plate.obj", "v 0 0 0\nv 2000 0 0\nv 2000 2000 0\nf 1 2 3\n");
  const std::string doubt = "2000 m across: if the file is in millimetres, it is 2 m (--unit mm)";
  EXPECT_EQ(load_and_index(plate, {}).report.warnings, std::vector<std::string>{doubt});
  EXPECT_TRUE(load_and_index(plate, {.unit_m = 1e-3}).report.warnings.empty());
}

TEST_F(ServiceStartScenes, WithoutOneTheEmbeddedSceneIsThere) {
  load({});
  ASSERT_EQ(world_.newest()->scenes.size(), 1U);
  EXPECT_EQ(world_.newest()->scenes[0]->name, "warehouse");
}

TEST_F(ServiceStartScenes, TheSecondsOfALoadAreNoMoreThanPassedAroundItAndNotNone) {
  const auto before = std::chrono::steady_clock::now();
  const LoadedScene loaded = load_and_index(kEmbeddedPath, {});
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - before;
  EXPECT_GT(loaded.seconds, 0);
  EXPECT_LE(loaded.seconds, passed.count());
}

TEST_F(ServiceStartScenes, AllThatAreNamedAreThereInOrder) {
  Options options;
  options.scenes = {file("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                    file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")};
  load(options);
  const SnapshotRing::Lease state = world_.newest();
  ASSERT_EQ(state->scenes.size(), 2U);
  EXPECT_EQ(state->scenes[0]->name, "b");
  EXPECT_EQ(state->scenes[1]->name, "a");
}

}  // namespace
}  // namespace collided::engine::service
