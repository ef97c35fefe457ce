#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

namespace fs = std::filesystem;

/// The folder of real data: $COLLIDED_DATA, else beside the repository; empty where there is none.
fs::path data_folder() {
  const char* given = std::getenv("COLLIDED_DATA");
  const fs::path folder =
      given != nullptr ? fs::path(given) : fs::path(__FILE__).parent_path() / "../../../../shared/data";
  return fs::exists(folder) ? folder : fs::path();
}

std::vector<std::map<std::string, std::string>> read_table(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> heads;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::map<std::string, std::string> row;
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column) {
      if (rows.empty() && heads.size() == column && row.empty()) {
        heads.push_back(cell);
      } else {
        row[heads.at(column)] = cell;
      }
    }
    if (!row.empty()) { rows.push_back(row); }
  }
  return rows;
}

std::string unpacked(const fs::path& path) {
  gzFile file = ::gzopen(path.c_str(), "rb");
  EXPECT_NE(file, nullptr);
  std::string text;
  std::vector<char> piece(1 << 20);
  for (int got = 0; (got = ::gzread(file, piece.data(), static_cast<unsigned>(piece.size()))) > 0;) {
    text.append(piece.data(), static_cast<std::size_t>(got));
  }
  ::gzclose(file);
  return text;
}

class IntakeRealMeshes : public testing::Test {
 protected:
  void SetUp() override {
    data_ = data_folder();
    if (data_.empty()) { GTEST_SKIP() << "no real data; COLLIDED_DATA may name the folder"; }
  }
  fs::path data_;
};

// Counted elsewhere, after joining vertices within 1e-7; in the OBJ files those are exactly the equal ones.
TEST_F(IntakeRealMeshes, CountsOfDefectsAreThoseOfTheIndex) {
  int compared = 0;
  for (auto& row : read_table(data_ / "meshes/index.csv")) {
    const std::string ending = fs::path(row["file"]).extension();
    if (ending != ".obj" && ending != ".stl") { continue; }
    LoadReport report;
    const Scene scene = load_scene((data_ / "meshes" / row["file"]).string(), {}, report);
    EXPECT_EQ(scene.mesh.triangles.size(), std::stoull(row["triangles"])) << row["file"];
    ++compared;
    if (ending == ".stl") { continue; }
    const MeshHealth health = examine(scene.mesh);
    EXPECT_EQ(health.vertex_count - health.equal_vertex_count, std::stoull(row["vertices_welded"])) << row["file"];
    EXPECT_EQ(health.zero_area_count, std::stoull(row["degenerate"])) << row["file"];
    EXPECT_EQ(health.duplicate_count, std::stoull(row["duplicate"])) << row["file"];
    EXPECT_EQ(health.boundary_edge_count, std::stoull(row["boundary_edges"])) << row["file"];
    EXPECT_EQ(health.nonmanifold_edge_count, std::stoull(row["nonmanifold_edges"])) << row["file"];
    EXPECT_EQ(health.component_count, std::stoull(row["components"])) << row["file"];
  }
  EXPECT_EQ(compared, 6);
}

TEST_F(IntakeRealMeshes, TheWarehouseHasAPartForEachPlacedModel) {
  LoadReport report;
  const Scene scene = load_scene((data_ / "warehouse_aws/warehouse.obj").string(), {}, report);
  EXPECT_EQ(scene.mesh.triangles.size(), 1600u);
  EXPECT_EQ(scene.parts.size(), read_table(data_ / "warehouse_aws/instances.csv").size());
  EXPECT_EQ(scene.parts[0].name, "warehouse/aws_robomaker_warehouse_ShelfF_01_001");
}

TEST_F(IntakeRealMeshes, DelftHasTheDefectsItsReadmeTells) {
  const MeshHealth health = examine(test::load("delft.obj", unpacked(data_ / "city_delft/delft.obj.gz")).scene.mesh);
  // Four in the decimals of the file; read as doubles, two of them have an area of 7e-17 m^2 (counted in rationals).
  EXPECT_EQ(health.zero_area_count, 2u);
  EXPECT_EQ(health.duplicate_count, 10u);
  EXPECT_EQ(health.nonmanifold_edge_count, 789u);
}

