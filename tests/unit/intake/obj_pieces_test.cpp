#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/oracle/seed.hpp"
#include "tests/unit/intake/loading.hpp"

// An OBJ file is copied piece by piece, as its chunks are cut.
namespace collided::engine {
namespace {

using test::load;

class ObjPieces : public testing::Test {
 protected:
  ObjPieces()
      : path_(
            (std::filesystem::temp_directory_path() / fmt::format("collided_obj_pieces_{}.obj", ::getpid())).string()) {
  }
  ~ObjPieces() override { std::filesystem::remove(path_); }

  void write(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }
  std::string complaint(const LoadOptions& options = {}) const {
    LoadReport report;
    try {
      load_scene(path_, options, report);
    } catch (const LoadError& error) { return error.what(); }
    return "loaded";
  }

  const std::string path_;
};

/// Some ten MB: plain lines, lines that backslashes join, and now and then one longer than a chunk.
std::string long_text(std::mt19937_64& random) {
  std::string text = "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  while (text.size() < 10'000'000) {
    switch (random() % 6) {
      case 0: text += "f 1 \\\r\n 2 \\\n 3\n"; break;
      case 1:
        if (random() % 0x8000 == 0) text.append("#").append(5'000'000, 'x').append("\n");
        break;
      case 2: text += fmt::format("o part_{}\n", random() % 3); break;
      default: text += fmt::format("v {} {} {}\nf 1 2 -1\n", random() % 100, random() % 100, 1 + random() % 100);
    }
  }
  return text;
}

TEST_F(ObjPieces, MakeTheSceneThatTheWholeTextMakes) {
  std::mt19937_64 random = oracle::seeded(191);
  std::string text = long_text(random);
  text.append("#").append(5'000'000, 'x').append("\nf 1 2 3");  // ends without a line end, beyond a line of two chunks
  write(text);
  LoadReport report;
  const Scene from_file = load_scene(path_, {}, report);
  const Scene from_text = load(path_, text).scene;
  EXPECT_GT(from_file.mesh.triangles.size(), 100'000u);
  EXPECT_EQ(from_file.mesh.vertices, from_text.mesh.vertices);
  EXPECT_EQ(from_file.mesh.triangles, from_text.mesh.triangles);
  ASSERT_EQ(from_file.parts.size(), from_text.parts.size());
  for (std::size_t i = 0; i < from_file.parts.size(); ++i) EXPECT_EQ(from_file.parts[i].name, from_text.parts[i].name);
}

TEST_F(ObjPieces, ComplaintsNumberTheLinesOfTheFile) {
  std::mt19937_64 random = oracle::seeded(192);
  const std::string text = long_text(random);
  const auto line = 1 + std::count(text.begin(), text.end(), '\n');
  write(text + "v 1 2 broken\n" + text);
  EXPECT_NE(complaint().find(fmt::format("line {}: ", line)), std::string::npos) << complaint();
}

TEST_F(ObjPieces, AFileThatIsCutShortMeanwhileIsRefused) {
  std::mt19937_64 random = oracle::seeded(193);
  const std::string text = long_text(random);
  write(text);
  LoadOptions options;
  options.progress = [&](double) { std::filesystem::resize_file(path_, 100'000); };
  const std::string told = complaint(options);
  EXPECT_NE(told.find(fmt::format("ended at byte 100000 of {} while it was read", text.size())), std::string::npos)
      << told;
}

}  // namespace
}  // namespace collided::engine
