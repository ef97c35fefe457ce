#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

#include "server/intake/converter.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

namespace fs = std::filesystem;

#ifdef COLLIDED_IMPORT_BUILT
constexpr const char* kConverter = COLLIDED_IMPORT_BUILT;
#else
constexpr const char* kConverter = "";
#endif

constexpr const char* kModels = "/usr/share/assimp/models";

/// A directory of its own for the converter's files, so that what is left behind shows.
class IntakeConverter : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = fs::temp_directory_path() / ("intake_converter_" + std::to_string(::getpid()));
    fs::create_directories(directory_ / "tmp");
    ::setenv("TMPDIR", (directory_ / "tmp").c_str(), 1);
    std::ofstream(directory_ / "thing.abc") << "anything";
  }
  void TearDown() override {
    EXPECT_TRUE(fs::is_empty(directory_ / "tmp")) << "a temporary file was left behind";
    ::unsetenv("TMPDIR");
    ::unsetenv("COLLIDED_IMPORT");
    ::unsetenv("COLLIDED_IMPORT_SECONDS");
    fs::remove_all(directory_);
  }

  /// Lets a shell script stand in for the converter; $1 is the input, $2 the output.
  void use_script(const std::string& lines) {
    const fs::path script = directory_ / "converter";
    std::ofstream(script) << "#!/bin/sh\n" << lines;
    fs::permissions(script, fs::perms::owner_all);
    ::setenv("COLLIDED_IMPORT", script.c_str(), 1);
  }
  std::string thing_complaint(const LoadOptions& options = {}) const {
    LoadReport report;
    try {
      load_scene((directory_ / "thing.abc").string(), options, report);
    } catch (const LoadError& error) { return error.what(); }
    return "loaded";
  }

  fs::path directory_;
};

// A killed process cannot clean up; the next one does, and takes nothing from one that lives or has just begun.
TEST_F(IntakeConverter, WhatAKilledProcessLeftIsSweptAndNothingElse) {
  const fs::path tmp = directory_ / "tmp";
  const auto make = [&](const std::string& name, std::chrono::minutes age) {
    fs::create_directories(tmp / name);
    std::ofstream(tmp / name / "scene.cscene") << "half of it";
    fs::last_write_time(tmp / name, fs::file_time_type::clock::now() - age);
  };
  using std::chrono::minutes;
  make("collided-import-killed", minutes(2));
  make("collided-import-young", minutes(0));
  make("something-else", minutes(2));
  auto live = std::make_unique<TemporaryDirectory>("thing.abc");
  fs::last_write_time(live->path(), fs::file_time_type::clock::now() - minutes(2));
  { const TemporaryDirectory next("thing.abc"); }
  EXPECT_FALSE(fs::exists(tmp / "collided-import-killed"));
  EXPECT_TRUE(fs::exists(live->path())) << "a process has it";
  for (const char* other : {"collided-import-young", "something-else"}) {
    EXPECT_TRUE(fs::exists(tmp / other)) << other;
    fs::remove_all(tmp / other);
  }
}

TEST_F(IntakeConverter, AMissingConverterIsSaid) {
  EXPECT_NE(thing_complaint().find("thing.abc: '.abc' needs the converter collided-import, which is not in "),
            std::string::npos);
  ::setenv("COLLIDED_IMPORT", "/nowhere/converter", 1);
  EXPECT_EQ(
      thing_complaint(),
      "thing.abc: COLLIDED_IMPORT is '/nowhere/converter', which is no program that can be run. Nothing was loaded.");
}

TEST_F(IntakeConverter, WhatItComplainsAboutIsPassedOn) {
  use_script("echo 'bad wall' >&2; exit 3\n");
  EXPECT_EQ(thing_complaint(), "thing.abc: the converter failed with code 3: bad wall. Nothing was loaded.");
  use_script("kill -9 $$\n");
  EXPECT_EQ(thing_complaint(), "thing.abc: the converter was ended by signal 9. Nothing was loaded.");
  use_script("exit 0\n");
  EXPECT_EQ(thing_complaint(), "thing.abc: the converter ended well and wrote nothing. Nothing was loaded.");
  use_script("echo garbage > $2\n");
  EXPECT_EQ(thing_complaint(),
            "thing.abc: not a scene file, or a damaged one: its tables do not check out. Nothing was loaded.");
}

