#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>
#include <variant>

#include "tests/oracle/seed.hpp"
#include "tests/unit/intake_loading.hpp"

namespace collided {
namespace {

using test::append;
using test::complaint;
using test::load;

std::vector<Vec3> centers(const Scene& scene) {
  std::vector<Vec3> points;
  for (const Primitive& primitive : scene.objects.at(0).shape.primitives)
    points.push_back(std::get<Sphere>(primitive).center);
  return points;
}

std::string pcd_header(std::string_view data, std::string_view types = "F F F") {
  return fmt::format(
      "# .PCD v0.7\nVERSION 0.7\nFIELDS rgb x y z\nSIZE 4 {0} {0} {0}\nTYPE U {1}\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT "
      "1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA {2}\n",
      types == "F F F" ? 8 : 4, types, data);
}

const std::vector<Vec3> kPoints = {{1.25, 2, 3}, {4649000.001, 500000.002, -3}, {-0.5, 1e-9, 7}};

TEST(IntakePcd, TextAndBothBinaryFormsGiveTheSamePoints) {
  std::string text = pcd_header("ascii");
  std::string binary = pcd_header("binary");
  std::string columns;
  for (const Vec3& p : kPoints) {
    text += fmt::format("7 {} {} {}\n", p[0], p[1], p[2]);
    append(binary, std::uint32_t{7});
    for (const double number : p) append(binary, number);
  }
  for (int i = 0; i < 3; ++i) append(columns, std::uint32_t{7});
  for (int axis = 0; axis < 3; ++axis) {
    for (const Vec3& p : kPoints) append(columns, p[axis]);
  }
  // Packed by hand: literals only, but for a run of the same twelve bytes 7 0 0 0, which reaches four back.
  std::string packed;
  packed += '\x03';
  packed += columns.substr(0, 4);
  packed += static_cast<char>(6 << 5);
  packed += '\x03';
  for (std::size_t at = 12; at < columns.size(); at += 32) {
    const std::string piece = columns.substr(at, 32);
    packed += static_cast<char>(piece.size() - 1);
    packed += piece;
  }
  std::string compressed = pcd_header("binary_compressed");
  append(compressed, static_cast<std::uint32_t>(packed.size()));
  append(compressed, static_cast<std::uint32_t>(columns.size()));
  compressed += packed;
  EXPECT_EQ(centers(load("a.pcd", text).scene), kPoints);
  EXPECT_EQ(centers(load("a.pcd", binary).scene), kPoints);
  EXPECT_EQ(centers(load("a.pcd", compressed).scene), kPoints);
  EXPECT_EQ(std::get<Sphere>(load("a.pcd", text, {.radius_m = 0.1}).scene.objects[0].shape.primitives[1]).radius_m,
            0.1);
  for (const std::string& whole : {text, binary, compressed}) {
    for (std::size_t end = 0; end + 3 < whole.size(); ++end)
      EXPECT_NE(complaint("a.pcd", whole.substr(0, end)), "loaded") << end;
  }
}

TEST(IntakePcd, PointsThatWereNotMeasuredAreLeftOutAndTold) {
  const auto loaded = load("a.pcd", pcd_header("ascii") + "7 1 2 3\n7 nan nan nan\n7 4 5 6\n");
  EXPECT_EQ(centers(loaded.scene).size(), 2u);
  EXPECT_EQ(loaded.report.refused.at(0), "1 points that are NaN (not measured) left out");
}

TEST(IntakePcd, ComplaintsNameThePlace) {
  EXPECT_EQ(complaint("a.pcd", "VERSION 0.7\nFIELDS x y\nDATA ascii\n"),
            "a.pcd: no field z; a cloud needs x, y and z. Nothing was loaded.");
  EXPECT_EQ(complaint("a.pcd", pcd_header("zip")),
            "a.pcd: DATA 'zip', allowed are ascii, binary and binary_compressed. Nothing was loaded.");
  EXPECT_EQ(complaint("a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2000000\nDATA binary\n"),
            "a.pcd: 2000000 points, the most that a cloud may have are 1000000. Nothing was loaded.");
  EXPECT_EQ(complaint("a.pcd", pcd_header("ascii") + "7 1 2 3\n7 inf 2 3\n7 1 2 3\n"),
            "a.pcd: line 13: point coordinate 'inf' is not finite. Nothing was loaded.");
}

std::string octomap(std::string_view tree, std::string_view resolution = "0.5") {
  return fmt::format(
      "# Octomap OcTree binary file\n# (feel free to add / change comments, but leave the first line as it is!)\n#\nid "
      "OcTree\nsize 3\nres {}\ndata\n{}",
      resolution, tree);
}

// Two bits a child: 1 free, 2 occupied, 3 with children of its own.
TEST(IntakeOctomap, OccupiedLeavesBecomeBoxesOfTheirLevelsSize) {
  // The root: child 0 occupied (the whole octant of negative coordinates), child 7 an inner node with child 1 occupied.
  std::string tree;
  append(tree, static_cast<std::uint16_t>(2 | 1 << 2 | 3 << 14));
  append(tree, static_cast<std::uint16_t>(2 << 2 | 1 << 4));
  const auto loaded = load("a.bt", octomap(tree));
  const auto& boxes = loaded.scene.objects.at(0).shape.primitives;
  ASSERT_EQ(boxes.size(), 2u);
  const double octant = 32768 * 0.5;
  EXPECT_EQ(std::get<Box>(boxes[0]).center, Vec3::Constant(-octant / 2));
  EXPECT_EQ(std::get<Box>(boxes[0]).half_m, Vec3::Constant(octant / 2));
  EXPECT_EQ(std::get<Box>(boxes[1]).center, Vec3(octant * 0.75, octant * 0.25, octant * 0.25));
  EXPECT_EQ(std::get<Box>(boxes[1]).half_m, Vec3::Constant(octant / 4));
  EXPECT_EQ(loaded.report.placed.at(0), "a unit of the file is 1 m, as OctoMap says");
  EXPECT_NE(complaint("a.bt", octomap(tree.substr(0, 3))).find("the tree breaks off"), std::string::npos);
}

// What is behind an inner child stands before what is behind the next one.
TEST(IntakeOctomap, BranchesFollowEachOtherInTheOrderOfTheirChildren) {
  std::string tree;
  append(tree, static_cast<std::uint16_t>(3 | 3 << 2));  // children 0 and 1 have children
  append(tree, static_cast<std::uint16_t>(2));           // of 0: child 0
  append(tree, static_cast<std::uint16_t>(2 << 14));     // of 1: child 7
  const Scene scene = load("a.bt", octomap(tree)).scene;
  std::set<double> middles;
  for (const Primitive& box : scene.objects[0].shape.primitives) middles.insert(std::get<Box>(box).center[0]);
  EXPECT_EQ(middles, (std::set<double>{-0.75 * 32768 * 0.5, 0.75 * 32768 * 0.5}));
}

TEST(IntakeOctomap, TheSmallestCellIsAtTheResolutionAndNothingGoesDeeper) {
  std::string tree;
  for (int depth = 0; depth < 15; ++depth) append(tree, static_cast<std::uint16_t>(3 << 14));
  std::string cell = tree;
  append(cell, static_cast<std::uint16_t>(2 << 14));
  const Box box = std::get<Box>(load("a.bt", octomap(cell)).scene.objects[0].shape.primitives[0]);
  EXPECT_EQ(box.half_m, Vec3::Constant(0.25));
  EXPECT_EQ(box.center, Vec3::Constant((32768 - 0.5) * 0.5));
  append(tree, static_cast<std::uint16_t>(3 << 14));
  EXPECT_NE(complaint("a.bt", octomap(tree + "\x02\x02")).find("a tree of more than 16 levels"), std::string::npos);
}

TEST(IntakeOctomap, ComplaintsNameThePlace) {
  EXPECT_EQ(complaint("a.bt", "# Octomap binary"),
            "a.bt: it does not begin with '# Octomap OcTree binary file'. Nothing was loaded.");
  EXPECT_EQ(complaint("a.bt", octomap("", "-1")),
            "a.bt: resolution -1 m, allowed are lengths above 0. Nothing was loaded.");
  std::string other = octomap("");
  other.replace(other.find("id OcTree"), 9, "id ColorO");
  EXPECT_EQ(complaint("a.bt", other),
            "a.bt: line 4: a tree of kind 'ColorO'; only OcTree is read. Nothing was loaded.");
  EXPECT_EQ(complaint("a.bt", octomap(std::string(2, '\0'))), "a.bt: no occupied cells. Nothing was loaded.");
}

TEST(IntakeBoxTable, CentresAndSizesOrCornersByTheirHeading) {
  const auto loaded = load("env.csv",
                           "name,type,sx,sy,sz,x,y,z,qw,qx,qy,qz\ntable,box,2,4,6,1,2,3,1,0,0,0\n\n# a "
                           "comment\n\"wall\",box,1,1,1,0,0,0,0.5,0.5,0.5,0.5\n");
  ASSERT_EQ(loaded.scene.objects.size(), 2u);
  EXPECT_EQ(loaded.scene.objects[0].name, "env/table");
  EXPECT_EQ(loaded.scene.objects[0].pose.position, Vec3(1, 2, 3));
  EXPECT_EQ(std::get<Box>(loaded.scene.objects[0].shape.primitives[0]).half_m, Vec3(1, 2, 3));
  EXPECT_EQ(loaded.scene.objects[1].name, "env/wall");
  const auto corners = load("w.csv", "id,min_x,min_y,min_z,max_x,max_y,max_z\nw0,0,0,0,1,2,4\n");
  EXPECT_EQ(corners.scene.objects[0].pose.position, Vec3(0.5, 1, 2));
}

TEST(IntakeBoxTable, ComplaintsNameTheLineAndTheColumn) {
  EXPECT_EQ(complaint("a.csv", "x,y,z\n1,2,3\n"),
            "a.csv: line 1: the heading has neither x,y,z,sx,sy,sz nor min_x,min_y,min_z,max_x,max_y,max_z. Nothing "
            "was loaded.");
  EXPECT_EQ(complaint("a.csv", "x,y,z,sx,sy,sz\n1,2,3,4,5,6\n1,2,3,4,nan,6\n"),
            "a.csv: line 3: 'nan' in column 'sy' is no finite number. Nothing was loaded.");
  EXPECT_EQ(complaint("a.csv", "x,y,z,sx,sy,sz\n1,2,3,4,-5,6\n"),
            "a.csv: line 2: a size of 4 -5 6, allowed are finite sizes of 0 and more. Nothing was loaded.");
  EXPECT_EQ(complaint("a.csv", "type,x,y,z,sx,sy,sz\ncone,1,2,3,4,5,6\n"),
            "a.csv: line 2: type 'cone'; only box is read. Nothing was loaded.");
  EXPECT_EQ(complaint("a.csv", "x,y,z,sx,sy,sz\n1,2,3\n"),
            "a.csv: line 2: 3 columns, the heading has 6. Nothing was loaded.");
}

}  // namespace
}  // namespace collided
