#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <variant>

#include "tests/oracle/seed.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
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

// Columns of every type, more than one number in some, and a count that only width and height give.
TEST(IntakePcd, EveryTypeOfColumnIsReadAtItsPlace) {
  const auto header = [](std::string_view data, int bytes, char type) {
    return fmt::format(
        "FIELDS normal z rgb y x\nSIZE 4 {0} 2 {0} {0}\nTYPE F {1} U {1} {1}\nCOUNT 3 1 2 1 1\nWIDTH 1\nHEIGHT 2\nDATA "
        "{2}\n",
        bytes, type, data);
  };
  const auto check = [&](auto number, char type, const std::vector<Vec3>& points) {
    using Number = decltype(number);
    const std::string name = fmt::format("{}{}", type, 8 * sizeof(Number));
    std::string text = header("ascii", sizeof(Number), type);
    std::string binary = header("binary", sizeof(Number), type);
    std::string columns;
    for (const Vec3& p : points) {
      text += fmt::format("0.5 0.25 0.125 {} 7 7 {} {}\n", p[2], p[1], p[0]);
      for (const float unused : {0.5F, 0.25F, 0.125F}) append(binary, unused);
      append(binary, static_cast<Number>(p[2]));
      for (int i = 0; i < 2; ++i) append(binary, std::uint16_t{7});
      append(binary, static_cast<Number>(p[1]));
      append(binary, static_cast<Number>(p[0]));
    }
    for (std::size_t i = 0; i < 3 * points.size(); ++i) append(columns, 0.5F);
    for (const Vec3& p : points) append(columns, static_cast<Number>(p[2]));
    for (std::size_t i = 0; i < 2 * points.size(); ++i) append(columns, std::uint16_t{7});
    for (const Vec3& p : points) append(columns, static_cast<Number>(p[1]));
    for (const Vec3& p : points) append(columns, static_cast<Number>(p[0]));
    std::string packed;
    for (std::size_t at = 0; at < columns.size(); at += 32) {
      const std::string piece = columns.substr(at, 32);
      packed += static_cast<char>(piece.size() - 1);
      packed += piece;
    }
    std::string compressed = header("binary_compressed", sizeof(Number), type);
    append(compressed, static_cast<std::uint32_t>(packed.size()));
    append(compressed, static_cast<std::uint32_t>(columns.size()));
    EXPECT_EQ(centers(load("a.pcd", text).scene), points) << name;
    EXPECT_EQ(centers(load("a.pcd", binary).scene), points) << name;
    EXPECT_EQ(centers(load("a.pcd", compressed + packed).scene), points) << name;
  };
  check(double{}, 'F', {{1.1, 2.2, 3.3}, {-4, 5, 6}});
  check(float{}, 'F', {{1.5, 2.25, 3.125}, {-4, 5, 6}});
  check(std::int8_t{}, 'I', {{-1, 2, 3}, {4, -5, 127}});
  check(std::uint8_t{}, 'U', {{1, 200, 3}, {4, 5, 255}});
  check(std::int16_t{}, 'I', {{-300, 2, 3}, {4, -5, 32767}});
  check(std::uint16_t{}, 'U', {{1, 40000, 3}, {4, 5, 65535}});
  check(std::int32_t{}, 'I', {{-70000, 2, 3}, {4, -5, 2147483647}});
  check(std::uint32_t{}, 'U', {{1, 3000000000, 3}, {4, 5, 4294967295}});
}

// A run that reaches back further than a byte tells, and one longer than the three bits of its first byte.
TEST(IntakePcd, LongRunsAreUnpackedFromFarBack) {
  std::string plain;
  for (int i = 0; i < 600; ++i) {
    for (const float number : {static_cast<float>(i), static_cast<float>(i * i + 1), 0.5F}) append(plain, number);
  }
  std::string columns;
  for (int copy = 0; copy < 2; ++copy) columns += plain;
  std::string packed;
  for (std::size_t at = 0; at < plain.size(); at += 32) {
    const std::string piece = plain.substr(at, 32);
    packed += static_cast<char>(piece.size() - 1);
    packed += piece;
  }
  // The other half: from 7200 back, which takes all thirteen bits, and 264 at a time.
  const auto repeat = [&](std::size_t length) {
    constexpr std::size_t kBack = 7200 - 1;
    packed += static_cast<char>(std::min<std::size_t>(length - 2, 7) << 5 | kBack >> 8);
    if (length >= 9) packed += static_cast<char>(length - 9);
    packed += static_cast<char>(kBack & 0xff);
  };
  for (int i = 0; i < 27; ++i) repeat(264);
  repeat(64);
  repeat(8);
  std::string text = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nPOINTS 1200\nDATA binary_compressed\n";
  append(text, static_cast<std::uint32_t>(packed.size()));
  append(text, static_cast<std::uint32_t>(columns.size()));
  const std::vector<Vec3> points = centers(load("a.pcd", text + packed).scene);
  ASSERT_EQ(points.size(), 1200u);
  const auto number = [&](std::size_t index) {
    float value = 0;
    std::memcpy(&value, columns.data() + 4 * index, 4);
    return static_cast<double>(value);
  };
  for (std::size_t i = 0; i < 1200; ++i) ASSERT_EQ(points[i], Vec3(number(i), number(1200 + i), number(2400 + i))) << i;
}

TEST(IntakeXyz, ThreeNumbersALineInTheirOrderAndTheRestIsPassedOver) {
  const std::string text = "# x y z intensity\n1 2 3 0.5\n\n-4 5.5 6 9 9 9\n";
  EXPECT_EQ(centers(load("a.xyz", text).scene), (std::vector<Vec3>{{1, 2, 3}, {-4, 5.5, 6}}));
  EXPECT_EQ(complaint("a.xyz", "1 2 3\n1 2\n"), "a.xyz: line 2: a point takes three coordinates. Nothing was loaded.");
}

