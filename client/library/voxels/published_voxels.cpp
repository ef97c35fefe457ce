#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

#include "client/library/connection/errors.hpp"
#include "client/library/voxels/tile_range.hpp"
#include "client/library/voxels/voxel_tiles.hpp"

namespace collided {

using client::TileBits;
using client::TileRange;
using client::VoxelTile;

namespace {

VoxelShape shape_of(const VoxelTile& tile, const TileBits& bits, double cell_m) {
  constexpr auto kSide = static_cast<std::uint32_t>(client::kTileSide);
  VoxelShape shape{.cell_m = cell_m, .size = {kSide, kSide, kSide}};
  for (std::size_t axis = 0; axis < 3; ++axis) shape.low[axis] = tile.place[axis] * client::kTileSide;
  shape.occupied.reserve(client::kTileCells / 8);
  for (std::size_t row = 0; row < client::kTileCells / kSide; ++row) {
    const std::uint32_t cells = client::row_of(bits, row);
    shape.occupied.push_back(static_cast<std::uint8_t>(cells));
    shape.occupied.push_back(static_cast<std::uint8_t>(cells >> 8));
  }
  return shape;
}

std::string name_of(const VoxelNumber& place) {
  return std::to_string(place[0]) + '_' + std::to_string(place[1]) + '_' + std::to_string(place[2]);
}

std::uint64_t key_of(const VoxelNumber& place) {
  std::uint64_t key = 0;
  for (const std::int32_t at : place) key = key << 21 | (static_cast<std::uint64_t>(std::int64_t{at}) & 0x1fffff);
  return key;
}

void take_out(VoxelShape& cells, const VoxelNumber& place) {
  std::size_t bit = 0;
  for (std::size_t axis = 3; axis-- > 0;) {
    const std::int32_t number = place[axis] - cells.low[axis];
    if (number < 0 || number >= static_cast<std::int32_t>(cells.size[axis])) return;
    bit = bit * cells.size[axis] + static_cast<std::size_t>(number);
  }
  cells.occupied[bit / 8] = static_cast<std::uint8_t>(cells.occupied[bit / 8] & ~(1U << (bit % 8)));
}

bool is_same(const Shape& a, const Shape& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ShapePart& one, const ShapePart& other) {
    const auto& first = std::get<VoxelShape>(one);
    const auto& second = std::get<VoxelShape>(other);
    return first.low == second.low && first.size == second.size && first.occupied == second.occupied;
  });
}

}  // namespace

namespace client {

struct [[gnu::visibility("hidden")]] ShownVoxels {
  struct TileObjects {
    VoxelNumber place{};
    std::optional<Publisher::Object> occupied;
    std::optional<Publisher::Object> unknown;
  };

  ShownVoxels(VoxelGrid made, std::string called, std::uint32_t in_layers, LostPolicy when_lost)
      : grid(std::move(made)), name(std::move(called)), layers(in_layers), lost_policy(when_lost) {
    grid.tiles_->is_watched = true;
  }

  UnknownCells unknown() const { return grid.tiles_->options.unknown; }
  /// Visits the places of published tiles, without those to be removed.
  template <class Visit>
  void for_each_told(Visit && visit) const {
    for (const auto& [key, shown] : objects) {
      const VoxelTile* tile = std::as_const(grid.tiles_->tiles).find(shown.place);
      if (tile != nullptr && !tile->is_empty()) visit(shown.place);
    }
  }
  Result<void> send(Publisher & publisher, bool is_known_less, std::int64_t time_ns);
  bool may_wait(const VoxelTile& tile, std::int64_t time_ns) const;
  TileBits occupied_of(const VoxelTile& tile) const;
  TileBits unknown_of(const VoxelTile& tile) const;
  Result<void> show_tile(Publisher & publisher, const VoxelTile& tile, bool is_unknown_first);
  Result<void> show(Publisher & publisher, std::optional<Publisher::Object> & object, const std::string& suffix,
                    const Shape& shape, bool is_unknown);
  Result<void> show_rest(Publisher & publisher, bool is_outside_first);
  Result<void> show_between(Publisher & publisher, const TileRange& range);
  Result<void> show_outside(Publisher & publisher, const TileRange& range);

