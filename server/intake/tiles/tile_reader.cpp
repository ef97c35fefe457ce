#include "server/intake/tiles/tile_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/intake/readers/names.hpp"
#include "server/intake/scene_file/scene_decoder.hpp"
#include "server/intake/tiles/tile_format.hpp"

namespace collided::engine {
namespace {

/// The content of a tile file that a box needs.
class Needed {
 public:
  Needed(const TileContents& table, const LoadOptions& options) : table_(table), within_(options.within) {
    for (const TiledPart& part : table.parts) {
      const bool is_touched = !within_ || overlaps(part.bounds, *within_);
      const bool is_one = part.tile_count == 1 || (options.needed_whole && options.needed_whole(part.name));
      shares_.push_back(!is_touched ? PartShare::none : !within_ || is_one ? PartShare::whole : PartShare::touching);
    }
  }

  bool any_of(const TileEntry& tile) const {
    return std::ranges::any_of(tile.parts, [&](std::uint32_t part) {
      return shares_[part] == PartShare::whole ||
             (shares_[part] == PartShare::touching && overlaps(tile.bounds, *within_));
    });
  }
  bool has(std::uint32_t part, const Triangle& triangle) const {
    return shares_[part] == PartShare::whole ||
           (shares_[part] == PartShare::touching && overlaps(bounds(triangle), *within_));
  }

 private:
  enum class PartShare : std::uint8_t { none, touching, whole };

  const TileContents& table_;
  const std::optional<Aabb>& within_;
  std::vector<PartShare> shares_;
};

struct HeldTriangle {
  std::uint32_t number = 0;   // in the whole mesh
  TriangleCorners corners{};  // indexes of the gathered vertices
};

/// Gathers the needed content of each tile; tiles may come in any order.
class Gathering {
 public:
  Gathering(const TileContents& table, const Needed& needed) : table_(table), needed_(needed) {}

  void take(const TileMesh& tile, const TileEntry& entry) {
    places_.assign(tile.vertices.size(), kNoPlace);
    auto part = entry.parts.begin();
    for (std::size_t i = 0; i < tile.corners.size(); ++i) {
      const std::uint32_t number = tile.triangle_numbers[i];
      while (number - table_.parts[*part].first_triangle >= table_.parts[*part].triangle_count) ++part;
      const TriangleCorners& own = tile.corners[i];
      if (!needed_.has(*part, {tile.vertices[own[0]], tile.vertices[own[1]], tile.vertices[own[2]]})) continue;
      triangles_.push_back({number, {place_of(tile, own[0]), place_of(tile, own[1]), place_of(tile, own[2])}});
    }
  }

  std::size_t triangle_count() const { return triangles_.size(); }

  /// Puts the gathered mesh and parts into the scene, in the order of the whole mesh.
  void put_into(Scene& scene) {
    std::ranges::sort(triangles_, {}, &HeldTriangle::number);
    const auto twice = std::ranges::adjacent_find(triangles_, {}, &HeldTriangle::number);
    if (twice != triangles_.end()) throw Flaw{fmt::format("triangle {} is in two tiles", twice->number)};
    const std::vector<std::uint32_t> merged = merge_vertices(scene.mesh.vertices);
    scene.mesh.triangles.reserve(triangles_.size());
    for (const HeldTriangle& triangle : triangles_) {
      const TriangleCorners& at = triangle.corners;
      scene.mesh.triangles.push_back({merged[at[0]], merged[at[1]], merged[at[2]]});
    }
    add_parts(scene);
  }

 private:
  static constexpr std::uint32_t kNoPlace = 0xffffffff;

  std::uint32_t place_of(const TileMesh& tile, std::uint32_t own) {
    if (places_[own] == kNoPlace) {
      places_[own] = static_cast<std::uint32_t>(vertices_.size());
      numbers_.push_back(tile.vertex_numbers[own]);
      vertices_.push_back(tile.vertices[own]);
    }
    return places_[own];
  }

