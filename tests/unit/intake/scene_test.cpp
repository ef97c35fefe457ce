#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

using test::complaint;
using test::load;

constexpr const char* kTriangle = "v 1 2 3\nv 4 5 6\nv 7 8 10\nf 1 2 3\n";

TEST(IntakeScene, UnitsAndAxesAreTurnedToMetresWithZUp) {
  EXPECT_EQ(load("a.obj", kTriangle).scene.mesh.vertices[0], Vec3(1, 2, 3));
  EXPECT_EQ(load("a.obj", kTriangle, {.unit_m = 0.5}).scene.mesh.vertices[0], Vec3(0.5, 1, 1.5));
  EXPECT_EQ(load("a.obj", kTriangle, {.up = 'y'}).scene.mesh.vertices[0], Vec3(1, -3, 2));
}

/// Where a point of an object is in the world.
Vec3 placed(const SceneObject& object, const Vec3& point) {
  return object.pose.position + object.pose.rotation * point;
}

// An object that is turned already: the up axis is the world's, not its own.
TEST(IntakeScene, UpTurnsATurnedObjectAboutTheWorldsAxes) {
  const std::string table = "x,y,z,sx,sy,sz,qw,qx,qy,qz\n1,2,3,2,4,6,0.5,0.1,0.7,0.5\n";
  const SceneObject as_told = load("t.csv", table, {.up = 'z'}).scene.objects.at(0);
  const SceneObject turned = load("t.csv", table, {.unit_m = 0.25, .up = 'y'}).scene.objects.at(0);
  EXPECT_EQ(turned.pose.position, Vec3(0.25, -0.75, 0.5));
  EXPECT_EQ(std::get<Box>(turned.shape.primitives.at(0)).half_m, Vec3(0.25, 0.5, 0.75));
  for (const Vec3& corner : {Vec3(1, 2, 3), Vec3(-1, 2, 3), Vec3(1, -2, 3), Vec3(1, 2, -3)}) {
    const Vec3 there = placed(as_told, corner);
    EXPECT_LT((placed(turned, 0.25 * corner) - 0.25 * Vec3(there[0], -there[2], there[1])).norm(), 1e-15);
  }
}

// Its links stand turned to each other; each turns about the world's x and none about its own.
TEST(IntakeScene, UpAndUnitPlaceEachLinkOfARobot) {
  const std::string robot =
      R"(<robot name="r"><link name="a"><collision><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/>
    <geometry><box size="2 4 6"/></geometry></collision></link><link name="b"><collision><origin xyz="0.5 0 0"/>
    <geometry><cylinder radius="0.25" length="4"/></geometry></collision></link>
    <joint name="j" type="fixed"><origin xyz="7 8 9" rpy="0 1.5707963267948966 0"/><parent link="a"/><child link="b"/></joint></robot>)";
  const auto links = load("r.urdf", robot, {.unit_m = 0.5, .up = 'y'}).scene.objects;
  ASSERT_EQ(links.size(), 2u);
  const Box box = std::get<Box>(links[0].shape.primitives.at(0));
  EXPECT_EQ(box.half_m, Vec3(0.5, 1, 1.5));
  EXPECT_LT((placed(links[0], box.center) - Vec3(0.5, -1.5, 1)).norm(), 1e-15);
  const Cylinder rod = std::get<Cylinder>(links[1].shape.primitives.at(0));
  EXPECT_EQ(rod.radius_m, 0.125);
  // (7, 8, 9) and half a metre along -z, where its x points; its z points along x. Then (x, y, z) -> (x, -z, y) / 2.
  EXPECT_LT((placed(links[1], rod.a) - Vec3(7 - 2, -8.5, 8) / 2).norm(), 1e-15);
  EXPECT_LT((placed(links[1], rod.b) - Vec3(7 + 2, -8.5, 8) / 2).norm(), 1e-15);
}

TEST(IntakeScene, BadOptionsAreRefusedWithTheirValue) {
  EXPECT_EQ(complaint("a.obj", kTriangle, {.unit_m = -1}),
            "a.obj: unit of -1 m, allowed are finite lengths above 0. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", kTriangle, {.up = 'w'}),
            "a.obj: up axis 'w', allowed are 'y' and 'z'. Nothing was loaded.");
  EXPECT_EQ(complaint("a.obj", "v 1e308 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", {.unit_m = 10}),
            "a.obj: a coordinate times 10 m is too large for a double. Nothing was loaded.");
}

