#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>

#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

using test::append;
using test::complaint;
using test::load;

std::string base64(std::string_view bytes) {
  const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? letters[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// Four points of a square at height 1 and the corners 0 1 2, 0 2 3.
std::string square_bytes() {
  std::string bytes;
  for (const float number : {0.f, 0.f, 1.f, 1.f, 0.f, 1.f, 1.f, 1.f, 1.f, 0.f, 1.f, 1.f}) append(bytes, number);
  for (const int corner : {0, 1, 2, 0, 2, 3}) append(bytes, static_cast<std::uint16_t>(corner));
  return bytes;
}

std::string gltf(std::string_view nodes, std::string_view primitive = R"({"attributes":{"POSITION":0},"indices":1})",
                 std::string_view extra = "", std::string bytes = square_bytes()) {
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},"nodes":[{}],"meshes":[{{"name":"square","primitives":[{}]}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},)"
      R"({{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":12}}],{})"
      R"("buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}})",
      nodes, primitive, extra, bytes.size(), base64(bytes));
}

TEST(IntakeGltf, YIsUpByTheFormatAndSaidAndAnOptionGoesBefore) {
  const auto loaded = load("a.gltf", gltf(R"({"mesh":0,"translation":[0,2,0]})"));
  EXPECT_EQ(loaded.scene.parts.at(0).name, "a/square");
  EXPECT_EQ(loaded.scene.mesh.triangles.size(), 2u);
  // (x, y, z) -> (x, -z, y)
  EXPECT_EQ(loaded.scene.mesh.vertices[2], Vec3(1, -1, 3));
  EXPECT_EQ(loaded.report.placed.at(0), "a unit of the file is 1 m, as glTF says");
  EXPECT_EQ(loaded.report.placed.at(1), "y is up and turned to z, as glTF says");
  EXPECT_EQ(load("a.gltf", gltf(R"({"mesh":0})"), {.up = 'z'}).scene.mesh.vertices[2], Vec3(1, 1, 1));
}

TEST(IntakeGltf, PlacesMultiplyDownTheTreeInDouble) {
  // A scene at UTM coordinates keeps the millimetre that single precision would lose.
  const std::string nodes = R"({"translation":[4649000.001,500000,0],"children":[1]},)"
                            R"({"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,1,1]})";
  const auto loaded = load("a.gltf", gltf(nodes), {.up = 'z'});
  EXPECT_NEAR(loaded.scene.mesh.vertices[1][0], 4649000.001, 1e-9);
  EXPECT_NEAR(loaded.scene.mesh.vertices[1][1], 500002, 1e-9);
}

TEST(IntakeGltf, AMirroredNodeKeepsItsOutside) {
  const auto loaded = load("a.gltf", gltf(R"({"mesh":0,"scale":[-1,1,1]})"), {.up = 'z'});
  const Triangle t = loaded.scene.mesh.triangle(0);
  EXPECT_GT((t.b - t.a).cross(t.c - t.a)[2], 0);
}

TEST(IntakeGltf, AMatrixIsReadByColumns) {
  const auto loaded = load("a.gltf", gltf(R"({"mesh":0,"matrix":[0,1,0,0, -1,0,0,0, 0,0,1,0, 5,6,7,1]})"), {.up = 'z'});
  EXPECT_EQ(loaded.scene.mesh.vertices[1], Vec3(5, 7, 8));
}

TEST(IntakeGltf, StripsAndFansAreTurnedToTriangles) {
  const auto corners = [](int mode) {
    return load("a.gltf", gltf(R"({"mesh":0})", fmt::format(R"({{"attributes":{{"POSITION":0}},"mode":{}}})", mode)),
                {.up = 'z'})
        .scene.mesh.triangles;
  };
  EXPECT_EQ(corners(5), (std::vector<TriangleCorners>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(corners(6), (std::vector<TriangleCorners>{{1, 2, 0}, {2, 3, 0}}));
}

TEST(IntakeGltf, SparseValuesReplaceTheirElements) {
  std::string bytes = square_bytes();
  append(bytes, std::uint8_t{2});
  bytes.append(3, '\0');
  for (const float number : {9.f, 8.f, 7.f}) append(bytes, number);
  std::string text = gltf(R"({"mesh":0})", R"({"attributes":{"POSITION":0},"indices":1})", "", bytes);
  const auto put = [&](const std::string& what, const std::string& by) {
    text.replace(text.find(what), what.size(), by);
  };
  put(R"("count":4,"type":"VEC3")",
      R"("count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}})");
  put(R"("byteLength":12}])",
      R"("byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":1},{"buffer":0,"byteOffset":64,"byteLength":12}])");
  EXPECT_EQ(load("a.gltf", text, {.up = 'z'}).scene.mesh.vertices[2], Vec3(9, 8, 7));
}