  /// Each vertex once, ordered by number. Returns the new index of each gathered one.
  std::vector<std::uint32_t> merge_vertices(std::vector<Vec3>& to) {
    std::vector<std::uint32_t> order(numbers_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [&](std::uint32_t at) { return std::pair(numbers_[at], at); });
    std::vector<std::uint32_t> merged(numbers_.size());
    to.reserve(numbers_.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::uint32_t at = order[i];
      if (i == 0 || numbers_[at] != numbers_[order[i - 1]]) to.push_back(vertices_[at]);
      else if (to.back() != vertices_[at])
        throw Flaw{fmt::format("vertex {} is not at one place in all tiles", numbers_[at])};
      merged[at] = static_cast<std::uint32_t>(to.size() - 1);
    }
    vertices_ = {};
    to.shrink_to_fit();
    return merged;
  }

  void add_parts(Scene& scene) const {
    auto first = triangles_.begin();
    for (const TiledPart& from : table_.parts) {
      const auto last = std::partition_point(first, triangles_.end(), [&](const HeldTriangle& triangle) {
        return triangle.number - from.first_triangle < from.triangle_count;
      });
      if (first == last) continue;
      Part& part =
          scene.parts.emplace_back(Part{.name = from.name,
                                        .first_triangle = static_cast<std::uint32_t>(first - triangles_.begin()),
                                        .triangle_count = static_cast<std::uint32_t>(last - first),
                                        .filter = from.filter,
                                        .cut = from.cut});
      if (part.triangle_count != from.triangle_count) {
        std::vector<std::uint32_t> held(part.triangle_count);
        std::transform(first, last, held.begin(),
                       [&](const HeldTriangle& one) { return one.number - from.first_triangle; });
        part.cut.held = std::make_shared<const std::vector<std::uint32_t>>(std::move(held));
        part.cut.whole_count = from.triangle_count;
      }
      first = last;
    }
  }

  const TileContents& table_;
  const Needed& needed_;
  std::vector<HeldTriangle> triangles_;
  std::vector<std::uint32_t>
      numbers_;  // numbers of the vertices in the whole mesh; repeated for vertices of several tiles
  std::vector<Vec3> vertices_;
  std::vector<std::uint32_t> places_;  // indexes of a tile's vertices among these
};

void refuse_placing(const LoadOptions& options) {
  if (options.unit_m != 1 || options.up == 'y' || options.mend_m)
    throw Flaw{
        "its tiles are in metres with z up and are not mended any more; give --unit, --up and --mend to 'collide "
        "convert'"};
}

/// If the scene has another name, all parts are renamed at once: a name must not depend on what is read.
void rename(const Reading& reading, TileContents& table) {
  if (reading.options.name.empty()) return;
  Scene all{.name = table.name};
  for (const TiledPart& part : table.parts) all.parts.push_back({.name = part.name});
  rename_scene(reading, all, mended_name(reading.options.name));
  table.name = all.name;
  for (std::size_t i = 0; i < all.parts.size(); ++i) table.parts[i].name = std::move(all.parts[i].name);
}

Scene read(const Reading& reading) {
  refuse_placing(reading.options);
  const std::span<const std::byte> file = std::as_bytes(std::span(reading.bytes));
  TileContents table = decode_table(file);
  rename(reading, table);
  const Needed needed(table, reading.options);
  Gathering gathering(table, needed);
  Scene scene{.name = table.name};
  scene.tiles = {.tiles = 0,
                 .tiles_of_file = table.tiles.size(),
                 .triangles_of_file = table.triangle_count,
                 .parts_of_file = table.parts.size()};
  for (std::size_t tile = 0; tile < table.tiles.size(); ++tile) {
    tell_progress(reading, 0.9 * static_cast<double>(tile) / static_cast<double>(table.tiles.size()));
    if (!needed.any_of(table.tiles[tile])) continue;
    gathering.take(decode_tile(file, table, tile), table.tiles[tile]);
    check_triangle_count(reading, gathering.triangle_count());
    ++scene.tiles->tiles;
    if (reading.give_back)
      reading.give_back(reading.bytes.subspan(table.tiles[tile].first_byte, table.tiles[tile].byte_count));
  }
  gathering.put_into(scene);
  return scene;
}

}  // namespace

Scene read_tiles(const Reading& reading) {
  try {
    return read(reading);
  } catch (const Flaw& flaw) { refuse(reading, flaw.what); }
}

}  // namespace collided::engine
