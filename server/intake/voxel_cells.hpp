#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// Cells of a regular axis-aligned grid, as in table Voxels of idl/scene.fbs.
struct VoxelCells {
  double cell_m = 0;
  std::array<std::int32_t, 3> low{};    // the first cell's number along each axis
  std::array<std::uint32_t, 3> size{};  // cells along each axis
  std::span<const std::uint8_t> occupied;
};

/// The flaw of untrusted cells; empty if there is none.
std::string flaw_of(const VoxelCells& cells);

/// Number of occupied cells; the cells must have no flaw.
std::uint64_t occupied_count(const VoxelCells& cells);

/// Adds boxes that cover the space of the occupied cells, each of one cell or of several that fill it: for a scanned
/// wall a fourth to a tenth as many. All numbers are exact: no rounding separates neighbours.
void add_boxes_of(const VoxelCells& cells, std::vector<Primitive>& boxes);

}  // namespace collided::engine
