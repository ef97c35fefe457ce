#include <algorithm>
#include <gtest/gtest.h>

#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

using test::complaint;
using test::load;

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(IntakeObj, CornerFormsAndNegativeNumbersNameTheSameVertices) {
  const std::string text = std::string(kSquare) +
                           "vt 0 0\nvn 0 0 1\n"
                           "f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/1\nf -4 -3 -2\n";
  const Scene scene = load("square.obj", text).scene;
  ASSERT_EQ(scene.mesh.triangles.size(), 5u);
  for (const TriangleCorners& corners : scene.mesh.triangles) { EXPECT_EQ(corners, (TriangleCorners{0, 1, 2})); }
}

TEST(IntakeObj, NegativeNumbersCountFromWhereTheyStand) {
  const Scene scene =
      load("two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\n").scene;
  EXPECT_EQ(scene.mesh.triangles[0], (TriangleCorners{0, 1, 2}));
  EXPECT_EQ(scene.mesh.triangles[1], (TriangleCorners{3, 4, 5}));
}

TEST(IntakeObj, CoordinatesKeepEveryDigitOfADouble) {
  const Scene scene = load("utm.obj", "v 4649000.1234567891 -0.1 1e-300\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").scene;
  EXPECT_EQ(scene.mesh.vertices[0], Vec3(4649000.1234567891, -0.1, 1e-300));
}

TEST(IntakeObj, NumbersMayBeWrittenInEveryUsualWay) {
  const Scene scene = load("n.obj", "v +1 2. .5\nv 1E2 -2.e+1 3e-01\nv 1e-400 -0 007\nf 1 2 3\n").scene;
  EXPECT_EQ(scene.mesh.vertices[0], Vec3(1, 2, 0.5));
  EXPECT_EQ(scene.mesh.vertices[1], Vec3(100, -20, 0.3));
  EXPECT_EQ(scene.mesh.vertices[2], Vec3(0, 0, 7));
}

TEST(IntakeObj, LinesMayBeContinuedCommentedAndEndLikeWindows) {
  const Scene scene = load("c.obj", "# head\r\nv 0 0 \\\r\n 0\r\nv 1 0 0 # here\r\nv 0 1 0\r\n\r\nf 1 \\\r\n2 3").scene;
  ASSERT_EQ(scene.mesh.triangles.size(), 1u);
  EXPECT_EQ(scene.mesh.vertices[0], Vec3(0, 0, 0));
}

TEST(IntakeObj, OneNamelessPartHasTheNameOfTheScene) {
  const Scene scene = load("box.obj", std::string(kSquare) + "f 1 2 3 4\n").scene;
  ASSERT_EQ(scene.parts.size(), 1u);
  EXPECT_EQ(scene.parts[0].name, "box");
  EXPECT_EQ(scene.parts[0].triangle_count, 2u);
}

TEST(IntakeObj, ObjectsGroupsAndMaterialsBecomeParts) {
  const std::string text = std::string(kSquare) +
                           "o shelf\nusemtl steel\nf 1 2 3\ng top\nf 1 3 4\nusemtl wood\nf 1 2 4\n"
                           "o crate\nusemtl wood\nf 2 3 4\n";
  const Scene scene = load("hall.obj", text).scene;
  ASSERT_EQ(scene.parts.size(), 4u);
  EXPECT_EQ(scene.parts[0].name, "hall/shelf");
  EXPECT_EQ(scene.parts[1].name, "hall/shelf/top/steel");
  EXPECT_EQ(scene.parts[2].name, "hall/shelf/top/wood");
  EXPECT_EQ(scene.parts[3].name, "hall/crate");
}

TEST(IntakeObj, PartsTileTheTrianglesAlsoWhenAGroupComesBack) {
  const Scene scene = load("back.obj", std::string(kSquare) + "g a\nf 1 2 3\ng b\nf 1 2 4\ng a\nf 2 3 4\n").scene;
  ASSERT_EQ(scene.parts.size(), 2u);
  EXPECT_EQ(scene.parts[0].triangle_count, 2u);
  EXPECT_EQ(scene.parts[1].first_triangle, 2u);
  EXPECT_EQ(scene.mesh.triangles[1], (TriangleCorners{1, 2, 3}));
  EXPECT_EQ(scene.mesh.triangles[2], (TriangleCorners{0, 1, 3}));
}

TEST(IntakeObj, AGroupWithoutFacesIsNoPart) {
  const Scene scene = load("hall.obj", std::string(kSquare) + "f 1 2 3\ng a\ng b\nf 1 2 4\nf 1 3 4\ng c\n").scene;
  ASSERT_EQ(scene.parts.size(), 2u);
  EXPECT_EQ(scene.parts[0].triangle_count, 1u);
  EXPECT_EQ(scene.parts[1].name, "hall/b");
  EXPECT_EQ(scene.parts[1].triangle_count, 2u);
  EXPECT_EQ(scene.mesh.triangles, (std::vector<TriangleCorners>{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}}));
}

TEST(IntakeObj, ANameThatComesTwiceIsNumberedAndTold) {
  const std::string text = std::string(kSquare) + "o crate\nf 1 2 3\no crate\nf 1 3 4\n";
  const test::Loaded loaded = load("hall.obj", text);
  EXPECT_EQ(loaded.scene.parts[1].name, "hall/crate#2");
  ASSERT_EQ(loaded.report.mended.size(), 1u);
  EXPECT_NE(complaint("hall.obj", text, {.strict = true}), "loaded");
}

