#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "client/library/voxels/voxel_tile.hpp"

namespace collided::client {

/// The tiles of a grid by their place. The latest ones are found without the map, since rays of one scan cross the same.
///
/// threads  one at a time; a tile stays where it is until it is removed
class TileTable {
 public:
  explicit TileTable(std::size_t most) : most_(most), recent_(kRecent) {}

  /// Null: there is none.
  VoxelTile* find(const VoxelNumber& place) {
    const std::uint64_t key = key_of(place);
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
  /// Null: there are as many as may be.
  VoxelTile* found_or_made(const VoxelNumber& place) {
    if (VoxelTile* known = find(place); known != nullptr) return known;
    if (tiles_.size() >= most_) return nullptr;
    const std::uint64_t key = key_of(place);
    std::unique_ptr<VoxelTile>& made = tiles_[key];
    made = std::make_unique<VoxelTile>();
    made->place = place;
    recent_[slot_of(key)] = {key, made.get()};
    return made.get();
  }
  void remove(const VoxelNumber& place) {
    const std::uint64_t key = key_of(place);
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
    std::uint64_t key = 0;
    VoxelTile* tile = nullptr;
  };

  /// Places are within 2^22 of 0: 21 bits and a sign each would collide nowhere below 2^63.
  static std::uint64_t key_of(const VoxelNumber& place) {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
    std::uint64_t key = 0;
    for (const std::int32_t at : place) key = key << 21 | (static_cast<std::uint64_t>(std::int64_t{at}) & kMask);
    return key;
  }
  static std::size_t slot_of(std::uint64_t key) { return (key * 0x9e3779b97f4a7c15ULL) >> 52; }

  std::size_t most_;
  std::vector<Recent> recent_;
  std::unordered_map<std::uint64_t, std::unique_ptr<VoxelTile>> tiles_;
};

}  // namespace collided::client
