// A mesh in tiles, beside the same mesh as a whole.
#include "server/intake/tiles/tile_writer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "server/intake/streamed_mesh.hpp"
#include "server/intake/tiles/tile_format.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/mesh_files.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

namespace fs = std::filesystem;

class Tiles : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::path(testing::TempDir()) / "collided_tiles_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// The bytes of the scene's tile file.
  std::string tiled(const Scene& scene, const TilingOptions& options) const {
    HeldMeshSource mesh(scene.mesh);
    write_tiles(path("scene.ctiles"), scene.name, "scene.ply", scene.parts, mesh, options);
    return bytes_of(path("scene.ctiles"));
  }
  static std::string bytes_of(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  fs::path folder_;
};

/// A mesh of some kind in parts of random lengths.
Scene random_scene(std::mt19937_64& random) {
  Scene scene{.name = "yard"};
  switch (random() % 4) {
    case 0: scene.mesh = scenes::terrain(1 + static_cast<std::uint32_t>(random() % 40), 20, random()); break;
    case 1: scene.mesh = scenes::scattered(1 + static_cast<std::uint32_t>(random() % 900), 0.3, random()); break;
    case 2: scene.mesh = scenes::degenerate(1 + static_cast<std::uint32_t>(random() % 900), random()); break;
    default: scene.mesh = scenes::icosphere(3, 5); break;
  }
  const auto count = static_cast<std::uint32_t>(scene.mesh.triangles.size());
  const std::uint32_t most = random() % 2 == 0 ? count : 1 + count / 7;
  for (std::uint32_t first = 0; first < count;) {
    const std::uint32_t next = std::min<std::uint32_t>(count, first + 1 + static_cast<std::uint32_t>(random() % most));
    Part part{.name = "yard/part_" + std::to_string(scene.parts.size()),
              .first_triangle = first,
              .triangle_count = next - first,
              .filter = {.layers = static_cast<std::uint32_t>(random()), .mask = static_cast<std::uint32_t>(random())}};
    if (random() % 3 == 0 && part.triangle_count > 2)
      part.cut.piece_of = std::make_shared<const std::vector<std::uint32_t>>(
          part.triangle_count / 3, static_cast<std::uint32_t>(random() % (part.triangle_count / 2)));
    scene.parts.push_back(part);
    first = next;
  }
  return scene;
}

TilingOptions random_tiling(std::mt19937_64& random) {
  TilingOptions options;
  options.most_triangles = 1 + random() % 300;
  if (random() % 2 == 0) options.size_m = std::exp2(std::uniform_real_distribution(-2.0, 6.0)(random));
  return options;
}

Aabb random_box(std::mt19937_64& random) {
  Aabb box;
  std::uniform_real_distribution<double> place(-6, 6);
  box.extend(Vec3(place(random), place(random), place(random)));
  box.extend(Vec3(place(random), place(random), place(random)));
  if (random() % 4 == 0) box.high[0] = std::numeric_limits<double>::infinity();
  return box;
}

bool is_same(const Vec3& a, const Vec3& b) { return std::memcmp(a.data(), b.data(), sizeof(Vec3)) == 0; }

/// The mesh without vertices that no triangle has: what a tile file keeps of it.
TriangleMesh used_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> place(mesh.vertices.size(), 0);
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) place[corner] = 1;
  }
  TriangleMesh used{.vertices = {}, .triangles = mesh.triangles};
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == 0) continue;
    place[i] = static_cast<std::uint32_t>(used.vertices.size());
    used.vertices.push_back(mesh.vertices[i]);
  }
  for (TriangleCorners& corners : used.triangles) {
    for (std::uint32_t& corner : corners) corner = place[corner];
  }
  return used;
}

TEST_F(Tiles, AllTilesTogetherAreTheMeshBitForBit) {
  std::mt19937_64 random = oracle::seeded(2801);
  for (int round = 0; round < 150 && !HasFailure(); ++round) {
    const Scene scene = random_scene(random);
    const Scene loaded = test::load("scene.ctiles", tiled(scene, random_tiling(random))).scene;
    const TriangleMesh used = used_of(scene.mesh);
    EXPECT_TRUE(std::ranges::equal(loaded.mesh.vertices, used.vertices, is_same)) << "round " << round;
    EXPECT_EQ(loaded.mesh.triangles, used.triangles) << "round " << round;
    ASSERT_EQ(loaded.parts.size(), scene.parts.size());
    for (std::size_t i = 0; i < scene.parts.size(); ++i) {
      const Part& had = scene.parts[i];
      const Part& has = loaded.parts[i];
      EXPECT_TRUE(has.name == had.name && has.first_triangle == had.first_triangle &&
                  has.triangle_count == had.triangle_count && has.filter.layers == had.filter.layers &&
                  has.filter.mask == had.filter.mask && has.cut.is_whole())
          << had.name;
      for (std::uint32_t k = 0; k < had.triangle_count; ++k)
        EXPECT_EQ(has.cut.told(k, has.triangle_count), had.cut.told(k, had.triangle_count));
    }
  }
}

