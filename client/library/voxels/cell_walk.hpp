#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>

#include "collided/voxels.hpp"

namespace collided::client {

inline constexpr std::int32_t kMostCellNumber = 1 << 23;
/// Products of three lengths along a longer ray do not fit 64 bits.
inline constexpr std::int32_t kLongestRayCells = 16'000;
inline constexpr std::int64_t kUnitsPerCell = 64;

/// The greatest number n with n * cell_m <= x, exactly; nothing where it is beyond kMostCellNumber or x is not finite.
///
/// cell_m  of at most 24 significant bits, so that all products are exact
inline std::optional<std::int32_t> cell_number(double x, double cell_m) {
  const double guess = std::floor(x / cell_m);
  if (!(std::abs(guess) < kMostCellNumber)) return std::nullopt;
  double number = guess;
  if (number * cell_m > x) number -= 1;
  else if ((number + 1) * cell_m <= x) number += 1;
  return static_cast<std::int32_t>(number);
}

/// Where a ray begins: in a cell, at an odd number of 64ths of it along each axis, so that it is on no border.
struct RayStart {
  VoxelNumber cell{};
  std::array<std::int64_t, 3> units{};  // 1 to 63
};

/// The origin, moved by at most 1/64 of a cell along each axis.
inline std::optional<RayStart> ray_start(const Vec3& origin, double cell_m) {
  RayStart start;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<std::int32_t> number = cell_number(origin[axis], cell_m);
    if (!number) return std::nullopt;
    const double within = (origin[axis] - *number * cell_m) / cell_m * kUnitsPerCell;
    const auto at = static_cast<std::size_t>(axis);
    start.cell[at] = *number;
    start.units[at] = std::clamp<std::int64_t>(static_cast<std::int64_t>(within), 0, kUnitsPerCell - 1) | 1;
  }
  return start;
}

/// The cells whose inside a segment meets, in order, from its start to the middle of the cell `end`. Decided in whole
/// numbers: the times at which the ray meets the next border along each axis, over one denominator.
///
/// end  within kLongestRayCells of the start along each axis
class CellWalk {
 public:
  CellWalk(const RayStart& start, const VoxelNumber& end) : cell_(start.cell) {
    std::array<std::int64_t, 3> length{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t cells = std::int64_t{end[axis]} - start.cell[axis];
      // Odd, and so never 0: no ray runs along a border.
      const std::int64_t along = kUnitsPerCell * cells + kUnitsPerCell / 2 - start.units[axis];
      length[axis] = std::abs(along);
      left_[axis] = std::abs(cells);
      step_[axis] = along < 0 ? -1 : 1;
      next_[axis] = along < 0 ? start.units[axis] : kUnitsPerCell - start.units[axis];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t scale = length[(axis + 1) % 3] * length[(axis + 2) % 3];
      next_[axis] = left_[axis] == 0 ? kNever : next_[axis] * scale;
      stride_[axis] = kUnitsPerCell * scale;
    }
  }

  const VoxelNumber& cell() const { return cell_; }
  bool is_at_end() const { return (left_[0] | left_[1] | left_[2]) == 0; }

  /// To the next cell. At an edge or a corner it goes on beyond it: the cells beside are touched, not met.
  void step() {
    const std::int64_t soonest = std::min(next_[0], std::min(next_[1], next_[2]));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (next_[axis] != soonest) continue;
      cell_[axis] += step_[axis];
      next_[axis] = --left_[axis] == 0 ? kNever : next_[axis] + stride_[axis];
    }
  }

  /// To the first cell beyond this one's block of `side` cells along each axis, a power of two, or to the end within it.
  void leave_block(std::int32_t side) {
    std::int64_t leaves = kNever;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int32_t within = cell_[axis] & (side - 1);
      const std::int64_t borders = step_[axis] > 0 ? side - within : within + 1;
      if (borders <= left_[axis]) leaves = std::min(leaves, next_[axis] + (borders - 1) * stride_[axis]);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (next_[axis] > leaves || left_[axis] == 0) continue;
      const std::int64_t borders = leaves == kNever ? left_[axis] : (leaves - next_[axis]) / stride_[axis] + 1;
      cell_[axis] += static_cast<std::int32_t>(borders) * step_[axis];
      left_[axis] -= borders;
      next_[axis] = left_[axis] == 0 ? kNever : next_[axis] + borders * stride_[axis];
    }
  }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  VoxelNumber cell_;
  std::array<std::int32_t, 3> step_{};
  std::array<std::int64_t, 3> left_{};  // borders up to the end
  std::array<std::int64_t, 3> next_{};
  std::array<std::int64_t, 3> stride_{};
};

}  // namespace collided::client