// Four elements are numbered 0 to 3.
TEST(IntakeGltf, ASparseValueOfNoElementIsRefused) {
  for (const int place : {3, 4, 5, 255}) {
    std::string bytes = square_bytes();
    append(bytes, static_cast<std::uint8_t>(place));
    bytes.append(3, '\0');
    for (const float number : {9.f, 8.f, 7.f}) append(bytes, number);
    std::string text = gltf(R"({"mesh":0})", R"({"attributes":{"POSITION":0},"indices":1})", "", bytes);
    const auto put = [&](const std::string& what, const std::string& by) {
      text.replace(text.find(what), what.size(), by);
    };
    put(R"("count":4,"type":"VEC3")",
        R"("count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}})");
    put(R"("byteLength":12}])",
        R"("byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":1},{"buffer":0,"byteOffset":64,"byteLength":12}])");
    const std::string said = complaint("a.gltf", text, {.up = 'z'});
    if (place == 3) EXPECT_EQ(said, "loaded");
    else EXPECT_NE(said.find(fmt::format("name element {} of 4", place)), std::string::npos) << said;
  }
}

TEST(IntakeGltf, ABinaryFileHoldsItsBytesBehindItsText) {
  std::string text = gltf(R"({"mesh":0})");
  const std::size_t uri = text.find(",\"uri\"");
  text = text.substr(0, uri) + "}]}";
  while (text.size() % 4 != 0) text += ' ';
  const std::string bytes = square_bytes();
  std::string glb;
  append(glb, std::uint32_t{0x46546c67});
  append(glb, std::uint32_t{2});
  append(glb, static_cast<std::uint32_t>(28 + text.size() + bytes.size()));
  append(glb, static_cast<std::uint32_t>(text.size()));
  append(glb, std::uint32_t{0x4e4f534a});
  glb += text;
  append(glb, static_cast<std::uint32_t>(bytes.size()));
  append(glb, std::uint32_t{0x004e4942});
  glb += bytes;
  EXPECT_EQ(load("a.glb", glb).scene.mesh.triangles.size(), 2u);
  for (std::size_t end = 0; end < glb.size(); end += 5)
    EXPECT_NE(complaint("a.glb", glb.substr(0, end)), "loaded") << end;
}

TEST(IntakeGltf, ComplaintsNameTheWayToWhatIsWrong) {
  EXPECT_EQ(complaint("a.gltf", gltf(R"({"mesh":3})")),
            "a.gltf: /nodes/0/mesh is 3, allowed are numbers below 1. Nothing was loaded.");
  EXPECT_EQ(complaint("a.gltf", gltf(R"({"children":[0],"mesh":0})")),
            "a.gltf: no triangles (0 vertices). Nothing was loaded.");
  EXPECT_EQ(complaint("a.gltf", gltf(R"({"children":[1,1]},{"mesh":0})")),
            "a.gltf: /nodes/1 stands in the scene twice or below itself. Nothing was loaded.");
  EXPECT_EQ(complaint("a.gltf", gltf(R"({"mesh":0})", R"({"attributes":{"POSITION":1}})")),
            "a.gltf: /accessors/1 is not of type VEC3. Nothing was loaded.");
  EXPECT_EQ(complaint("a.gltf", "{\"asset\":"),
            "a.gltf: byte 10: the JSON text breaks off or is wrong here. Nothing was loaded.");
  EXPECT_EQ(complaint("a.gltf", R"({"asset":{"version":"1.0"}})"),
            "a.gltf: glTF version '1.0'; only 2.x is read. Nothing was loaded.");
  EXPECT_EQ(complaint("a.gltf", gltf(R"({"mesh":0})", R"({"attributes":{"POSITION":0}})",
                                     R"("extensionsRequired":["KHR_draco_mesh_compression"],)")),
            "a.gltf: its triangles are packed by KHR_draco_mesh_compression, which is not read. Nothing was loaded.");
  std::string far_file = gltf(R"({"mesh":0})");
  far_file.replace(far_file.find("data:application"), 16, "../../etc/passwd");
  EXPECT_NE(complaint("a.gltf", far_file).find("only files in the folder of this one and below it are read"),
            std::string::npos);
  std::string nan = square_bytes();
  for (std::size_t i = 0; i < 4; ++i) nan[i] = '\xff';
  EXPECT_NE(complaint("a.gltf", gltf(R"({"mesh":0})", R"({"attributes":{"POSITION":0}})", "", nan))
                .find("/accessors/0 has a vertex, number 0, that is ("),
            std::string::npos);
}

