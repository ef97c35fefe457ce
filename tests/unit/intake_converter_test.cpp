#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "server/intake/mesh_health.hpp"
#include "tests/unit/intake_loading.hpp"

namespace collided {
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
    } catch (const LoadError& error) {
      return error.what();
    }
    return "loaded";
  }

  fs::path directory_;
};

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

TEST_F(IntakeConverter, AFloodOfWordsIsCutAndDoesNotBlock) {
  use_script("yes | head -c 3000000; yes 'no no' | head -c 3000000 >&2; exit 1\n");
  EXPECT_EQ(thing_complaint(), "thing.abc: the converter failed with code 1: no no. Nothing was loaded.");
}

TEST_F(IntakeConverter, OneThatTakesTooLongIsEndedWithItsChildren) {
  use_script("sleep 60; echo never\n");
  ::setenv("COLLIDED_IMPORT_SECONDS", "1", 1);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(thing_complaint(), "thing.abc: the converter needed more than 1 s and was ended. Nothing was loaded.");
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

TEST_F(IntakeConverted, TheHouseHasAllItsTrianglesAndStandsYUp) {
  const Scene house = model("IFC/AC14-FZK-Haus.ifc");
  EXPECT_EQ(house.mesh.triangles.size(), 35906u);
  EXPECT_EQ(house.parts.size(), 110u);
  EXPECT_EQ(house.parts[0].name.substr(0, 22), "AC14-FZK-Haus/IfcSite_");
  const Aabb box = examine(house.mesh).bounds;
  EXPECT_NEAR(box.low[1], -1, 1e-6);
  EXPECT_NEAR(box.high[1], 6.31769, 1e-5);
  const Aabb turned = examine(model("IFC/AC14-FZK-Haus.ifc", {.up = 'y'}).mesh).bounds;
  EXPECT_EQ(turned.low[2], box.low[1]);
  EXPECT_EQ(turned.high[1], -box.low[2]);
}

TEST_F(IntakeConverted, LimitsAndComplaintsReachTheUser) {
  const auto said = [&](const std::string& path, const LoadOptions& options) -> std::string {
    try {
      model(path, options);
    } catch (const LoadError& error) {
      return error.what();
    }
    return "loaded";
  };
  EXPECT_EQ(said("IFC/AC14-FZK-Haus.ifc", {.max_triangles = 1000}),
            "AC14-FZK-Haus.ifc: the converter failed with code 1: more than 1000 triangles. Nothing was loaded.");
  EXPECT_EQ(said("IFC/AC14-FZK-Haus.ifc", {.max_file_bytes = 1000}),
            "AC14-FZK-Haus.ifc: 4065749 bytes, limit 1000. Nothing was loaded.");
  EXPECT_NE(said("invalid/emptyIrrMesh.xml", {}).find("Assimp cannot read it"), std::string::npos);
}

}  // namespace
}  // namespace collided