  VoxelGrid grid;
  std::string name;
  std::uint32_t layers;
  LostPolicy lost_policy;
  std::unordered_map<std::uint64_t, TileObjects> objects;  // of all published tiles, by place
  std::optional<Publisher::Object> between;                // the unpublished tiles of the range
  Shape between_shape;
  std::array<std::optional<Publisher::Object>, 6> outside;  // below and above the range along each axis
  std::optional<TileRange> outside_of;                      // the range for which those were made
  std::size_t object_count = 0;
};

}  // namespace client

/// Defines, reshapes or removes one object.
Result<void> client::ShownVoxels::show(Publisher& publisher, std::optional<Publisher::Object>& object,
                                       const std::string& suffix, const Shape& shape, bool is_unknown) {
  if (object && !shape.empty()) return publisher.reshape(*object, shape);
  if (object) {
    if (Result<void> removed = publisher.remove(*object); !removed) return removed;
    object.reset();
    --object_count;
    return {};
  }
  if (shape.empty()) return {};
  const Result<Publisher::Object> added = publisher.add({.name = name + '/' + suffix,
                                                         .shape = shape,
                                                         .layers = layers,
                                                         .moving = false,
                                                         .lost_policy = lost_policy,
                                                         .unknown = is_unknown});
  if (!added) return added.error();
  object = *added;
  ++object_count;
  return {};
}

/// An empty tile belongs to `between`.
TileBits client::ShownVoxels::occupied_of(const VoxelTile& tile) const {
  TileBits bits = tile.occupied;
  if (unknown() != UnknownCells::occupied || tile.is_empty()) return bits;
  for (std::size_t word = 0; word < client::kTileWords; ++word) bits[word] |= ~tile.known[word];
  return bits;
}

TileBits client::ShownVoxels::unknown_of(const VoxelTile& tile) const {
  TileBits bits{};
  if (unknown() != UnknownCells::undecided || tile.is_empty()) return bits;
  for (std::size_t word = 0; word < client::kTileWords; ++word) bits[word] = ~tile.known[word];
  return bits;
}

/// True if cells have only become free, and only recently.
bool client::ShownVoxels::may_wait(const VoxelTile& tile, std::int64_t time_ns) const {
  if (!tile.is_told || tile.is_empty() || time_ns - tile.told_ns >= grid.tiles_->options.clearing_delay.count())
    return false;
  const TileBits occupied = occupied_of(tile), unknown_bits = unknown_of(tile);
  for (std::size_t word = 0; word < client::kTileWords; ++word) {
    const std::uint64_t appears = (occupied[word] & ~tile.told_occupied[word]) |
                                  (unknown_bits[word] & ~tile.told_unknown[word] & ~tile.told_occupied[word]);
    if (appears != 0) return false;
  }
  return true;
}

Result<void> client::ShownVoxels::show_tile(Publisher& publisher, const VoxelTile& tile, bool is_unknown_first) {
  TileObjects& shown = objects[key_of(tile.place)];
  shown.place = tile.place;
  const TileBits occupied = occupied_of(tile), unknown_bits = unknown_of(tile);
  const auto shape = [&](const TileBits& bits) {
    return bits == TileBits{} ? Shape{} : Shape{shape_of(tile, bits, grid.cell_m())};
  };
  const auto show_unknown = [&] {
    return show(publisher, shown.unknown, "unknown/" + name_of(tile.place), shape(unknown_bits), true);
  };
  if (is_unknown_first) {
    if (Result<void> done = show_unknown(); !done) return done;
  }
  if (Result<void> done = show(publisher, shown.occupied, name_of(tile.place), shape(occupied), false); !done)
    return done;
  if (!is_unknown_first) {
    if (Result<void> done = show_unknown(); !done) return done;
  }
  if (tile.is_empty()) objects.erase(key_of(tile.place));
  return {};
}