TEST(IntakeGltf, WhatIsLeftOutIsTold) {
  const auto loaded =
      load("a.gltf", gltf(R"({"mesh":0})", R"({"attributes":{"POSITION":0}},{"attributes":{"POSITION":0},"mode":1})",
                          R"("animations":[{},{}],)"));
  ASSERT_EQ(loaded.report.refused.size(), 3u);
  EXPECT_EQ(loaded.report.refused[0].substr(0, 40), "1 primitives of points, lines or without");
  EXPECT_EQ(loaded.report.refused[1], "1 corners left over that make no triangle");
  EXPECT_EQ(loaded.report.refused[2], "2 animations left out; the scene stands as it is");
}

TEST(IntakeGltf, LimitsAreKept) {
  EXPECT_EQ(complaint("a.gltf", gltf(R"({"mesh":0})"), {.max_triangles = 1}),
            "a.gltf: 2 triangles, limit 1. Nothing was loaded.");
  std::string bare = gltf(R"({"mesh":0})", R"({"attributes":{"POSITION":0}})");
  const std::string view = R"("bufferView":0,"componentType":5126,"count":4)";
  bare.replace(bare.find(view), view.size(), R"("componentType":5126,"count":4000000)");
  EXPECT_NE(complaint("a.gltf", bare).find("has 4000000 elements and no buffer view"), std::string::npos);
}