/// The triangles of each part that a box needs, worked out of the whole mesh.
std::vector<std::uint32_t> needed_of(const Scene& scene, const Part& part, bool is_in_one_tile, const Aabb& box) {
  Aabb all;
  std::vector<std::uint32_t> touching;
  for (std::uint32_t i = 0; i < part.triangle_count; ++i) {
    const Triangle triangle = scene.mesh.triangle(part.first_triangle + i);
    Aabb own;
    for (const Vec3& corner : {triangle.a, triangle.b, triangle.c}) own.extend(corner);
    all.extend(own);
    if (overlaps(own, box)) touching.push_back(i);
  }
  if (!is_in_one_tile) return touching;
  std::vector<std::uint32_t> every(overlaps(all, box) ? part.triangle_count : 0);
  for (std::uint32_t i = 0; i < every.size(); ++i) every[i] = i;
  return every;
}

TEST_F(Tiles, ABoxGetsTheTrianglesThatComeIntoItUnderTheirNumbers) {
  std::mt19937_64 random = oracle::seeded(2802);
  std::uint64_t held_count = 0;
  std::uint64_t left_count = 0;
  std::uint64_t unread_tiles = 0;
  for (int round = 0; round < 150 && !HasFailure(); ++round) {
    const Scene scene = random_scene(random);
    const std::string bytes = tiled(scene, random_tiling(random));
    const TileContents table = decode_table(std::as_bytes(std::span(bytes)));
    LoadOptions options;
    options.within = random_box(random);
    const std::string whole = scene.parts[random() % scene.parts.size()].name;
    if (random() % 2 == 0) options.needed_whole = [&](std::string_view part) { return part == whole; };
    const Scene held = test::load("scene.ctiles", bytes, options).scene;
    std::size_t at = 0;
    for (std::size_t i = 0; i < scene.parts.size(); ++i) {
      const Part& part = scene.parts[i];
      const bool is_one = table.parts[i].tile_count == 1 || (options.needed_whole && part.name == whole);
      const std::vector<std::uint32_t> needed = needed_of(scene, part, is_one, *options.within);
      left_count += part.triangle_count - needed.size();
      if (needed.empty()) continue;
      ASSERT_LT(at, held.parts.size());
      const Part& has = held.parts[at++];
      ASSERT_EQ(has.name, part.name);
      ASSERT_EQ(has.triangle_count, needed.size());
      EXPECT_EQ(has.cut.is_whole(), needed.size() == part.triangle_count);
      for (std::uint32_t k = 0; k < needed.size(); ++k) {
        const Triangle own = held.mesh.triangle(has.first_triangle + k);
        const Triangle given = scene.mesh.triangle(part.first_triangle + needed[k]);
        EXPECT_TRUE(is_same(own.a, given.a) && is_same(own.b, given.b) && is_same(own.c, given.c));
        EXPECT_EQ(has.cut.told(k, has.triangle_count), part.cut.told(needed[k], part.triangle_count));
      }
      held_count += needed.size();
    }
    EXPECT_EQ(at, held.parts.size());
    EXPECT_EQ(held.tiles->tiles_of_file, table.tiles.size());
    unread_tiles += held.tiles->tiles_of_file - held.tiles->tiles;
  }
  EXPECT_GT(held_count, 1'000u);
  EXPECT_GT(left_count, 1'000u);
  EXPECT_GT(unread_tiles, 100u);
}

TEST_F(Tiles, EachTriangleIsInOneTileAndNoTileIsTooLarge) {
  std::mt19937_64 random = oracle::seeded(2803);
  Scene scene{.name = "hills", .mesh = scenes::terrain(100, 50, random())};
  scene.parts = {{.name = "hills", .triangle_count = 20'000}};
  const std::string bytes = tiled(scene, {.most_triangles = 500});
  const TileContents table = decode_table(std::as_bytes(std::span(bytes)));
  std::vector<int> times(20'000);
  for (std::size_t tile = 0; tile < table.tiles.size(); ++tile) {
    const TileMesh mesh = decode_tile(std::as_bytes(std::span(bytes)), table, tile);
    EXPECT_LE(mesh.corners.size(), 500u);
    for (const std::uint32_t number : mesh.triangle_numbers) ++times[number];
    const Aabb bounds = bounds_of(mesh);
    EXPECT_TRUE(bounds.low == table.tiles[tile].bounds.low && bounds.high == table.tiles[tile].bounds.high);
  }
  EXPECT_EQ(std::ranges::count(times, 1), 20'000);
  EXPECT_LT(table.tiles.size(), 80u) << "40 would do";
}

// 500 triangles with one centroid cannot be told apart by any plane: one tile has all of them.
TEST_F(Tiles, TrianglesAtOnePlaceAreOneTile) {
  Scene scene{.name = "pile"};
  scene.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.mesh.triangles.assign(500, {0, 1, 2});
  scene.parts = {{.name = "pile", .triangle_count = 500}};
  const std::string bytes = tiled(scene, {.most_triangles = 10});
  EXPECT_EQ(decode_table(std::as_bytes(std::span(bytes))).tiles.size(), 1u);
}

TEST_F(Tiles, AStreamedFileGivesTheBytesOfOneReadWhole) {
  std::mt19937_64 random = oracle::seeded(2804);
  for (int round = 0; round < 20 && !HasFailure(); ++round) {
    const TriangleMesh mesh = random() % 2 == 0
                                  ? scenes::terrain(1 + static_cast<std::uint32_t>(random() % 60), 20, random())
                                  : scenes::scattered(1 + static_cast<std::uint32_t>(random() % 3'000), 1, random());
    std::ofstream(path("scan.ply"), std::ios::binary) << scenes::ply_file(mesh);
    LoadOptions options;
    if (random() % 2 == 0) options.unit_m = 1e-3;
    if (random() % 2 == 0) options.up = 'y';
    const TilingOptions tiling = random_tiling(random);
    LoadReport of_stream;
    std::optional<StreamedMesh> streamed = stream_mesh(path("scan.ply"), options, of_stream);
    ASSERT_TRUE(streamed);
    write_tiles(path("streamed.ctiles"), streamed->name, "scan.ply", streamed->parts, *streamed->mesh, tiling);
    LoadReport of_whole;
    const Scene scene = load_scene(path("scan.ply"), options, of_whole);
    HeldMeshSource held(scene.mesh);
    write_tiles(path("whole.ctiles"), scene.name, "scan.ply", scene.parts, held, tiling);
    EXPECT_EQ(bytes_of(path("streamed.ctiles")), bytes_of(path("whole.ctiles"))) << "round " << round;
    EXPECT_EQ(of_stream.placed, of_whole.placed);
  }
}

TEST_F(Tiles, WhatCannotBeStreamedIsLeftToTheReader) {
  const auto is_streamed = [&](const std::string& text, const LoadOptions& options = {}) {
    std::ofstream(path("scan.ply"), std::ios::binary) << text;
    LoadReport report;
    return stream_mesh(path("scan.ply"), options, report).has_value();
  };
  const std::string triangle = scenes::ply_file(scenes::terrain(1, 1, 1));
  EXPECT_TRUE(is_streamed(triangle));
  EXPECT_FALSE(is_streamed(triangle, {.mend_m = 0}));
  EXPECT_FALSE(is_streamed(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  std::string square = triangle;
  square[square.size() - 26] = 4;
  EXPECT_FALSE(is_streamed(square)) << "the first of the two faces says that it has four corners";
}

TEST_F(Tiles, AStreamedFileWithABadNumberIsRefusedAsByTheReader) {
  std::string text = scenes::ply_file(scenes::terrain(1, 1, 1));
  const std::uint32_t far_corner = 99;
  std::memcpy(text.data() + text.size() - 4, &far_corner, 4);
  std::ofstream(path("scan.ply"), std::ios::binary) << text;
  LoadReport report;
  try {
    stream_mesh(path("scan.ply"), {}, report);
    FAIL() << "it was taken";
  } catch (const LoadError& error) {
    EXPECT_NE(std::string(error.what()).find("vertex number 99, allowed 0 to 3. Nothing was loaded."),
              std::string::npos)
        << error.what();
  }
}

// Every byte of a small file in turn: what is changed is refused, or lies between two tiles and says nothing.
TEST_F(Tiles, NoByteChangesUnnoticed) {
  Scene scene{.name = "yard", .mesh = scenes::box({1, 1, 1})};
  scene.parts = {{.name = "yard", .triangle_count = 12}};
  const std::string good = tiled(scene, {.size_m = 1.5});
  const TileContents table = decode_table(std::as_bytes(std::span(good)));
  ASSERT_GT(table.tiles.size(), 1u);
  std::size_t refused_count = 0;
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x21);
    const std::string complaint = test::complaint("yard.ctiles", bad);
    const bool is_of_tile = std::ranges::any_of(table.tiles, [&](const TileEntry& tile) {
      return at >= tile.first_byte && at < tile.first_byte + tile.byte_count;
    });
    if (is_of_tile) {
      EXPECT_NE(complaint.find("its checksum is"), std::string::npos) << at << ": " << complaint;
      EXPECT_NE(complaint.find("tile "), std::string::npos) << at << ": " << complaint;
    }
    if (complaint != "loaded") {
      ++refused_count;
      EXPECT_TRUE(complaint.starts_with("yard.ctiles: ") && complaint.ends_with(" Nothing was loaded.")) << complaint;
    }
  }
  EXPECT_GT(refused_count, good.size() * 3 / 4);
  for (std::size_t length = 0; length < good.size(); ++length)
    EXPECT_NE(test::complaint("yard.ctiles", std::string_view(good).substr(0, length)), "loaded") << length;
}

// A shard does not read the other tiles, and so does not say what is wrong with them; all of the file does.
TEST_F(Tiles, ADamagedTileIsNamedWhereItIsNeeded) {
  Scene scene{.name = "hills", .mesh = scenes::terrain(20, 20, 3)};
  scene.parts = {{.name = "hills", .triangle_count = 800}};
  std::string bytes = tiled(scene, {.size_m = 5});
  const TileContents table = decode_table(std::as_bytes(std::span(bytes)));
  const TileEntry& last = table.tiles.back();
  bytes[last.first_byte + last.byte_count / 2] ^= 1;
  const std::string tile =
      "tile " + std::to_string(table.tiles.size() - 1) + " of " + std::to_string(table.tiles.size());
  LoadOptions options;
  options.within = last.bounds;
  EXPECT_NE(test::complaint("hills.ctiles", bytes, options).find(tile), std::string::npos);
  EXPECT_NE(test::complaint("hills.ctiles", bytes).find(tile), std::string::npos);
  options.within = table.tiles.front().bounds;
  EXPECT_EQ(test::complaint("hills.ctiles", bytes, options), "loaded");
}

TEST_F(Tiles, ATileFileIsPlacedAlready) {
  Scene scene{.name = "yard", .mesh = scenes::box({1, 1, 1})};
  scene.parts = {{.name = "yard", .triangle_count = 12}};
  const std::string bytes = tiled(scene, {});
  EXPECT_NE(
      test::complaint("yard.ctiles", bytes, {.unit_m = 1e-3}).find("give --unit, --up and --mend to 'collide convert'"),
      std::string::npos);
  EXPECT_NE(test::complaint("yard.ctiles", bytes, {.mend_m = 0}), "loaded");
  const test::Loaded renamed = test::load("yard.ctiles", bytes, {.name = "dock"});
  EXPECT_EQ(renamed.scene.name, "dock");
  EXPECT_EQ(renamed.scene.parts[0].name, "dock");
}

TEST_F(Tiles, WhatCannotBeTiledLeavesNothingBehind) {
  Scene scene{.name = "yard", .mesh = scenes::terrain(300, 1'000, 4)};
  scene.parts = {{.name = "yard", .triangle_count = 180'000}};
  const auto complaint = [&](const Scene& of, const TilingOptions& options) -> std::string {
    try {
      tiled(of, options);
    } catch (const LoadError& error) { return error.what(); }
    return "written";
  };
  EXPECT_EQ(complaint(scene, {.size_m = 0.01}),
            "tiles of 0.01 m: more than 65536 of them; larger ones, or 'auto', will do. Nothing was written.");
  EXPECT_NE(complaint(scene, {.size_m = 1e-300}).find("too small for a coordinate of"), std::string::npos);
  EXPECT_NE(complaint(Scene{.name = "none"}, {}).find("it holds no triangles"), std::string::npos);
  int looks = 0;
  EXPECT_EQ(complaint(scene, {.cancelled = [&] { return ++looks > 7; }}),
            "scene.ctiles: cancelled. Nothing was written.");
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(complaint(scene, {.size_m = 100}), "written");
}

}  // namespace
}  // namespace collided::engine
