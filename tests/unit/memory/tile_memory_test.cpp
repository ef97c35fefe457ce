// What tiles are for: neither cutting a mesh into them nor holding a part of it takes memory for all of it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "server/intake/scene.hpp"
#include "server/intake/streamed_mesh.hpp"
#include "server/intake/tiles/tile_writer.hpp"
#include "server/world/world.hpp"
#include "tests/unit/memory/counting.hpp"

namespace collided::engine {
namespace {

namespace fs = std::filesystem;

/// Cells along a side of the ground; two triangles each. COLLIDED_CELLS for more than the half million of the default run.
std::uint32_t cell_count() {
  const char* asked = std::getenv("COLLIDED_CELLS");
  return asked != nullptr ? static_cast<std::uint32_t>(std::strtoul(asked, nullptr, 10)) : 500;
}

template <class Number>
void put(std::ofstream& file, Number value) {
  file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

/// A ground of a kilometre, row by row, so that the test holds none of it.
void write_ground(const std::string& path, std::uint32_t cells) {
  std::ofstream file(path, std::ios::binary);
  const std::uint64_t points = cells + 1;
  file << fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      points * points, 2 * std::uint64_t{cells} * cells);
  const double step_m = 1'000.0 / cells;
  for (std::uint32_t i = 0; i < points; ++i) {
    for (std::uint32_t k = 0; k < points; ++k) {
      put(file, static_cast<float>(i * step_m - 500));
      put(file, static_cast<float>(k * step_m - 500));
      put(file, static_cast<float>(5 * std::sin(0.05 * i * step_m) * std::cos(0.03 * k * step_m)));
    }
  }
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t k = 0; k < cells; ++k) {
      const auto corner = static_cast<std::int32_t>(i * points + k);
      const auto next = static_cast<std::int32_t>(corner + static_cast<std::int32_t>(points));
      for (const auto& triangle : {std::array{corner, next, next + 1}, std::array{corner, next + 1, corner + 1}}) {
        put(file, std::uint8_t{3});
        for (const std::int32_t at : triangle) put(file, at);
      }
    }
  }
}

class TileMemory : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::path(testing::TempDir()) / "collided_tile_memory_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    scan_ = (folder_ / "ground.ply").string();
    tiles_ = (folder_ / "ground.ctiles").string();
    write_ground(scan_, cell_count());
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// The most that is held while work() runs, beyond what is held before.
  template <class Work>
  static double peak_of(const Work& work) {
    const std::size_t before = test::held_bytes();
    test::most_held_from_now();
    work();
    return static_cast<double>(test::most_held_bytes() - before);
  }
  void convert() const {
    LoadReport report;
    std::optional<StreamedMesh> streamed = stream_mesh(scan_, {}, report);
    ASSERT_TRUE(streamed);
    write_tiles(tiles_, streamed->name, "ground.ply", streamed->parts, *streamed->mesh, {});
  }
  /// Loads and indexes what comes into the box, as a server does.
  double peak_of_loading(const std::optional<Aabb>& within) const {
    return peak_of([&] {
      LoadOptions options;
      options.within = within;
      LoadReport report;
      Scene scene = load_scene(tiles_, options, report);
      const double share = within ? 0.25 : 1;
      const auto triangles = static_cast<double>(scene.mesh.triangles.size());
      EXPECT_NEAR(triangles, share * static_cast<double>(scene.tiles->triangles_of_file), 0.05 * triangles);
      World::index_scene(std::move(scene), {.threads = 1, .progress = {}, .cancelled = {}});
    });
  }

  fs::path folder_;
  std::string scan_;
  std::string tiles_;
};

// Whatever the file's size: blocks of vertices, pieces of faces, a sample of places, and what waits for its tile.
constexpr double kMostToConvert = 80e6;

TEST_F(TileMemory, CuttingHoldsAFewPiecesOfTheFile) {
  const double peak = peak_of([&] { convert(); });
  const double triangles = 2.0 * cell_count() * cell_count();
  std::printf("%.0f triangles: %.1f MB of file, %.1f MB held at the peak\n", triangles,
              static_cast<double>(fs::file_size(scan_)) / 1e6, peak / 1e6);
  EXPECT_LE(peak, kMostToConvert);
  EXPECT_GE(peak, 1e6) << "what was counted is less than one tile";
}

TEST_F(TileMemory, AQuarterTakesAThirdOfTheMemoryAtMost) {
  ASSERT_NO_FATAL_FAILURE(convert());
  Aabb quarter{.low = Vec3::Constant(-1e6), .high = Vec3::Constant(1e6)};
  quarter.high[0] = quarter.high[1] = 2;  // with a margin
  const double part = peak_of_loading(quarter);
  const double whole = peak_of_loading(std::nullopt);
  std::printf("%.1f MB for a quarter, %.1f MB for all: %.2f\n", part / 1e6, whole / 1e6, part / whole);
  EXPECT_LE(part, 0.35 * whole);
}

}  // namespace
}  // namespace collided::engine