// A parent that is turned, moved and scaled otherwise along each axis: no two of these steps may change places.
TEST(IntakeGltf, ATurnedAndUnevenlyScaledParentPlacesItsChildWhole) {
  const std::string nodes =
      R"({"translation":[10,20,30],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,3,5],"children":[1]},)"
      R"({"mesh":0,"translation":[1,2,4],"rotation":[0.7071067811865476,0,0,0.7071067811865476],"scale":[7,11,13]})";
  const std::vector<Vec3> vertices = load("a.gltf", gltf(nodes), {.up = 'z'}).scene.mesh.vertices;
  // (x, y, z) -> child (7x + 1, -13z + 2, 11y + 4) = (a, b, c) -> parent (10 - 3b, 20 + 2a, 30 + 5c)
  const auto by_hand = [](double x, double y, double z) {
    return Vec3(10 - 3 * (-13 * z + 2), 20 + 2 * (7 * x + 1), 30 + 5 * (11 * y + 4));
  };
  EXPECT_LT((vertices.at(0) - by_hand(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((vertices.at(1) - by_hand(1, 0, 1)).norm(), 1e-12);
  EXPECT_LT((vertices.at(2) - by_hand(1, 1, 1)).norm(), 1e-12);
  EXPECT_EQ(by_hand(1, 1, 1), Vec3(43, 36, 105));
  // As the format is by default: y up.
  const std::vector<Vec3> turned = load("a.gltf", gltf(nodes)).scene.mesh.vertices;
  EXPECT_LT((turned.at(2) - Vec3(43, -105, 36)).norm(), 1e-12);
}

// Three levels, one of them a matrix that shears; siblings begin from their parent and not from each other.
TEST(IntakeGltf, EveryBranchOfTheTreeIsPlacedByItsOwnAncestors) {
  const std::string nodes = R"({"name":"top","translation":[100,0,0],"children":[1,3]},)"
                            R"({"name":"sheared","matrix":[1,0,0,0, 2,1,0,0, 0,0,3,0, 0,10,0,1],"children":[2]},)"
                            R"({"name":"leaf","mesh":0,"scale":[1,4,1]},)"
                            R"({"name":"beside","mesh":0,"translation":[0,0,7]})";
  const Scene scene = load("a.gltf", gltf(nodes), {.up = 'z'}).scene;
  ASSERT_EQ(scene.parts.size(), 2u);
  EXPECT_EQ(scene.parts[0].name, "a/leaf");
  EXPECT_EQ(scene.parts[1].name, "a/beside");
  EXPECT_EQ(scene.parts[1].first_triangle, 2u);
  EXPECT_EQ(scene.parts[1].triangle_count, 2u);
  EXPECT_EQ(scene.mesh.vertices.at(2), Vec3(100 + 1 + 2 * 4, 10 + 4, 3));
  EXPECT_EQ(scene.mesh.vertices.at(6), Vec3(101, 1, 8));
  EXPECT_EQ(scene.mesh.triangles.at(2), (TriangleCorners{4, 5, 6}));
}

TEST(IntakeGltf, TwoMirrorsInARowLeaveTheOutsideWhereItWas) {
  const std::string nodes = R"({"scale":[-1,1,1],"children":[1]},{"mesh":0,"scale":[1,-1,1]})";
  EXPECT_EQ(load("a.gltf", gltf(nodes), {.up = 'z'}).scene.mesh.triangles[0], (TriangleCorners{0, 1, 2}));
  const std::string mirrored_below = R"({"scale":[1,1,-1],"children":[1]},{"mesh":0})";
  EXPECT_EQ(load("a.gltf", gltf(mirrored_below), {.up = 'z'}).scene.mesh.triangles[0], (TriangleCorners{0, 2, 1}));
  const std::string strip = R"({"attributes":{"POSITION":0},"mode":5})";
  EXPECT_EQ(load("a.gltf", gltf(mirrored_below, strip), {.up = 'z'}).scene.mesh.triangles,
            (std::vector<TriangleCorners>{{0, 2, 1}, {1, 2, 3}}));
}

TEST(IntakeGltf, TheSceneThatTheFileNamesIsTheOneLoaded) {
  const std::string nodes = R"({"name":"one","mesh":0},{"name":"other","mesh":0,"translation":[5,6,7]})";
  const auto loaded = load("a.gltf",
                           gltf(nodes, R"({"attributes":{"POSITION":0},"indices":1})",
                                R"("scene":1,"scenes":[{"nodes":[0]},{"nodes":[1]}],)"),
                           {.up = 'z'});
  ASSERT_EQ(loaded.scene.parts.size(), 1u);
  EXPECT_EQ(loaded.scene.parts[0].name, "a/other");
  EXPECT_EQ(loaded.scene.mesh.vertices.at(0), Vec3(5, 6, 8));
  EXPECT_EQ(loaded.report.refused.at(0), "1 scenes left out; loaded is number 1");
}

TEST(IntakeGltf, TwoPrimitivesOfAMeshKeepTheirOwnVertices) {
  const auto loaded = load(
      "a.gltf",
      gltf(R"({"mesh":0})", R"({"attributes":{"POSITION":0},"indices":1},{"attributes":{"POSITION":0},"indices":1})"),
      {.up = 'z'});
  EXPECT_EQ(loaded.scene.mesh.triangles, (std::vector<TriangleCorners>{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}));
  ASSERT_EQ(loaded.scene.parts.size(), 1u);
  EXPECT_EQ(loaded.scene.parts[0].triangle_count, 4u);
}

/// A document whose buffer holds `positions` as that component type at an offset of 4 and a stride of 8 bytes, and nothing
/// else; the corners are 0 1 2.
std::string quantized(const std::string& positions, int component, bool is_unit) {
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],)"
      R"("accessors":[{{"bufferView":0,"byteOffset":2,"componentType":{},"normalized":{},"count":3,"type":"VEC3"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteOffset":2,"byteStride":8,"byteLength":{}}}],)"
      R"("buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}})",
      component, is_unit, positions.size() - 2, positions.size(), base64(positions));
}

