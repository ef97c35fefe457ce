// `collide convert --tiles`, as its users run it.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <string>

#include "tests/files/files_program.hpp"

namespace {

namespace fs = std::filesystem;
using collided::test::Files;
using collided::test::FilesRan;
using collided::test::kCube;

class FilesTiles : public Files {
 protected:
  std::string out(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  /// Squares side by side, of a metre each.
  std::string row_of(int squares) const {
    std::string text;
    for (int i = 0; i <= squares; ++i) text += "v " + std::to_string(i) + " 0 0\nv " + std::to_string(i) + " 1 0\n";
    for (int i = 1; i <= squares; ++i) {
      const auto at = [&](int corner) { return std::to_string(2 * i - 1 + corner) + " "; };
      text += "f " + at(0) + at(2) + at(3) + "\nf " + at(0) + at(3) + at(1) + "\n";
    }
    return write("row.obj", text);
  }
};

TEST_F(FilesTiles, AMeshIsCutAndComesBackWhole) {
  const std::string row = row_of(100);
  const FilesRan ran = run("convert " + row + " " + out("row.ctiles") + " --tiles 10m");
  EXPECT_EQ(ran.code, 0) << ran.text;
  EXPECT_NE(ran.text.find("  tiles    10 of at most 20 triangles, "), std::string::npos) << ran.text;
  EXPECT_EQ(run("check " + out("row.ctiles")).text.find("row  1 part, 200 triangles, 0 objects"), 0u);
  EXPECT_EQ(run("convert " + out("row.ctiles") + " " + out("back.cscene") + " --no-index").code, 0);
  EXPECT_EQ(run("convert " + row + " " + out("straight.cscene") + " --no-index").code, 0);
  EXPECT_EQ(run("triangles " + out("back.cscene")).text, run("triangles " + out("straight.cscene")).text);
}

TEST_F(FilesTiles, WhatDoesNotGoTogetherIsSaidBeforeAnythingIsRead) {
  const std::string cube = write("cube.obj", kCube);
  const auto complaint = [&](const std::string& words) {
    const FilesRan ran = run("convert " + cube + " " + words);
    EXPECT_EQ(ran.code, 2) << ran.text;
    EXPECT_EQ(file_count(), 1u) << "something was left behind";
    return ran.text;
  };
  EXPECT_NE(complaint(out("cube.cscene") + " --tiles 1m").find("--tiles writes a .ctiles file"), std::string::npos);
  EXPECT_NE(complaint(out("cube.ctiles")).find("of which size? --tiles 100m, or --tiles auto"), std::string::npos);
  EXPECT_NE(complaint(out("cube.ctiles") + " --tiles 0m").find("a length above 0 is needed"), std::string::npos);
  EXPECT_NE(complaint(out("cube.ctiles") + " --tiles many").find("a length above 0 is needed"), std::string::npos);
  EXPECT_NE(complaint(out("cube.ctiles") + " --tiles auto --levels").find("are for .cscene files"), std::string::npos);
}

TEST_F(FilesTiles, ObjectsAreNotCut) {
  const std::string table = write("cell.csv", "name,x,y,z,sx,sy,sz\ncrate,0,0,0,1,1,1\n");
  const FilesRan ran = run("convert " + table + " " + out("cell.ctiles") + " --tiles auto");
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.text.find("only meshes are cut into tiles, and it has 1 object. Nothing was written."),
            std::string::npos)
      << ran.text;
}

// A disk that is full, as a limit on the size of files: 64 blocks of 512 bytes.
TEST_F(FilesTiles, AFullDiskLeavesWhatWasThere) {
  const std::string row = row_of(2'000);
  const std::string before = write("row.ctiles", "what was there");
  const std::string words = "convert " + row + " " + before + " --tiles 10m";
  const std::string limited =
      "sh -c \"ulimit -f 64; trap '' XFSZ; exec " + std::string(COLLIDED_FILES_BUILT) + " " + words + "\" 2>&1";
  std::FILE* pipe = ::popen(limited.c_str(), "r");
  std::string said;
  std::array<char, 4096> piece{};
  for (std::size_t got = 0; (got = std::fread(piece.data(), 1, piece.size(), pipe)) > 0;)
    said.append(piece.data(), got);
  EXPECT_EQ(WEXITSTATUS(::pclose(pipe)), 2);
  EXPECT_NE(said.find("File too large. Nothing was written."), std::string::npos) << said;
  EXPECT_EQ(file_count(), 2u);
  EXPECT_EQ(fs::file_size(before), 14u);
}

}  // namespace
