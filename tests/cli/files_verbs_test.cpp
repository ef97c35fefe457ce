// The verbs that a sibling program answers: it gets the words as they were typed, and its code is ours.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

/// Runs the words with a program in its place that keeps its own words, one a line, and ends with this code.
class FilesVerbs : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().connect_error = Error{ErrorCode::no_server, "nobody", ""};
    std::filesystem::permissions(program_.path(), std::filesystem::perms::owner_all);
  }
  std::string words_of(const std::string& words) {
    ran_ = collide(words, {.environment = {{"COLLIDED_FILES", program_.path()}}});
    std::ifstream in(program_.path() + ".words");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  ScratchFile program_{"files", "#!/bin/sh\nprintf '%s\\n' \"$@\" >\"$0.words\"\nexit 4\n"};
  Ran ran_;
};

TEST_F(FilesVerbs, PassTheirWordsOnAsTheyAre) {
  EXPECT_EQ(words_of("check a.obj --json --help --no-such-option"), "check\na.obj\n--json\n--help\n--no-such-option\n");
  EXPECT_EQ(ran_.code, 4);
  EXPECT_EQ(ran_.err, "");
  EXPECT_EQ(words_of("convert a.ply b.cscene --shift -1 -q"), "convert\na.ply\nb.cscene\n--shift=-1\n-q\n");
  EXPECT_EQ(ran_.code, 4);
  EXPECT_EQ(words_of("implicit 'x^2 - 1' -1 -2 5  0 0 -1 --json"), "implicit\nx^2 - 1\n-1\n-2\n5\n0\n0\n-1\n--json\n");
  EXPECT_EQ(ran_.code, 4);
}

TEST_F(FilesVerbs, SayWhichProgramIsMissing) {
  const Ran ran = collide("check a.obj", {.environment = {{"COLLIDED_FILES", program_.path() + ".missing"}}});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("error: check: the program collided-files was not found"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("it is installed with collide; COLLIDED_FILES may name it"), std::string::npos) << ran.err;
}

TEST_F(FilesVerbs, SayWhatEndedIt) {
  std::ofstream(program_.path()) << "#!/bin/sh\nkill -TERM $$\n";
  words_of("check a.obj");
  EXPECT_EQ(ran_.err, "error: collided-files was ended by signal 15\n");
  std::ofstream(program_.path()) << "#!/bin/sh\nkill -INT $$\n";
  words_of("check a.obj");
  EXPECT_EQ(ran_.code, 130);
  EXPECT_EQ(ran_.err, "");
}

/// `add` with a program that prints this in place of reading a file.
class FilesShapes : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().command = [this](const std::string&, const nlohmann::json&,
                                    const Shape& shape) -> Result<std::string> {
      shape_ = shape;
      return nlohmann::json{{"name", "part"}, {"id", 7}, {"version", 2}}.dump();
    };
    std::filesystem::permissions(program_.path(), std::filesystem::perms::owner_all);
  }
  Ran add(const std::string& shape, const std::string& printed) {
    std::ofstream(program_.path()) << "#!/bin/sh\nprintf '%s\\n' \"$@\" >\"$0.words\"\n" << printed << "\n";
    return collide("add part " + shape, {.environment = {{"COLLIDED_FILES", program_.path()}}});
  }
  static constexpr const char* kTetrahedron =
      "printf 'v 0 0 0\\nv 1 0 0\\nv 0 1e-3 0\\nv 0 0 -2.5\\nt 0 1 2\\nt 0 1 3\\nt 0 2 3\\nt 1 2 3\\n'";
  ScratchFile program_{"shapes", ""};
  Shape shape_;
};

TEST_F(FilesShapes, AMeshIsTheFilesTriangles) {
  for (const char* shape : {"mesh part.stl", "mesh:part.stl"}) {
    const Ran ran = add(shape, kTetrahedron);
    ASSERT_EQ(ran.code, 0) << ran.err;
    ASSERT_EQ(shape_.size(), 1U);
    const auto* mesh = std::get_if<MeshShape>(&shape_[0]);
    ASSERT_NE(mesh, nullptr);
    ASSERT_EQ(mesh->vertices.size(), 4U);
    EXPECT_EQ(mesh->vertices[2], Eigen::Vector3d(0, 1e-3, 0));
    EXPECT_EQ(mesh->vertices[3], Eigen::Vector3d(0, 0, -2.5));
    ASSERT_EQ(mesh->triangles.size(), 4U);
    EXPECT_EQ(mesh->triangles[3], (std::array<std::uint32_t, 3>{1, 2, 3}));
    std::ifstream in(program_.path() + ".words");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "triangles\npart.stl\n");
  }
}

TEST_F(FilesShapes, AHullIsOfTheFilesPoints) {
  ASSERT_EQ(add("hull:part.stl", kTetrahedron).code, 0);
  ASSERT_EQ(shape_.size(), 1U);
  const auto* hull = std::get_if<HullShape>(&shape_[0]);
  ASSERT_NE(hull, nullptr);
  EXPECT_EQ(hull->points.size(), 4U);
}

TEST_F(FilesShapes, UnitAndUpGoToTheProgramThatReads) {
  ASSERT_EQ(add("mesh part.stl --unit mm --up y", kTetrahedron).code, 0);
  std::ifstream in(program_.path() + ".words");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "triangles\npart.stl\n--unit\nmm\n--up\ny\n");
  EXPECT_EQ(add("sphere 1 --unit mm", kTetrahedron).err,
            "error: add: --unit and --up are for mesh FILE and hull FILE\n");
}

TEST_F(FilesShapes, APublisherTakesThemToo) {
  std::ofstream(program_.path()) << "#!/bin/sh\n" << kTetrahedron << "\n";
  const Ran ran = collide("publish --waypoints '0,0,1 1,0,1' --speed 100m/s --shape hull:part.stl",
                          {.environment = {{"COLLIDED_FILES", program_.path()}}});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(std::holds_alternative<HullShape>(fake::server().publishers.back().objects.at(1).shape[0]));
}

// One error, from the program that read the file, and not a second one that says nothing more.
TEST_F(FilesShapes, AFailureIsSaidOnce) {
  const Ran failed = add("mesh part.stl", "echo 'error: part.stl: no triangles' >&2; exit 2");
  EXPECT_EQ(failed.code, 2);
  EXPECT_EQ(failed.err, "error: add: part.stl: no triangles\n");
  const Ran warned = add("mesh part.stl", std::string("echo 'warning: a part is left out' >&2; ") + kTetrahedron);
  EXPECT_EQ(warned.code, 0);
  EXPECT_EQ(warned.err, "warning: a part is left out\n");
}

TEST_F(FilesShapes, WhatIsNotReadIsNotAdded) {
  EXPECT_EQ(add("mesh part.stl", "exit 2").code, 2);
  EXPECT_EQ(add("mesh part.stl", "kill -TERM $$").code, 5);
  EXPECT_EQ(add("mesh part.stl", "echo 'v 1 2'").code, 5);
  EXPECT_EQ(add("mesh part.stl 3", kTetrahedron).code, 2);
  EXPECT_TRUE(shape_.empty());
}

}  // namespace
}  // namespace collided