template <class Number>
std::string strided(const std::vector<std::array<Number, 3>>& points) {
  std::string bytes(4, '\x55');
  for (const auto& point : points) {
    const std::size_t end = bytes.size() + 8;
    for (const Number number : point) append(bytes, number);
    bytes.resize(end, '\x55');
  }
  return bytes;
}

TEST(IntakeGltf, WholeNumbersStandForThemselvesOrForPartsOfOne) {
  const auto vertices = [](const std::string& bytes, int component, bool is_unit) {
    return load("a.gltf", quantized(bytes, component, is_unit), {.up = 'z'}).scene.mesh.vertices;
  };
  using Points = std::vector<Vec3>;
  EXPECT_EQ(vertices(strided<std::int8_t>({{-128, 127, 1}, {2, 3, 4}, {5, 7, 6}}), 5120, false),
            (Points{{-128, 127, 1}, {2, 3, 4}, {5, 7, 6}}));
  EXPECT_EQ(vertices(strided<std::int8_t>({{-128, 127, 0}, {-127, 0, 127}, {0, 127, 127}}), 5120, true),
            (Points{{-1, 1, 0}, {-1, 0, 1}, {0, 1, 1}}))
      << "the least number stands for -1, as the one above it does";
  EXPECT_EQ(vertices(strided<std::uint8_t>({{0, 255, 51}, {102, 153, 204}, {255, 0, 0}}), 5121, true),
            (Points{{0, 1, 51 / 255.}, {0.4, 0.6, 0.8}, {1, 0, 0}}));
  EXPECT_EQ(vertices(strided<std::uint8_t>({{200, 1, 2}, {3, 4, 5}, {6, 8, 7}}), 5121, false),
            (Points{{200, 1, 2}, {3, 4, 5}, {6, 8, 7}}));
  EXPECT_EQ(vertices(strided<std::int16_t>({{-32768, 300, 1}, {2, -3, 4}, {5, 7, 6}}), 5122, false),
            (Points{{-32768, 300, 1}, {2, -3, 4}, {5, 7, 6}}));
  EXPECT_EQ(vertices(strided<std::uint16_t>({{65535, 300, 1}, {2, 3, 4}, {5, 7, 6}}), 5123, false),
            (Points{{65535, 300, 1}, {2, 3, 4}, {5, 7, 6}}));
  EXPECT_EQ(vertices(strided<std::uint16_t>({{65535, 0, 0}, {0, 65535, 0}, {0, 0, 13107}}), 5123, true),
            (Points{{1, 0, 0}, {0, 1, 0}, {0, 0, 0.2}}));
}

TEST(IntakeGltf, CornersMayBeOneTwoOrFourBytes) {
  const auto triangles = [](auto corner, int component) {
    std::string bytes = square_bytes().substr(0, 48);
    for (const int number : {3, 1, 0, 2, 0, 1}) append(bytes, static_cast<decltype(corner)>(number));
    std::string text = gltf(R"({"mesh":0})", R"({"attributes":{"POSITION":0},"indices":1})", "", bytes);
    const auto put = [&](const std::string& what, const std::string& by) {
      text.replace(text.find(what), what.size(), by);
    };
    put("5123", std::to_string(component));
    put(R"("byteLength":12})", fmt::format(R"("byteLength":{}}})", 6 * sizeof corner));
    return load("a.gltf", text, {.up = 'z'}).scene.mesh.triangles;
  };
  const std::vector<TriangleCorners> expected{{3, 1, 0}, {2, 0, 1}};
  EXPECT_EQ(triangles(std::uint8_t{}, 5121), expected);
  EXPECT_EQ(triangles(std::uint16_t{}, 5123), expected);
  EXPECT_EQ(triangles(std::uint32_t{}, 5125), expected);
}

}  // namespace
}  // namespace collided::engine
