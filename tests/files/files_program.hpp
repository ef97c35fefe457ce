#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace collided::test {

namespace fs = std::filesystem;
using nlohmann::json;

/// What the program said, on both streams, and its exit code.
struct FilesRan {
  std::string text;
  int code = 0;
};

/// The program behind `collide check` and `collide convert`, run as its users run it, in a folder of its own.
class Files : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::path(testing::TempDir()) / "collided_files_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    const fs::path path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
  }

  FilesRan run(const std::string& words) const {
    std::FILE* pipe = ::popen((std::string(COLLIDED_FILES_BUILT) + " " + words + " 2>&1").c_str(), "r");
    FilesRan ran;
    std::array<char, 4096> piece{};
    for (std::size_t got = 0; (got = std::fread(piece.data(), 1, piece.size(), pipe)) > 0;)
      ran.text.append(piece.data(), got);
    ran.code = WEXITSTATUS(::pclose(pipe));
    return ran;
  }

  json checked(const std::string& words) const {
    const FilesRan ran = run("check --json " + words);
    EXPECT_LE(ran.code, 1) << ran.text;
    return json::parse(ran.text);
  }

  fs::path folder_;
};

inline const std::string kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

}  // namespace collided::test
