#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

using test::complaint;
using test::load;

TEST(IntakeOff, CommentsColoursAndPolygonsAreRead) {
  const std::string text =
      "COFF # colours\n# counts next\n4 2 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n\n1 1 0.1 255 0 0 255\n"
      "0 1 0.1 255 0 0 255\n3 0 1 2 0.5 0.5 0.5\n4 0 1 2 3\n";
  const test::Loaded loaded = load("c.off", text);
  EXPECT_EQ(loaded.scene.mesh.triangles.size(), 3u);
  EXPECT_EQ(loaded.scene.mesh.vertices[2], Vec3(1, 1, 0.1));
}

TEST(IntakeOff, CountsMayShareTheFirstLineAndTheWordMayBeMissing) {
  EXPECT_EQ(load("a.off", "OFF 3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").scene.mesh.triangles.size(), 1u);
  EXPECT_EQ(load("b.off", "3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").scene.mesh.triangles.size(), 1u);
}

TEST(IntakeOff, FacesOfTwoCornersAreLeftOutAndTold) {
  const std::string text = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n2 0 1\n";
  const test::Loaded loaded = load("e.off", text);
  ASSERT_EQ(loaded.report.refused.size(), 1u);
  EXPECT_EQ(complaint("e.off", text, {.strict = true}),
            "e.off: line 7: face of 2 corners, at least 3 are needed. Nothing was loaded.");
}

TEST(IntakeOff, ComplaintsNameThePlace) {
  EXPECT_EQ(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            "a.off: line 6: vertex number 3, allowed 0 to 2. Nothing was loaded.");
  EXPECT_EQ(complaint("a.off", "OFF\n1000000000 1 0\n"),
            "a.off: line 2: vertex count 1000000000, the file has room for 4. Nothing was loaded.");
  EXPECT_EQ(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n"),
            "a.off: line 5: the file ends after 2 of 3 vertices. Nothing was loaded.");
  EXPECT_EQ(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n999999999999 0 1 2\n"),
            "a.off: line 6: vertex number is missing. Nothing was loaded.");
  EXPECT_EQ(complaint("a.off", "4OFF\n1 1 0\n").substr(0, 22), "a.off: line 1: '4OFF' ");
  EXPECT_EQ(complaint("a.off", "OFF BINARY\n"),
            "a.off: line 1: binary OFF is not read; write it as text. Nothing was loaded.");
  EXPECT_EQ(complaint("a.off", "OFF\n-1 1 0\n"),
            "a.off: line 2: vertex count -1, the file has room for 2. Nothing was loaded.");
}

TEST(IntakeOff, EachNumberIsReadAtItsPlace) {
  for (const char* head : {"OFF\n", "COFF\n", "STCNOFF\n", "NOFF\n", ""}) {
    const std::string more = std::string_view(head) == "OFF\n" || *head == '\0' ? "" : " 9 9 9";
    const Scene scene = load("a.off", std::string(head) + "4 2 0\n1 2 3" + more + "\n4 5 6" + more + "\n7 8 10" + more +
                                          "\n11 13 12" + more + "\n3 2 0 1\n3 3 1 0\n")
                            .scene;
    EXPECT_EQ(scene.mesh.vertices, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}, {11, 13, 12}})) << head;
    EXPECT_EQ(scene.mesh.triangles, (std::vector<TriangleCorners>{{2, 0, 1}, {3, 1, 0}})) << head;
  }
}

TEST(IntakeOff, NumbersBehindAVertexAreToldWhereTheHeadPromisesNone) {
  const auto warnings = [](const std::string& head) {
    return load("a.off", head + "3 1 0\n0 0 0 9\n1 0 0\n0 1 0 9 9\n3 0 1 2\n").report.warnings;
  };
  const std::vector<std::string> said{"2 vertex lines hold more than x y z; the rest of each was not used"};
  EXPECT_EQ(warnings("OFF\n"), said);
  EXPECT_EQ(warnings(""), said);
  for (const char* head : {"COFF\n", "NOFF\n", "CNOFF\n", "STOFF\n"}) EXPECT_TRUE(warnings(head).empty()) << head;
}

// Three tenths are for the vertices, half for the faces, the rest for cutting them.
TEST(IntakeOff, ProgressRisesWithVerticesAndThenWithFaces) {
  std::string text = "OFF\n70000 70000 0\n";
  for (int i = 0; i < 70'000; ++i) text += std::to_string(i) + " 0 " + std::to_string(i % 3) + "\n";
  for (int i = 0; i < 70'000; ++i) text += "3 0 1 2\n";
  std::vector<double> told;
  load("a.off", text, {.progress = [&](double fraction) { told.push_back(fraction); }});
  ASSERT_GE(told.size(), 6u);
  EXPECT_EQ(std::vector<double>(told.begin(), told.begin() + 5),
            (std::vector<double>{0, 0, 0.3 * 65536 / 70000, 0.3, 0.3 + 0.5 * 65536 / 70000}));
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 1);
}

}  // namespace
}  // namespace collided::engine
