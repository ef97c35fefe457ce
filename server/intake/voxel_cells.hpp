#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// Cells of a regular grid that stands along the axes, as table Voxels of idl/scene.fbs has them.
struct VoxelCells {
  double cell_m = 0;
  std::array<std::int32_t, 3> low{};    // the first cell's number along each axis
  std::array<std::uint32_t, 3> size{};  // cells along each axis
  std::span<const std::uint8_t> occupied;
};

/// What is wrong with cells from anyone; empty: nothing.
std::string flaw_of(const VoxelCells& cells);

/// Of cells without a flaw: how many are occupied.
std::uint64_t occupied_count(const VoxelCells& cells);

/// Adds boxes that hold the space of the occupied cells, each of one cell or of several that fill it: what a scan sees of a
/// wall is a fourth to a tenth as many. All numbers are exact: no rounding parts neighbours.
void add_boxes_of(const VoxelCells& cells, std::vector<Primitive>& boxes);

}  // namespace collided::engine
