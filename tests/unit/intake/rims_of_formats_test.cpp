#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>
#include <variant>

#include "server/intake/readers/vertex_buffer.hpp"
#include "tests/unit/intake/loading.hpp"

// Where what a format allows ends: the first value that is taken no more, and the last that is.
namespace collided::engine {
namespace {

using test::append;
using test::complaint;
using test::load;

TEST(IntakeBoxTable, QuotesAroundNothingLeaveNothingAndOneAloneIsText) {
  const auto with_cell = [](std::string_view cell) {
    return complaint("a.csv", fmt::format("x,y,z,sx,sy,sz\n1,2,3,4,{},6\n", cell));
  };
  EXPECT_EQ(with_cell("\"\""), "a.csv: line 2: '' in column 'sy' is no finite number. Nothing was loaded.");
  EXPECT_EQ(with_cell("\""), "a.csv: line 2: '\"' in column 'sy' is no finite number. Nothing was loaded.");
  EXPECT_EQ(with_cell("\"5\""), "loaded");
}

TEST(IntakeGltf, ANodeThatFlattensLeavesTheCornersInTheirOrder) {
  // (0, 0, 1), (1, 0, 1), (1, 1, 1) in single precision.
  const Scene scene =
      load(
          "a.gltf",
          R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"scale":[1,1,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
          R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
          R"("buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAIA/AACAPwAAAAAAAIA/AACAPwAAgD8AAIA/"}]})",
          {.up = 'z'})
          .scene;
  EXPECT_EQ(scene.mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(scene.mesh.triangles, (std::vector<TriangleCorners>{{0, 1, 2}}));
}

TEST(IntakeCityJson, APlaceIsNamedInEveryCharacterThatPrints) {
  EXPECT_EQ(
      complaint("a.json",
                R"({"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"vertices":[],)"
                R"("CityObjects":{"a ~!\u007f\u001f":{"geometry":[{"type":7}]}}})"),
      "a.json: /CityObjects/a ~!?\?/geometry/0/type is not text. Nothing was loaded.");
}

TEST(IntakePcd, APointWithoutEndIsNamedWithItsThreeCoordinatesInTheirOrder) {
  std::string bytes = "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nPOINTS 2\nDATA binary\n";
  for (const double number : {1.0, 2.0, 3.0, 4.5, 5.5, std::numeric_limits<double>::infinity()}) append(bytes, number);
  EXPECT_EQ(complaint("a.pcd", bytes), "a.pcd: point 1 is (4.5, 5.5, inf). Nothing was loaded.");
}

TEST(IntakePly, CornersThatAreNoListAreRefused) {
  const auto with = [](std::string_view property) {
    return complaint(
        "a.ply",
        fmt::format("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                    "element face 1\nproperty {}\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                    property));
  };
  EXPECT_EQ(with("list uchar int vertex_indices"), "loaded");
  EXPECT_EQ(with("int vertex_indices"), "a.ply: element 'face' has no list 'vertex_indices'. Nothing was loaded.");
  EXPECT_EQ(with("list uchar int corners"), "a.ply: element 'face' has no list 'vertex_indices'. Nothing was loaded.");
}

TEST(IntakeSurfaceFile, DegreesColumnsAndRowsBeginAtOne) {
  const auto with = [](std::string_view counts) {
    return complaint("a.surfaces", fmt::format("sheet patch {} 0 0 0 4 0 1 0 6 2 4 6 3 count 1\n", counts));
  };
  EXPECT_EQ(with("1 1 2 2"), "loaded");
  for (const char* counts : {"0 1 2 2", "1 0 2 2", "1 1 0 2", "1 1 2 0", "-1 1 2 2", "1 1 2.5 2", "1 1 2 10001"}) {
    EXPECT_EQ(with(counts),
              "a.surfaces: line 1: degrees, columns and rows of a patch are whole numbers from 1 to 10 000. Nothing "
              "was loaded.")
        << counts;
  }
}

// The package's folder stands beside the robot; its name is in no other path.
TEST(IntakeUrdf, AMeshIsFoundInTheFolderThatItsPackageNames) {
  const std::filesystem::path root =
      std::filesystem::path(testing::TempDir()) / fmt::format("robot_beside_package_{}", ::getpid());
  std::filesystem::create_directories(root / "arm_parts" / "meshes");
  std::ofstream(root / "arm_parts/meshes/t.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(root / "r.urdf") << R"(<robot name="r"><link name="l"><collision>
    <geometry><mesh filename="package://arm_parts/meshes/t.obj"/></geometry></collision></link></robot>)";
  LoadReport report;
  Scene scene;
  EXPECT_NO_THROW(scene = load_scene((root / "r.urdf").string(), {}, report));
  std::filesystem::remove_all(root);
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.objects[0].shape.mesh->triangles.size(), 1u);
}

TEST(IntakeVertexBuffer, ARadiusIsFiniteAndNotBelowZero) {
  const std::array<double, 3> point{1, 2, 3};
  const VertexBuffer buffer{BufferKind::points, true, sizeof point, 0, std::as_bytes(std::span(point)), 0, {}};
  for (const auto& [radius_m, text] : {std::pair{-1.0, "-1"},
                                       {std::numeric_limits<double>::infinity(), "inf"},
                                       {std::numeric_limits<double>::quiet_NaN(), "nan"}}) {
    const auto shape = shape_of_buffer(buffer, radius_m);
    ASSERT_TRUE(std::holds_alternative<std::string>(shape)) << text;
    EXPECT_EQ(std::get<std::string>(shape), fmt::format("radius {} m, allowed are finite sizes of 0 and more", text));
  }
  EXPECT_TRUE(std::holds_alternative<Shape>(shape_of_buffer(buffer, 0)));
}

// Joining lines is OBJ's; what follows a point's coordinates is not used, whatever it is.
TEST(IntakeXyz, ABackslashJoinsNoLines) {
  const Scene scene = load("a.xyz", "1 2 3 \\\n4 5 6\n").scene;
  const auto& points = scene.objects.at(0).shape.primitives;
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(std::get<Sphere>(points[1]).center, Vec3(4, 5, 6));
}

}  // namespace
}  // namespace collided::engine