Result<void> client::ShownVoxels::show_between(Publisher& publisher, const TileRange& range) {
  constexpr std::int32_t kMostSide = 256;
  Shape shape;
  const double tile_m = grid.cell_m() * client::kTileSide;
  for (std::int32_t z = range.low[2]; z < range.end[2]; z += kMostSide) {
    for (std::int32_t y = range.low[1]; y < range.end[1]; y += kMostSide) {
      for (std::int32_t x = range.low[0]; x < range.end[0]; x += kMostSide) {
        VoxelShape part{.cell_m = tile_m, .low = {x, y, z}};
        std::size_t count = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          part.size[axis] = static_cast<std::uint32_t>(std::min(kMostSide, range.end[axis] - part.low[axis]));
          count *= part.size[axis];
        }
        part.occupied.assign((count + 7) / 8, 0xff);
        if (count % 8 != 0) part.occupied.back() = static_cast<std::uint8_t>(0xff >> (8 - count % 8));
        shape.emplace_back(std::move(part));
      }
    }
  }
  for_each_told([&](const VoxelNumber& place) {
    for (ShapePart& part : shape) take_out(std::get<VoxelShape>(part), place);
  });
  std::erase_if(shape, [](const ShapePart& any) {
    const auto& bytes = std::get<VoxelShape>(any).occupied;
    return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0; });
  });
  if (is_same(shape, between_shape)) return {};
  if (Result<void> done = show(publisher, between, "unknown/between", shape, unknown() == UnknownCells::undecided);
      !done)
    return done;
  between_shape = std::move(shape);
  return {};
}

Result<void> client::ShownVoxels::show_outside(Publisher& publisher, const TileRange& range) {
  if (outside_of == range) return {};
  constexpr std::array<const char*, 6> kNames{"below_x", "above_x", "below_y", "above_y", "below_z", "above_z"};
  const double tile_m = grid.cell_m() * client::kTileSide;
  for (std::size_t side = 0; side < 6; ++side) {
    const int axis = static_cast<int>(side / 2);
    const bool is_above = side % 2 == 1;
    const std::int32_t border = is_above ? range.end[side / 2] : range.low[side / 2];
    const Vec3 normal = is_above ? Vec3(-Vec3::Unit(axis)) : Vec3(Vec3::Unit(axis));
    const Shape shape{HalfSpaceShape{.normal = normal, .point = border * tile_m * Vec3::Unit(axis)}};
    Result<void> done = show(publisher, outside[side], std::string("unknown/") + kNames[side], shape,
                             unknown() == UnknownCells::undecided);
    if (!done) return done;
  }
  outside_of = range;
  return {};
}

/// Publishes the space without tiles.
Result<void> client::ShownVoxels::show_rest(Publisher& publisher, bool is_outside_first) {
  if (unknown() == UnknownCells::free) return {};
  TileRange range;
  for_each_told([&](const VoxelNumber& place) { range.extend(place); });
  if (is_outside_first) {
    if (Result<void> done = show_outside(publisher, range); !done) return done;
  }
  if (Result<void> done = show_between(publisher, range); !done) return done;
  return is_outside_first ? Result<void>() : show_outside(publisher, range);
}

/// Sends the changes in an order in which no cell is transiently free: a cell becomes occupied before it stops being
/// unknown, and unknown before it stops being occupied.
///
/// is_known_less  cells have become unknown; otherwise none has
Result<void> client::ShownVoxels::send(Publisher& publisher, bool is_known_less, std::int64_t time_ns) {
  std::vector<VoxelTile*>& changed = grid.tiles_->changed;
  const auto due =
      std::partition(changed.begin(), changed.end(), [&](const VoxelTile* tile) { return may_wait(*tile, time_ns); });
  const auto waiting = static_cast<std::size_t>(due - changed.begin());
  if (waiting == changed.size()) return {};
  if (is_known_less) {
    if (Result<void> done = show_rest(publisher, true); !done) return done;
  }
  while (changed.size() > waiting) {
    VoxelTile& tile = *changed.back();
    if (Result<void> done = show_tile(publisher, tile, is_known_less); !done) return done;
    changed.pop_back();
    tile.is_changed = false;
    tile.told_occupied = occupied_of(tile);
    tile.told_unknown = unknown_of(tile);
    tile.told_ns = time_ns;
    tile.is_told = true;
    if (tile.is_empty()) grid.tiles_->tiles.remove(tile.place);
  }
  return show_rest(publisher, false);
}