/// The meshes as they were counted: vertices that are equal to seven decimals are one.
TriangleMesh welded(TriangleMesh mesh) {
  std::map<std::array<double, 3>, std::uint32_t> places;
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) {
      const Vec3& v = mesh.vertices[corner];
      const std::array<double, 3> place{std::nearbyint(v[0] * 1e7), std::nearbyint(v[1] * 1e7),
                                        std::nearbyint(v[2] * 1e7)};
      corner = places.try_emplace(place, corner).first->second;
    }
  }
  return mesh;
}

// All seven, the two that come through welding as well.
TEST_F(IntakeRealMeshes, TheSevenDefectiveMeshesHaveTheCountsOfTheIndexWeldedAsThere) {
#ifdef COLLIDED_IMPORT_BUILT
  ::setenv("COLLIDED_IMPORT", COLLIDED_IMPORT_BUILT, 0);
#endif
  int compared = 0;
  for (auto& row : read_table(data_ / "meshes/index.csv")) {
    LoadReport report;
    Scene scene;
    try {
      scene = load_scene((data_ / "meshes" / row["file"]).string(), {}, report);
    } catch (const LoadError& error) {
      if (std::string(error.what()).find("needs the converter") != std::string::npos) continue;
      throw;
    }
    const MeshHealth health = examine(welded(std::move(scene.mesh)));
    ++compared;
    EXPECT_EQ(health.triangle_count, std::stoull(row["triangles"])) << row["file"];
    EXPECT_EQ(health.zero_area_count, std::stoull(row["degenerate"])) << row["file"];
    EXPECT_EQ(health.duplicate_count, std::stoull(row["duplicate"])) << row["file"];
    EXPECT_EQ(health.boundary_edge_count, std::stoull(row["boundary_edges"])) << row["file"];
    EXPECT_EQ(health.nonmanifold_edge_count, std::stoull(row["nonmanifold_edges"])) << row["file"];
    EXPECT_EQ(health.component_count, std::stoull(row["components"])) << row["file"];
  }
  EXPECT_GE(compared, 6);
}

// Delft as CityJSON: in its own system, 4.5e5 m from the origin, the rays from above hit the roofs that they are said to.
TEST_F(IntakeRealMeshes, RaysOntoTheRoofsOfDelftHitThem) {
  const Scene scene = test::load("delft.json", unpacked(data_ / "city_delft/original/delft.json.gz")).scene;
  EXPECT_EQ(scene.mesh.triangles.size(), 36271u);
  EXPECT_EQ(scene.parts.size(), 570u);
  const auto offset = read_table(data_ / "city_delft/offset.csv").at(0);
  int rays = 0;
  for (auto& row : read_table(data_ / "city_delft/expected_down_rays.csv")) {
    const Vec3 from(std::stod(row["x"]) + std::stod(offset.at("dx")), std::stod(row["y"]) + std::stod(offset.at("dy")),
                    100);
    double nearest = 1e9;
    std::uint32_t met = 0;
    for (std::uint32_t i = 0; i < scene.mesh.triangles.size(); ++i) {
      RayHit hit;
      if (!cast_ray(Ray{from, {0, 0, -1}}, scene.mesh.triangle(i), hit).yes() || hit.distance_m >= nearest) continue;
      nearest = hit.distance_m;
      met = i;
    }
    const auto part = std::find_if(scene.parts.begin(), scene.parts.end(),
                                   [&](const Part& p) { return met < p.first_triangle + p.triangle_count; });
    EXPECT_EQ(part->name, "delft/" + row["hit_object"]);
    EXPECT_NEAR(100 - nearest, std::stod(row["hit_z"]), 1e-6);
    ++rays;
  }
  EXPECT_EQ(rays, 160);
}

TEST_F(IntakeRealMeshes, TheRobotsOwnFileGivesTheLinksThatItsLogWasRecordedWith) {
  const fs::path folder = fs::path(testing::TempDir()) / ("panda_" + std::to_string(::getpid()));
  fs::create_directories(folder / "meshes");
  fs::copy(data_ / "panda_lab/meshes", folder / "meshes/collision", fs::copy_options::recursive);
  fs::copy_file(data_ / "panda_lab/panda.urdf", folder / "panda.urdf");
  LoadReport report;
  const Scene scene = load_scene((folder / "panda.urdf").string(), {}, report);
  fs::remove_all(folder);
  EXPECT_EQ(scene.objects.size(), 11u);
  const auto hand = std::find_if(scene.objects.begin(), scene.objects.end(),
                                 [](const SceneObject& o) { return o.name == "panda/panda_hand"; });
  ASSERT_NE(hand, scene.objects.end());
  // The arm at zero reaches 0.088 m forward and stands 0.926 m high at its flange.
  EXPECT_NEAR((hand->pose.position - Vec3(0.088, 0, 0.926)).norm(), 0, 1e-9);
}