// The unit is that of the places; a radius is in metres already.
TEST(IntakeXyz, UnitAndUpPlaceACloudAndNotItsRadius) {
  const SceneObject cloud =
      load("a.xyz", "1 2 3\n4 5 6\n", {.unit_m = 0.5, .up = 'y', .radius_m = 0.125}).scene.objects.at(0);
  const Sphere second = std::get<Sphere>(cloud.shape.primitives.at(1));
  EXPECT_LT((cloud.pose.rotation * second.center + cloud.pose.position - Vec3(2, -3, 2.5)).norm(), 1e-15);
  EXPECT_EQ(second.radius_m, 0.125);
}

// Bit 0 of a child's number is x, bit 1 y, bit 2 z.
TEST(IntakeOctomap, EachOfTheEightChildrenHasItsOwnCorner) {
  const double octant = 32768 * 0.5;
  for (unsigned child = 0; child < 8; ++child) {
    std::string tree;
    append(tree, static_cast<std::uint16_t>(2u << 2 * child));
    const Box box = std::get<Box>(load("a.bt", octomap(tree)).scene.objects.at(0).shape.primitives.at(0));
    const Vec3 side(child & 1 ? 1 : -1, child & 2 ? 1 : -1, child & 4 ? 1 : -1);
    EXPECT_EQ(box.center, octant / 2 * side) << child;
    EXPECT_EQ(box.half_m, Vec3::Constant(octant / 2)) << child;
  }
}

// Down through children 2, 4 and 3: each level halves and goes its own way. The branches of two inner children follow each
// other, the lower number first.
TEST(IntakeOctomap, APathThroughUnlikeChildrenEndsWhereItShould) {
  std::string tree;
  append(tree, static_cast<std::uint16_t>(3u << 4 | 3u << 12));  // 2 and 6 have children
  append(tree, static_cast<std::uint16_t>(3u << 8));             // of 2: 4
  append(tree, static_cast<std::uint16_t>(2u << 6));             // of 4: 3
  append(tree, static_cast<std::uint16_t>(2u << 10));            // of 6: 5
  const Scene scene = load("a.bt", octomap(tree)).scene;
  const auto& boxes = scene.objects.at(0).shape.primitives;
  ASSERT_EQ(boxes.size(), 2u);
  const double octant = 32768 * 0.5;
  EXPECT_EQ(std::get<Box>(boxes[0]).center, octant * Vec3(-1 + 0.25 + 0.125, 0.25 + 0.125, -0.5 + 0.125));
  EXPECT_EQ(std::get<Box>(boxes[0]).half_m, Vec3::Constant(octant / 8));
  EXPECT_EQ(std::get<Box>(boxes[1]).center, octant * Vec3(-0.5 + 0.25, 0.25, 0.5 + 0.25));
  EXPECT_EQ(std::get<Box>(boxes[1]).half_m, Vec3::Constant(octant / 4));
}

TEST(IntakeBoxTable, EveryColumnIsTakenForWhatItsHeadingSays) {
  const auto only = [](std::string_view text) { return load("t.csv", text).scene.objects.at(0); };
  const auto half = [](const SceneObject& object) { return std::get<Box>(object.shape.primitives.at(0)).half_m; };
  // (2, 4, 5, 6) / 9 is a unit quaternion with four unlike parts.
  const SceneObject turned = only(
      "qz,sz,x,qw,sy,y,qx,sx,z,qy,object\n0.6666666666666666,6,1,0.2222222222222222,4,2,0.4444444444444444,2,3,0."
      "5555555555555556,crate\n");
  EXPECT_EQ(turned.name, "t/crate");
  EXPECT_EQ(turned.pose.position, Vec3(1, 2, 3));
  EXPECT_EQ(half(turned), Vec3(1, 2, 3));
  const Quat& q = turned.pose.rotation;
  EXPECT_LT((Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()) - Eigen::Vector4d(2, 4, 5, 6) / 9).norm(), 1e-15);
  for (const char* heading : {"cx,cy,cz,size_x,size_y,size_z", "x,y,z,dx,dy,dz"}) {
    const SceneObject other = only(std::string(heading) + "\n-1,2,-3,2,4,6\n+5,5,5,1,1,1\n");
    EXPECT_EQ(other.pose.position, Vec3(-1, 2, -3)) << heading;
    EXPECT_EQ(half(other), Vec3(1, 2, 3)) << heading;
    EXPECT_EQ(other.name, "t/box_0");
    EXPECT_EQ(load("t.csv", std::string(heading) + "\n-1,2,-3,2,4,6\n+5,5,5,1,1,1\n").scene.objects.at(1).name,
              "t/box_1");
  }
  for (const char* heading : {"max_z,min_x,max_x,min_y,max_y,min_z", "zmax,xmin,xmax,ymin,ymax,zmin"}) {
    const SceneObject other = only(std::string(heading) + "\n9,-1,3,2,10,3\n");
    EXPECT_EQ(other.pose.position, Vec3(1, 6, 6)) << heading;
    EXPECT_EQ(half(other), Vec3(2, 4, 3)) << heading;
  }
  EXPECT_EQ(complaint("t.csv", "x,y,z,sx,sy,sz,qw,qx,qy,qz\n1,2,3,4,5,6,1,0,0,0.01\n"),
            "t.csv: line 2: quaternion norm 1.0000499987500624, allowed 1 +- 1e-06. Nothing was loaded.");
}

}  // namespace
}  // namespace collided::engine