PublishedVoxels::PublishedVoxels(std::unique_ptr<client::ShownVoxels> shown) : shown_(std::move(shown)) {}
PublishedVoxels::~PublishedVoxels() = default;
PublishedVoxels::PublishedVoxels(PublishedVoxels&&) noexcept = default;
PublishedVoxels& PublishedVoxels::operator=(PublishedVoxels&&) noexcept = default;

Result<PublishedVoxels> PublishedVoxels::start(Publisher& publisher, const std::string& name,
                                               const VoxelOptions& options, std::uint32_t layers,
                                               LostPolicy lost_policy) {
  if (name.empty()) return client::bad_input("voxels without a name");
  Result<VoxelGrid> grid = VoxelGrid::make(options);
  if (!grid) return grid.error();
  PublishedVoxels made(std::make_unique<client::ShownVoxels>(std::move(*grid), name, layers, lost_policy));
  if (Result<void> shown = made.shown_->show_rest(publisher, true); !shown) return shown.error();
  return made;
}

namespace {

/// Inserts a scan in two steps, since the order of sending depends on the changes: the decay of old cells comes first.
template <class Insert>
Result<VoxelScan> sent(const Insert& insert, const auto& decay, const auto& send) {
  const std::size_t decayed = decay();
  if (Result<void> done = send(true); !done) return done.error();
  VoxelScan scan = insert();
  scan.changed += decayed;
  if (Result<void> done = send(false); !done) return done.error();
  return scan;
}

}  // namespace

Result<VoxelScan> PublishedVoxels::insert(Publisher& publisher, std::span<const double> points,
                                          const std::optional<Vec3>& origin, std::chrono::nanoseconds time) {
  return sent([&] { return shown_->grid.insert(points, origin, time); }, [&] { return shown_->grid.decay(time); },
              [&](bool is_known_less) { return shown_->send(publisher, is_known_less, time.count()); });
}

Result<VoxelScan> PublishedVoxels::insert(Publisher& publisher, std::span<const float> points,
                                          const std::optional<Vec3>& origin, std::chrono::nanoseconds time) {
  return sent([&] { return shown_->grid.insert(points, origin, time); }, [&] { return shown_->grid.decay(time); },
              [&](bool is_known_less) { return shown_->send(publisher, is_known_less, time.count()); });
}

/// A map may both add cells and omit earlier ones; the omitted ones are sent first, as a decay.
Result<VoxelScan> PublishedVoxels::assign(Publisher& publisher, std::span<const VoxelBlock> blocks,
                                          std::chrono::nanoseconds time) {
  const VoxelScan scan = shown_->grid.assign(blocks, time);
  if (Result<void> done = shown_->send(publisher, true, time.count()); !done) return done.error();
  return scan;
}

Result<std::size_t> PublishedVoxels::decay(Publisher& publisher, std::chrono::nanoseconds time) {
  const std::size_t changed = shown_->grid.decay(time);
  if (Result<void> done = shown_->send(publisher, true, time.count()); !done) return done.error();
  return changed;
}

Result<void> PublishedVoxels::clear(Publisher& publisher) {
  shown_->grid.clear();
  return shown_->send(publisher, true, 0);
}

const VoxelGrid& PublishedVoxels::grid() const { return shown_->grid; }
std::size_t PublishedVoxels::object_count() const { return shown_->object_count; }

}  // namespace collided