TEST_F(IntakeConverter, WhatItComplainsAboutIsMadeFitForOneLine) {
  use_script("printf 'bad\\000w\\001\\303\\244ll. ..\\nmore\\n' >&2; exit 3\n");
  EXPECT_EQ(thing_complaint(), "thing.abc: the converter failed with code 3: bad?w?\xc3\xa4ll. Nothing was loaded.");
}

TEST_F(IntakeConverter, AFloodOfWordsIsCutAndDoesNotBlock) {
  use_script("yes | head -c 3000000; yes 'no no' | head -c 3000000 >&2; exit 1\n");
  EXPECT_EQ(thing_complaint(), "thing.abc: no no. Nothing was loaded.");
}

TEST_F(IntakeConverter, OneThatTakesTooLongIsEndedWithItsChildren) {
  use_script("sleep 60; echo never\n");
  ::setenv("COLLIDED_IMPORT_SECONDS", "1", 1);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(thing_complaint(),
            "thing.abc: the converter needed more than 1 s and was ended; COLLIDED_IMPORT_SECONDS allows more. Nothing "
            "was loaded.");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST_F(IntakeConverter, CancellingEndsIt) {
  use_script("sleep 60\n");
  int asked = 0;
  EXPECT_EQ(thing_complaint({.cancelled = [&] { return asked++ > 2; }}),
            "thing.abc: cancelled while it was converted. Nothing was loaded.");
}

class IntakeConverted : public IntakeConverter {
 protected:
  void SetUp() override {
    IntakeConverter::SetUp();
    if (*kConverter == '\0' || !fs::exists(kModels)) {
      GTEST_SKIP() << "needs the converter and the package assimp-testmodels";
    }
    ::setenv("COLLIDED_IMPORT", kConverter, 1);
  }
  Scene model(const std::string& path, const LoadOptions& options = {}) {
    return load_scene(std::string(kModels) + "/" + path, options, report_);
  }

  LoadReport report_;
};

// The building is 12 m by 10 m on a plot, and 6.3 m high; IFC has z up, and Assimp returns it lying on its side.
TEST_F(IntakeConverted, TheHouseHasAllItsTrianglesAndStandsUpright) {
  const Scene house = model("IFC/AC14-FZK-Haus.ifc");
  EXPECT_EQ(house.mesh.triangles.size(), 35906u);
  EXPECT_EQ(house.parts.size(), 110u);
  EXPECT_EQ(house.parts[0].name.substr(0, 22), "AC14-FZK-Haus/IfcSite_");
  EXPECT_EQ(report_.placed.at(0), "lengths are in metres, as IFC says");
  EXPECT_EQ(report_.placed.at(1), "z is up, as IFC says");
  const Aabb box = examine(house.mesh).bounds;
  EXPECT_NEAR(box.low[2], -1, 1e-6);
  EXPECT_NEAR(box.high[2], 6.31769, 1e-5);
  const Aabb turned = examine(model("IFC/AC14-FZK-Haus.ifc", {.up = 'y'}).mesh).bounds;
  EXPECT_EQ(turned.low[2], box.low[1]);
  EXPECT_EQ(turned.high[1], -box.low[2]);
}

// Nothing is left of the angle that Assimp takes for a quarter turn: what is level in the file is level here.
TEST_F(IntakeConverted, TheHouseIsTurnedBackToTheLastBit) {
  const Scene house = model("IFC/AC14-FZK-Haus.ifc");
  const auto level = [&](double height) {
    std::size_t count = 0;
    for (const Vec3& vertex : house.mesh.vertices) { count += vertex[2] == height ? 1 : 0; }
    return count;
  };
  EXPECT_GT(level(0), 100u);
  EXPECT_GT(level(-1), 10u);
}

// FBX names its axis in the file, 3DS has z up by definition.
TEST_F(IntakeConverted, OtherFormatsStandUprightToo) {
  model("3DS/fels.3ds");
  EXPECT_EQ(report_.placed.at(0), "z is up, as 3DS says");
  report_ = {};
  model("FBX/spider.fbx");
  EXPECT_EQ(report_.placed.at(0), "y is up and turned to z, as FBX says");
}

TEST_F(IntakeConverted, LimitsAndComplaintsReachTheUser) {
  const auto said = [&](const std::string& path, const LoadOptions& options) -> std::string {
    try {
      model(path, options);
    } catch (const LoadError& error) { return error.what(); }
    return "loaded";
  };
  EXPECT_EQ(said("IFC/AC14-FZK-Haus.ifc", {.max_triangles = 1000}),
            "AC14-FZK-Haus.ifc: more than 1000 triangles. Nothing was loaded.");
  EXPECT_EQ(said("IFC/AC14-FZK-Haus.ifc", {.max_file_bytes = 1000}),
            "AC14-FZK-Haus.ifc: 4065749 bytes, limit 1000. Nothing was loaded.");
  EXPECT_NE(said("invalid/emptyIrrMesh.xml", {}).find("it is not a readable .xml file (Assimp: "), std::string::npos);
}

// Assimp reads IFC2x3 alone; on IFC4 it complains of a type or is ended by a signal.
TEST_F(IntakeConverted, AnIfcFileOfAnotherSchemaIsRefusedByItsName) {
  for (const char* schema : {"IFC4", "IFC4X3_ADD2"}) {
    const fs::path file = directory_ / "house.ifc";
    std::ofstream(file)
        << "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
        << "FILE_SCHEMA(('" << schema << "'));\nENDSEC;\nDATA;\n"
        << "#1=IFCPROJECT('0YvctVUKr0kugbFTf53O9L',$,'p',$,$,$,$,$,$);\nENDSEC;\nEND-ISO-10303-21;\n";
    LoadReport report;
    std::string said = "loaded";
    try {
      load_scene(file.string(), {}, report);
    } catch (const LoadError& error) { said = error.what(); }
    EXPECT_EQ(said, std::string("house.ifc: its schema is '") + schema +
                        "', which is not read yet; IFC2x3 is. Export it as IFC2x3. Nothing was loaded.");
  }
}

class IntakeForeign : public IntakeConverter {
 protected:
  void SetUp() override {
    IntakeConverter::SetUp();
    if (*kConverter == '\0') GTEST_SKIP() << "needs the converter";
    ::setenv("COLLIDED_IMPORT", kConverter, 1);
  }
  Scene foreign(const std::string& name, const std::string& text, LoadOptions options = {}) {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    options.is_foreign = true;
    report_ = {};
    return load_scene((directory_ / name).string(), options, report_);
  }

  LoadReport report_;
};

// A file of foreign bytes is what it is at home: each option counts, and counts once.
TEST_F(IntakeForeign, OptionsReachTheProcessThatReadsAndCountOnce) {
  const Scene scene =
      foreign("a.obj", "v 1 2 3\nv 4 5 6\nv 7 8 10\nf 1 2 3\n", {.name = "hall", .unit_m = 0.25, .up = 'y'});
  EXPECT_EQ(scene.mesh.vertices, (std::vector<Vec3>{{0.25, -0.75, 0.5}, {1, -1.5, 1.25}, {1.75, -2.5, 2}}));
  EXPECT_EQ(scene.name, "hall");
  EXPECT_EQ(scene.parts.at(0).name, "hall");
  EXPECT_EQ(report_.placed.at(0), "a unit of the file is 0.25 m, as asked");
  EXPECT_EQ(report_.placed.at(1), "y is up and turned to z, as asked");
  const SceneObject cloud = foreign("c.xyz", "1 2 3\n", {.unit_m = 2, .radius_m = 0.125}).objects.at(0);
  EXPECT_EQ(std::get<Sphere>(cloud.shape.primitives.at(0)).radius_m, 0.125);
  EXPECT_EQ(std::get<Sphere>(cloud.shape.primitives.at(0)).center, Vec3(2, 4, 6));
  const auto said = [&](const std::string& text, const LoadOptions& options) -> std::string {
    try {
      foreign("b.obj", text, options);
    } catch (const LoadError& error) { return error.what(); }
    return "loaded";
  };
  const std::string two = "v 1 2 3\nv 4 5 6\nv 7 8 10\nf 1 2 3\nf 3 2 1\nf 1 2\n";
  EXPECT_EQ(said(two, {}), "loaded");
  EXPECT_EQ(report_.refused.at(0), "1 faces of fewer than 3 corners left out");
  EXPECT_EQ(said(two, {.max_triangles = 1}), "b.obj: 2 triangles, limit 1. Nothing was loaded.");
  EXPECT_EQ(said(two, {.strict = true}),
            "b.obj: line 6: face of 2 corners, at least 3 are needed. Nothing was loaded.");
}

/// A triangle (0, 0, 1), (1, 0, 1), (1, 1, 1) in COLLADA, below those nodes.
std::string collada(const std::string& nodes, const std::string& up = "Y_UP") {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/><up_axis>)" +
         up + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 1 1 0 1 1 1 1</float_array><technique_common><accessor source="#pa" count="3" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">)" +
         nodes + R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

// As of glTF: a parent that is turned, moved and scaled otherwise along each axis.
TEST_F(IntakeForeign, ATurnedAndUnevenlyScaledParentPlacesItsChildWhole) {
  if (!fs::exists(kModels)) GTEST_SKIP() << "needs Assimp";
  const Scene scene = foreign(
      "a.dae", collada(R"(<node id="parent"><translate>10 20 30</translate><rotate>0 0 1 90</rotate><scale>2 3 5</scale>
<node id="child"><translate>1 2 4</translate><rotate>1 0 0 90</rotate><scale>7 11 13</scale><instance_geometry url="#g"/></node></node>)"),
      {.up = 'z'});
  const auto by_hand = [](double x, double y, double z) {
    return Vec3(10 - 3 * (-13 * z + 2), 20 + 2 * (7 * x + 1), 30 + 5 * (11 * y + 4));
  };
  ASSERT_EQ(scene.mesh.triangles.size(), 1u);
  const Triangle t = scene.mesh.triangle(0);
  constexpr double kSinglePrecision = 1e-4;  // the package's matrices are floats
  EXPECT_LT((t.a - by_hand(0, 0, 1)).norm(), kSinglePrecision) << t.a.transpose();
  EXPECT_LT((t.b - by_hand(1, 0, 1)).norm(), kSinglePrecision) << t.b.transpose();
  EXPECT_LT((t.c - by_hand(1, 1, 1)).norm(), kSinglePrecision) << t.c.transpose();
}

// (1, 2, 4) along the file's axes: what the file calls up is z here, and the turn is one of whole numbers.
TEST_F(IntakeForeign, ColladaIsTurnedAsItsUpAxisSays) {
  if (!fs::exists(kModels)) GTEST_SKIP() << "needs Assimp";
  const auto first = [&](const std::string& up, LoadOptions options = {}) {
    return foreign("a.dae", collada(R"(<node><translate>1 2 3</translate><instance_geometry url="#g"/></node>)", up),
                   std::move(options))
        .mesh.vertices.at(0);
  };
  EXPECT_EQ(first("Z_UP"), Vec3(1, 2, 4));
  EXPECT_EQ(report_.placed, (std::vector<std::string>{"lengths are in metres, as Collada says",
                                                      "the up axis is turned to z, as Collada says",
                                                      "the origin is that of the file"}));
  EXPECT_EQ(first("Y_UP"), Vec3(1, -4, 2));
  EXPECT_EQ(first("X_UP"), Vec3(-2, -4, 1));
  EXPECT_EQ(first("X_UP", {.up = 'z'}), Vec3(1, 2, 4)) << "who names the axis knows better than the file";
  EXPECT_EQ(first("Z_UP", {.up = 'y'}), Vec3(1, -4, 2));
  EXPECT_EQ(report_.placed.at(1), "y is up and turned to z, as asked");
}

TEST_F(IntakeForeign, AMirroredNodeKeepsItsOutside) {
  if (!fs::exists(kModels)) GTEST_SKIP() << "needs Assimp";
  const auto up = [&](const std::string& scales) {
    const Triangle t =
        foreign("a.dae", collada("<node>" + scales + R"(<instance_geometry url="#g"/></node>)"), {.up = 'z'})
            .mesh.triangle(0);
    return (t.b - t.a).cross(t.c - t.a)[2];
  };
  EXPECT_EQ(up("<scale>1 1 1</scale>"), 1);
  EXPECT_EQ(up("<scale>-1 1 1</scale>"), 1) << "it is another picture of the same upper side";
  EXPECT_EQ(up("<scale>-1 1 1</scale><scale>1 -2 1</scale>"), 2);
}

}  // namespace
}  // namespace collided::engine
