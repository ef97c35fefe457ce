#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "server/intake/mesh_health.hpp"
#include "tests/unit/intake_loading.hpp"

namespace collided {
namespace {

namespace fs = std::filesystem;

/// The folder of real data: $COLLIDED_DATA, else beside the repository; empty where there is none.
fs::path data_folder() {
  const char* given = std::getenv("COLLIDED_DATA");
  const fs::path folder =
      given != nullptr ? fs::path(given) : fs::path(__FILE__).parent_path() / "../../../shared/data";
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
    if (!row.empty()) {
      rows.push_back(row);
    }
  }
  return rows;
}

class IntakeRealMeshes : public testing::Test {
 protected:
  void SetUp() override {
    data_ = data_folder();
    if (data_.empty()) {
      GTEST_SKIP() << "no real data; COLLIDED_DATA may name the folder";
    }
  }
  fs::path data_;
};

// Counted elsewhere, after joining vertices within 1e-7; in the OBJ files those are exactly the equal ones.
TEST_F(IntakeRealMeshes, CountsOfDefectsAreThoseOfTheIndex) {
  int compared = 0;
  for (auto& row : read_table(data_ / "meshes/index.csv")) {
    const std::string ending = fs::path(row["file"]).extension();
    if (ending != ".obj" && ending != ".stl") {
      continue;
    }
    LoadReport report;
    const Scene scene = load_scene((data_ / "meshes" / row["file"]).string(), {}, report);
    EXPECT_EQ(scene.mesh.triangles.size(), std::stoull(row["triangles"])) << row["file"];
    ++compared;
    if (ending == ".stl") {
      continue;
    }
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
  gzFile file = ::gzopen((data_ / "city_delft/delft.obj.gz").c_str(), "rb");
  ASSERT_NE(file, nullptr);
  std::string text;
  std::vector<char> piece(1 << 20);
  for (int got = 0; (got = ::gzread(file, piece.data(), static_cast<unsigned>(piece.size()))) > 0;) {
    text.append(piece.data(), static_cast<std::size_t>(got));
  }
  ::gzclose(file);
  const MeshHealth health = examine(test::load("delft.obj", text).scene.mesh);
  // Four in the decimals of the file; read as doubles, two of them have an area of 7e-17 m^2 (counted in rationals).
  EXPECT_EQ(health.zero_area_count, 2u);
  EXPECT_EQ(health.duplicate_count, 10u);
  EXPECT_EQ(health.nonmanifold_edge_count, 789u);
}

TEST(IntakeBunny, IsOneClosedSurface) {
  const std::string path = "/usr/share/glmark2/models/bunny.obj";
  if (!fs::exists(path)) {
    GTEST_SKIP() << "needs the package glmark2-data";
  }
  LoadReport report;
  const Scene scene = load_scene(path, {}, report);
  EXPECT_EQ(scene.mesh.triangles.size(), 69666u);
  EXPECT_EQ(scene.parts.at(0).name, "bunny");
  const MeshHealth health = examine(scene.mesh);
  EXPECT_TRUE(health.is_closed && health.is_consistently_oriented);
  EXPECT_EQ(health.component_count, 1u);
}

}  // namespace
}  // namespace collided
