#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "client/library/voxels/voxel_tile.hpp"

namespace collided::client {

/// The tiles of a grid by their place. The latest tiles are found without the map, since rays of one scan cross the
/// same ones.
///
/// threads  one at a time; a tile stays where it is until it is removed
class TileTable {
 public:
  explicit TileTable(std::size_t most) : most_(most), recent_(kRecent) {}

  /// Keys of places, which are within 2^19 of 0.
  static constexpr BlockNumbering kKeys{.origin = 0, .x = std::int64_t{1} << 42, .y = std::int64_t{1} << 21, .z = 1};
  static std::int64_t key_of(const VoxelNumber& place) {
    return place[0] * kKeys.x + place[1] * kKeys.y + place[2] * kKeys.z;
  }
  static VoxelNumber place_of(std::int64_t key) {
    // Each sum may have borrowed from the ones above.
    const auto z = static_cast<std::int32_t>(key << 43 >> 43);
    const auto y = static_cast<std::int32_t>((key - z) << 22 >> 43);
    return {static_cast<std::int32_t>((key - z - y * kKeys.y) >> 42), y, z};
  }

  /// Null if there is none.
  VoxelTile* find(const VoxelNumber& place) { return find(key_of(place)); }
  VoxelTile* find(std::int64_t key) {
    Recent& recent = recent_[slot_of(key)];
    if (recent.tile != nullptr && recent.key == key) return recent.tile;
    const auto found = tiles_.find(key);
    if (found == tiles_.end()) return nullptr;
    recent = {key, found->second.get()};
    return recent.tile;
  }
  const VoxelTile* find(const VoxelNumber& place) const {
    const auto found = tiles_.find(key_of(place));
    return found == tiles_.end() ? nullptr : found->second.get();
  }
  /// Null if the maximum number is reached.
  VoxelTile* found_or_made(const VoxelNumber& place) {
    if (VoxelTile* known = find(place); known != nullptr) return known;
    if (tiles_.size() >= most_) return nullptr;
    const std::int64_t key = key_of(place);
    std::unique_ptr<VoxelTile>& made = tiles_[key];
    made = std::make_unique<VoxelTile>();
    made->place = place;
    recent_[slot_of(key)] = {key, made.get()};
    return made.get();
  }
  void remove(const VoxelNumber& place) {
    const std::int64_t key = key_of(place);
    if (recent_[slot_of(key)].key == key) recent_[slot_of(key)] = {};
    tiles_.erase(key);
  }
  void clear() {
    tiles_.clear();
    recent_.assign(kRecent, {});
  }
  std::size_t size() const { return tiles_.size(); }
  template <class Visit>
  void for_each(Visit&& visit) {
    for (auto& [key, tile] : tiles_) visit(*tile);
  }
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const auto& [key, tile] : tiles_) visit(std::as_const(*tile));
  }

 private:
  static constexpr std::size_t kRecent = 4'096;
  struct Recent {
    std::int64_t key = 0;
    VoxelTile* tile = nullptr;
  };

  static std::size_t slot_of(std::int64_t key) {
    return (static_cast<std::uint64_t>(key) * 0x9e3779b97f4a7c15ULL) >> 52;
  }

  std::size_t most_;
  std::vector<Recent> recent_;
  std::unordered_map<std::int64_t, std::unique_ptr<VoxelTile>> tiles_;
};

}  // namespace collided::client