TEST(IntakeScene, OdditiesAreCountedAndKept) {
  const test::Loaded loaded =
      load("o.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 1 0 0\nf 1 2 3\nf 3 5 1\nf 1 2 4\nf 1 1 1\n");
  EXPECT_EQ(loaded.scene.mesh.triangles.size(), 4u);
  ASSERT_EQ(loaded.report.warnings.size(), 3u);
  EXPECT_EQ(loaded.report.warnings[0].substr(0, 24), "2 triangles without area");
  EXPECT_EQ(loaded.report.warnings[1].substr(0, 22), "1 triangles with the t");
  EXPECT_EQ(loaded.report.warnings[2].substr(0, 10), "1 vertices");
}

TEST(IntakeScene, ProgressRisesToOneAndCancellingEndsTheLoad) {
  std::string text;
  for (int i = 0; i < 200'000; ++i) { text += "v " + std::to_string(i) + " 0 0.125\n"; }
  for (int i = 3; i < 200'000; ++i) { text += "f -1 -2 -3\n"; }
  double last = -1;
  int calls = 0;
  LoadOptions options{.progress = [&](double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
    ++calls;
  }};
  load("p.obj", text, options);
  EXPECT_EQ(last, 1);
  // How often it is called and asked depends on the threads, but not less than this.
  EXPECT_GE(calls, 4);
  for (int stop = 0; stop < 4; ++stop) {
    int asked = 0;
    const std::string said = complaint("p.obj", text, {.cancelled = [&] { return asked++ >= stop; }});
    ASSERT_EQ(said.substr(0, 21), "p.obj: cancelled afte") << stop;
    ASSERT_EQ(said.substr(said.size() - 19), "Nothing was loaded.");
  }
}

TEST(IntakeScene, EndingsMayBeWrittenLarge) { EXPECT_EQ(load("A.OBJ", kTriangle).scene.name, "A"); }

TEST(IntakeScene, ByteOrderMarksAreSteppedOverOrNamed) {
  EXPECT_EQ(load("a.obj", std::string("\xef\xbb\xbf") + kTriangle).scene.mesh.triangles.size(), 1u);
  EXPECT_EQ(complaint("a.obj", std::string_view("\xff\xfev\0 \0", 6)),
            "a.obj: the text is UTF-16; write it as UTF-8 or ASCII. Nothing was loaded.");
}

class IntakeFiles : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = std::filesystem::temp_directory_path() / ("intake_files_" + std::to_string(::getpid()));
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    return (directory_ / name).string();
  }
  std::string file_complaint(const std::string& path, const LoadOptions& options = {}) const {
    LoadReport report;
    try {
      load_scene(path, options, report);
    } catch (const LoadError& error) { return error.what(); }
    return "loaded";
  }

  std::filesystem::path directory_;
};

TEST_F(IntakeFiles, ASceneIsNamedAfterItsFileAndTimed) {
  LoadReport report;
  EXPECT_EQ(load_scene(file("my hall.obj", kTriangle), {}, report).parts.at(0).name, "my hall");
  EXPECT_GT(report.seconds, 0);
}

TEST_F(IntakeFiles, WhatIsNoReadableFileIsNamed) {
  EXPECT_NE(file_complaint("/nowhere/a.obj").find("/nowhere/a.obj: cannot be opened: "), std::string::npos);
  std::filesystem::create_directory(directory_ / "d.obj");
  EXPECT_NE(file_complaint((directory_ / "d.obj").string()).find("is a directory, a file is needed"),
            std::string::npos);
  EXPECT_EQ(file_complaint(file("e.obj", "")), "e.obj: the file is empty. Nothing was loaded.");
  EXPECT_EQ(file_complaint(file("b.obj", kTriangle), {.max_file_bytes = 10}),
            "b.obj: 33 bytes, limit 10. Nothing was loaded.");
  EXPECT_NE(file_complaint("/dev/null.obj"), "loaded");
}

}  // namespace
}  // namespace collided::engine
