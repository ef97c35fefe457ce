#include "server/intake/voxel_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "idl/voxel_blocks.hpp"

namespace collided::engine {
namespace {

constexpr std::uint32_t kMostCells = 256;      // along an axis
constexpr std::int32_t kMostNumber = 1 << 26;  // largest cell number: with 24 bits of the size a corner has 51
constexpr double kLeastCell_m = 0x1p-500;      // far from underflow, and no corner overflows
constexpr double kLargestCell_m = 0x1p500;

std::uint64_t cell_count(const VoxelCells& cells) {
  return std::uint64_t{cells.size[0]} * cells.size[1] * cells.size[2];
}

bool has_24_bits(double value) {
  int exponent = 0;
  const double bits = std::ldexp(std::frexp(value, &exponent), 24);
  return bits == std::trunc(bits);
}

Box box_of(const VoxelCells& cells, const wire_contract::CellBlock& block) {
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double twice_middle = 2 * (static_cast<double>(cells.low[axis]) + block.low[axis]) + block.size[axis];
    box.center[static_cast<int>(axis)] = twice_middle * (cells.cell_m / 2);
    box.half_m[static_cast<int>(axis)] = block.size[axis] * (cells.cell_m / 2);
  }
  return box;
}

}  // namespace

std::string flaw_of(const VoxelCells& cells) {
  if (!(cells.cell_m >= kLeastCell_m && cells.cell_m <= kLargestCell_m))
    return fmt::format("cells of {} m, allowed are finite sizes above 0", cells.cell_m);
  if (!has_24_bits(cells.cell_m))
    return fmt::format("cells of {} m: a size of more than 24 significant bits has corners that are no doubles",
                       cells.cell_m);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (cells.size[axis] < 1 || cells.size[axis] > kMostCells)
      return fmt::format("{} cells along an axis, allowed are 1 to {}", cells.size[axis], kMostCells);
    const std::int64_t end = std::int64_t{cells.low[axis]} + cells.size[axis];
    if (cells.low[axis] < -kMostNumber || end > kMostNumber)
      return fmt::format("cells {} to {} along an axis, allowed are numbers within {}", cells.low[axis], end,
                         kMostNumber);
  }
  const std::uint64_t bytes = (cell_count(cells) + 7) / 8;
  if (cells.occupied.size() != bytes)
    return fmt::format("{} bytes for {} cells, {} are needed", cells.occupied.size(), cell_count(cells), bytes);
  const std::uint64_t last_bits = cell_count(cells) % 8;
  if (last_bits != 0 && cells.occupied.back() >> last_bits != 0) return "bits after the last cell";
  return {};
}

std::uint64_t occupied_count(const VoxelCells& cells) {
  std::uint64_t count = 0;
  for (const std::uint8_t byte : cells.occupied) count += static_cast<std::uint64_t>(std::popcount(byte));
  return count;
}

void add_boxes_of(const VoxelCells& cells, std::vector<Primitive>& boxes) {
  wire_contract::BlockGrowth(cells.size, cells.occupied).run([&](const wire_contract::CellBlock& block) {
    boxes.emplace_back(box_of(cells, block));
  });
}

}  // namespace collided::engine