TEST_F(IntakeRealMeshes, TheOfficesWallsAndTheLabsTablesAreRead) {
  EXPECT_EQ(test::load("walls.csv", unpacked(data_ / "building_fr079/walls.csv.gz")).scene.objects.size(), 3018u);
  LoadReport report;
  EXPECT_EQ(load_scene((data_ / "panda_lab/env.csv").string(), {}, report).objects.size(), 3u);
}

/// Loads every file below a folder whose ending is in our formats; what is refused must be so with a reason.
void load_all(const fs::path& folder, int& loaded, int& refused) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    std::string ending = entry.path().extension();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](char c) { return static_cast<char>(std::tolower(c)); });
    const std::set<std::string> ours{".obj", ".stl", ".ply", ".off", ".gltf", ".glb"};
    if (!entry.is_regular_file() || !ours.contains(ending)) continue;
    LoadReport report;
    try {
      const Scene scene = load_scene(entry.path().string(), {}, report);
      EXPECT_GT(scene.mesh.triangles.size(), 0u) << entry.path();
      ++loaded;
    } catch (const LoadError& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.ends_with(". Nothing was loaded.") && what.size() > 40) << what;
      ++refused;
    }
  }
}

TEST(IntakeSampleModels, EveryFileOfAssimpsInOurFormatsLoadsOrSaysWhyNot) {
  const fs::path folder = "/usr/share/assimp/models";
  if (!fs::exists(folder)) GTEST_SKIP() << "needs the package assimp-testmodels";
  int loaded = 0;
  int refused = 0;
  load_all(folder, loaded, refused);
  std::printf("%d loaded, %d refused with a reason\n", loaded, refused);
  EXPECT_GE(loaded, 60);
  LoadReport report;
  const Scene engine =
      load_scene((folder / "glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb").string(), {}, report);
  EXPECT_EQ(engine.mesh.triangles.size(), 121496u);
  EXPECT_EQ(engine.parts.size(), 67u);
}

TEST(IntakeSampleModels, TheMeshesOfCgalsDemosLoadOrSayWhyNot) {
  const fs::path archive = "/usr/share/doc/libcgal-dev/data.tar.gz";
  if (!fs::exists(archive)) GTEST_SKIP() << "needs the package libcgal-demo";
  const fs::path folder = fs::path(::testing::TempDir()) / ("collided_cgal_" + std::to_string(getpid()));
  fs::create_directories(folder);
  ASSERT_EQ(std::system(("tar -xzf " + archive.string() + " -C " + folder.string() + " data/meshes").c_str()), 0);
  int loaded = 0;
  int refused = 0;
  load_all(folder, loaded, refused);
  fs::remove_all(folder);
  std::printf("%d loaded, %d refused with a reason\n", loaded, refused);
  EXPECT_GE(loaded, 100);
}

TEST(IntakeOctomapSample, TheCorridorOfBuilding79IsRead) {
  const fs::path path = "/usr/share/doc/liboctomap-dev/examples/data/geb079.bt";
  if (!fs::exists(path)) GTEST_SKIP() << "needs the package liboctomap-dev";
  LoadReport report;
  const Scene scene = load_scene(path.string(), {}, report);
  EXPECT_TRUE(report.warnings.empty());  // the tree ends where the file does
  EXPECT_GT(scene.objects.at(0).shape.primitives.size(), 1000u);
}

TEST(IntakeBunny, IsOneClosedSurface) {
  const std::string path = "/usr/share/glmark2/models/bunny.obj";
  if (!fs::exists(path)) { GTEST_SKIP() << "needs the package glmark2-data"; }
  LoadReport report;
  const Scene scene = load_scene(path, {}, report);
  EXPECT_EQ(scene.mesh.triangles.size(), 69666u);
  EXPECT_EQ(scene.parts.at(0).name, "bunny");
  const MeshHealth health = examine(scene.mesh);
  EXPECT_TRUE(health.is_closed && health.is_consistently_oriented);
  EXPECT_EQ(health.component_count, 1u);
}

}  // namespace
}  // namespace collided::engine
