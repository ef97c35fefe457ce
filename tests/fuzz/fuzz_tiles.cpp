#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>

#include "idl/scene_tables.hpp"
#include "idl/tiles_generated.h"
#include "server/intake/tiles/tile_format.hpp"
#include "server/intake/tiles/tile_writer.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/scenes/meshes.hpp"

namespace {

using namespace collided::engine;
namespace format = collided::format;

/// Writes the checksum of each tile into the table, where the table can be read.
void seal_tiles(std::string& file, std::span<std::byte> table) {
  auto* const bytes = reinterpret_cast<std::uint8_t*>(table.data());
  if (reinterpret_cast<std::uintptr_t>(bytes) % alignof(double) != 0) return;
  if (format::verified<format::TileTable>(bytes, table.size(), nullptr) == nullptr) return;
  for (const format::Tile* tile : *flatbuffers::GetRoot<format::TileTable>(bytes)->tiles()) {
    const auto* const as_table = reinterpret_cast<const flatbuffers::Table*>(tile);
    const std::uint8_t* const at = as_table->GetAddressOf(format::Tile::VT_CHECKSUM);
    if (at == nullptr || tile->first_byte() > file.size() || tile->byte_count() > file.size() - tile->first_byte())
      continue;
    const std::uint32_t sum =
        tile_checksum(std::as_bytes(std::span(file)).subspan(tile->first_byte(), tile->byte_count()));
    std::memcpy(bytes + (at - bytes), &sum, sizeof sum);
  }
}

/// The file with fitting checksums, whatever else it says: what is behind them must hold as well. The last 64 bytes begin with
/// the table's first byte, its length and its checksum.
std::string with_checksums(std::span<const std::uint8_t> data) {
  std::string file(data.begin(), data.end());
  constexpr std::size_t kLast = kTileBlockBytes;
  if (file.size() < kLast) return file;
  char* const last = file.data() + file.size() - kLast;
  std::uint64_t place[2];
  std::memcpy(place, last, sizeof place);
  if (place[0] > file.size() - kLast || place[1] > file.size() - kLast - place[0]) return file;
  const std::span table = std::as_writable_bytes(std::span(file)).subspan(place[0], place[1]);
  seal_tiles(file, table);
  const std::uint32_t sum = tile_checksum(table);
  std::memcpy(last + sizeof place, &sum, sizeof sum);
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.ctiles", data, size);
  const std::string sealed = with_checksums({data, size});
  collided::fuzz::load_or_refuse("fuzz.ctiles", reinterpret_cast<const std::uint8_t*>(sealed.data()), sealed.size());
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  using namespace collided;
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("fuzz_" + std::to_string(::getpid()) + ".ctiles");
  Scene scene{.name = "s", .mesh = scenes::box({1, 1, 1})};
  scene.parts = {{.name = "s/a", .triangle_count = 5}, {.name = "s/b", .first_triangle = 5, .triangle_count = 7}};
  scene.parts[1].cut.piece_of = std::make_shared<const std::vector<std::uint32_t>>(2, 3);
  std::vector<std::string> seeds;
  for (const double size_m : {0.7, 1.5, 10.0}) {
    HeldMeshSource mesh(scene.mesh);
    write_tiles(path.string(), scene.name, "s.obj", scene.parts, mesh, {.size_m = size_m});
    std::ifstream file(path, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  std::filesystem::remove(path);
  return seeds;
}
