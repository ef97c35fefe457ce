#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

using test::append;
using test::complaint;
using test::load;

std::string binary_stl(const std::vector<std::array<float, 9>>& triangles, const std::string& head = "made by hand",
                       std::uint32_t surplus_claim = 0) {
  std::string bytes = head;
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(triangles.size()) + surplus_claim);
  for (const auto& corners : triangles) {
    bytes.append(12, '\0');
    for (const float value : corners) { append(bytes, value); }
    bytes.append(2, '\0');
  }
  return bytes;
}

constexpr std::array<float, 9> kFirst = {0, 0, 0, 1, 0, 0, 0, 1, 0};
constexpr std::array<float, 9> kSecond = {1, 0, 0, 1, 1, 0, 0, 1, 0};

const std::string kText =
    "solid left\nfacet normal nan 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0.1\n "
    "endloop\nendfacet\n"
    "endsolid left\nSOLID right\n FACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 1 0 0\nVERTEX 1 1 0\nVERTEX 0 1 0.1\nENDLOOP\n"
    "ENDFACET\nENDSOLID right\n";

TEST(IntakeStl, CornersWithEqualCoordinatesAreOneVertex) {
  const Scene scene = load("two.stl", binary_stl({kFirst, kSecond})).scene;
  ASSERT_EQ(scene.mesh.triangles.size(), 2u);
  EXPECT_EQ(scene.mesh.vertices.size(), 4u);
  EXPECT_EQ(scene.mesh.triangle(1).b, Vec3(1, 1, 0));
}

TEST(IntakeStl, ABinaryFileMayBeginWithSolid) {
  EXPECT_EQ(load("s.stl", binary_stl({kFirst}, "solid facet of a file")).scene.mesh.triangles.size(), 1u);
}

TEST(IntakeStl, TextKeepsItsDigitsAndItsSolids) {
  const Scene scene = load("t.stl", kText).scene;
  ASSERT_EQ(scene.parts.size(), 2u);
  EXPECT_EQ(scene.parts[0].name, "t/left");
  EXPECT_EQ(scene.parts[1].name, "t/right");
  EXPECT_EQ(scene.mesh.vertices.size(), 4u);
  EXPECT_EQ(scene.mesh.triangle(0).c[2], 0.1);
}

TEST(IntakeStl, AHeaderThatClaimsTooMuchIsRefusedBeforeAnythingIsAllocated) {
  EXPECT_EQ(complaint("c.stl", binary_stl({kFirst}, "x", 1'000'000'000)),
            "c.stl: byte 80: header claims 1000000001 triangles, the file has room for 1. Nothing was loaded.");
}

TEST(IntakeStl, ComplaintsNameThePlace) {
  auto bad = kSecond;
  bad[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(complaint("n.stl", binary_stl({kFirst, bad})),
            "n.stl: byte 162: triangle 2 of 2: coordinate nan is not finite. Nothing was loaded.");
  EXPECT_EQ(complaint("n.stl", "short"), "n.stl: 5 bytes, a binary STL has at least 84. Nothing was loaded.");
  EXPECT_EQ(complaint("n.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n"),
            "n.stl: line 6: facet of 2 corners, at least 3 are needed. Nothing was loaded.");
  EXPECT_EQ(complaint("n.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n"),
            "n.stl: line 4: vertex coordinate 'zero' is not a number. Nothing was loaded.");
  EXPECT_EQ(complaint("n.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
            "n.stl: line 5: the file ends inside a facet. Nothing was loaded.");
  EXPECT_EQ(complaint("n.stl", "solid a\nfacet normal 0 0 1\nbanana\n"),
            "n.stl: line 3: 'banana' is no word of STL. Nothing was loaded.");
  EXPECT_EQ(complaint("n.stl", "solid a\nendsolid a\n"), "n.stl: no triangles (0 vertices). Nothing was loaded.");
  EXPECT_EQ(complaint("n.stl", binary_stl({kFirst, kSecond}), {.max_triangles = 1}),
            "n.stl: 2 triangles, limit 1. Nothing was loaded.");
}

TEST(IntakeStl, BytesBehindTheLastTriangleAreTold) {
  const test::Loaded loaded = load("b.stl", binary_stl({kFirst}) + "tail");
  ASSERT_EQ(loaded.report.warnings.size(), 1u);
  EXPECT_EQ(loaded.report.warnings[0], "4 bytes after the 1 triangles that the header counts were not read");
}

// Nine unlike numbers a triangle, a normal that is not zero and bytes behind it that are not: each stands where it belongs.
TEST(IntakeStl, EachNumberOfATriangleIsReadAtItsPlace) {
  std::string bytes(80, ' ');
  append(bytes, std::uint32_t{2});
  for (const float shift : {0.F, 100.F}) {
    for (const float normal : {50.F, 51.F, 52.F}) append(bytes, normal);
    for (const float number : {1.F, 2.F, 3.F, 4.F, 5.F, 6.F, 7.F, 8.F, 10.F}) append(bytes, number + shift);
    append(bytes, std::uint16_t{0xffff});
  }
  const Scene scene = load("n.stl", bytes).scene;
  ASSERT_EQ(scene.mesh.triangles.size(), 2u);
  EXPECT_EQ(scene.mesh.triangle(0).a, Vec3(1, 2, 3));
  EXPECT_EQ(scene.mesh.triangle(0).b, Vec3(4, 5, 6));
  EXPECT_EQ(scene.mesh.triangle(0).c, Vec3(7, 8, 10));
  EXPECT_EQ(scene.mesh.triangle(1).a, Vec3(101, 102, 103));
  EXPECT_EQ(scene.mesh.triangle(1).c, Vec3(107, 108, 110));
  const Scene text = load("t.stl",
                          "solid\nfacet normal 50 51 52\nouter loop\nvertex 1 2 3\nvertex 4 5 6\nvertex 7 8 "
                          "10\nendloop\nendfacet\nendsolid\n")
                         .scene;
  EXPECT_EQ(text.mesh.triangle(0).a, Vec3(1, 2, 3));
  EXPECT_EQ(text.mesh.triangle(0).b, Vec3(4, 5, 6));
  EXPECT_EQ(text.mesh.triangle(0).c, Vec3(7, 8, 10));
}

TEST(IntakeStl, TheSecondSolidHasItsOwnTriangles) {
  const Scene scene = load("t.stl", kText).scene;
  EXPECT_EQ(scene.parts.at(0).first_triangle, 0u);
  EXPECT_EQ(scene.parts.at(0).triangle_count, 1u);
  EXPECT_EQ(scene.parts.at(1).first_triangle, 1u);
  EXPECT_EQ(scene.parts.at(1).triangle_count, 1u);
  EXPECT_EQ(scene.mesh.triangle(1).b, Vec3(1, 1, 0));
}

}  // namespace
}  // namespace collided::engine