TEST(IntakeObj, AConcavePolygonKeepsItsArea) {
  // An L of area 3 whose fan from the first corner would cover the notch.
  const std::string text = "v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nf 1 2 3 4 5 6\n";
  const Scene scene = load("l.obj", text).scene;
  ASSERT_EQ(scene.mesh.triangles.size(), 4u);
  double area = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Triangle t = scene.mesh.triangle(i);
    const double twice = (t.b - t.a).cross(t.c - t.a)[2];
    EXPECT_GT(twice, 0);
    area += twice / 2;
  }
  EXPECT_EQ(area, 3);
}

TEST(IntakeObj, PointsAndLinesAreLeftOutWithALine) {
  const test::Loaded loaded = load("p.obj", std::string(kSquare) + "p 1\nl 1 2\nf 1 2 3\nf 1 2\n");
  EXPECT_EQ(loaded.scene.mesh.triangles.size(), 1u);
  ASSERT_EQ(loaded.report.refused.size(), 2u);
  EXPECT_EQ(loaded.report.refused[0].substr(0, 1), "2");
  EXPECT_EQ(loaded.report.refused[1].substr(0, 1), "1");
}

TEST(IntakeObj, LinesOfNoKnownKindAreCounted) {
  const test::Loaded loaded =
      load("u.obj", "mtllib m.mtl\ns off\nface 1 2 3\n" + std::string(kSquare) + "ff 1 2\nf 1 2 3\n");
  ASSERT_EQ(loaded.report.refused.size(), 1u);
  EXPECT_EQ(loaded.report.refused[0], "2 lines that begin with no word of OBJ left out, the first is line 3");
}

TEST(IntakeObj, ComplaintsNameTheLineTheValueAndTheLimit) {
  const std::string head = std::string(kSquare);
  EXPECT_EQ(complaint("a.obj", head + "\nf 1 2 90\n"), "a.obj: line 6: vertex number 90 of 4. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", head + "f 1 2 0\n"),
            "a.obj: line 5: vertex number 0, they begin at 1. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", head + "f 1 2 -5\n"),
            "a.obj: line 5: vertex number -1 before the first vertex. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", "v 0 nan 0\n"),
            "a.obj: line 1: vertex coordinate 'nan' is not finite. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", "v 0 0 -inf\n"),
            "a.obj: line 1: vertex coordinate '-inf' is not finite. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", "v 0 0 1e400\n"),
            "a.obj: line 1: vertex coordinate '1e400' is too large for a double (limit 1.8e308). Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", "\nv 0 0,5 0\n"),
            "a.obj: line 2: vertex coordinate '0,5' is not a number. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", "v 0 0\n"), "a.obj: line 1: vertex coordinate is missing. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", head), "a.obj: no triangles (4 vertices). Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", head + "f 1 2 3 4\nf 1 2 3\n", {.max_triangles = 2}),
            "a.obj: 3 triangles, limit 2. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", head + "f 1 2 9223372036854775807\n"),
            "a.obj: line 5: vertex number 9223372036854775807, limit 4294967295. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", head + "f 1 2 4294967297\n"),
            "a.obj: line 5: vertex number 4294967297, limit 4294967295. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", head + "f 1 2 -4294967293\n"),
            "a.obj: line 5: vertex number -4294967293, limit -2147483647. Nothing was loaded.");
}

TEST(IntakeObj, BadCornersAreRefused) {
  for (const char* corner : {"1/", "1//", "1/1/", "//1"}) {
    const std::string said = complaint("a.obj", std::string(kSquare) + "f 2 3 " + corner + "\n");
    EXPECT_TRUE(said == "loaded" || said.find("line 5") != std::string::npos) << corner << ": " << said;
  }
  for (const char* corner : {"x", "1/1/1/1", "1.5", "1/a", "99999999999999999999"}) {
    EXPECT_NE(complaint("a.obj", std::string(kSquare) + "f 2 3 " + corner + "\n"), "loaded") << corner;
  }
}

TEST(IntakeObj, ManyChunksGiveWhatOneGives) {
  // Four megabytes and more: several chunks, with vertices counted back across their borders and two parts.
  std::string text;
  constexpr int kStrips = 60'000;
  for (int i = 0; i < kStrips; ++i) {
    const std::string x = std::to_string(i);
    text += (i == kStrips / 2 ? "o second\n" : i == 0 ? "o first\n" : "");
    text += "v " + x + ".25 0 0\nv " + x + ".25 1 0\n";
    text += i == 0 ? "" : "f -4 -2 -1 -3\n# a comment that makes lines long enough for chunks to be many\n";
  }
  const Scene scene = load("strip.obj", text).scene;
  ASSERT_EQ(scene.mesh.vertices.size(), 2u * kStrips);
  ASSERT_EQ(scene.mesh.triangles.size(), 2u * (kStrips - 1));
  for (std::uint32_t i = 0; i + 1 < kStrips; ++i) {
    ASSERT_EQ(scene.mesh.triangles[2 * i], (TriangleCorners{2 * i, 2 * i + 2, 2 * i + 3}));
    ASSERT_EQ(scene.mesh.vertices[2 * i][0], i + 0.25);
  }
  ASSERT_EQ(scene.parts.size(), 2u);
  EXPECT_EQ(scene.parts[0].triangle_count, static_cast<unsigned>(kStrips - 2));
  text += "f 1 2 3000000\n";
  EXPECT_NE(complaint("strip.obj", text).find("vertex number 3000000 of 120000"), std::string::npos);
  const auto line_count = static_cast<long>(std::count(text.begin(), text.end(), '\n'));
  EXPECT_NE(complaint("strip.obj", text).find("line " + std::to_string(line_count) + ":"), std::string::npos);
  EXPECT_NE(complaint("strip.obj", text + "v 1 2 \\\nx\n").find("line " + std::to_string(line_count + 2) + ":"),
            std::string::npos);
}

}  // namespace
}  // namespace collided::engine
