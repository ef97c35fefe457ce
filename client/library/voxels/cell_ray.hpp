#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include "collided/voxels.hpp"

namespace collided::client {

inline constexpr std::int32_t kMostCellNumber = 1 << 23;
/// Products of three lengths along a longer ray do not fit into 64 bits.
inline constexpr std::int32_t kLongestRayCells = 16'000;
inline constexpr std::int64_t kUnitsPerCell = 64;

/// The greatest number n with n * cell_m <= x, exactly; nothing if it is beyond kMostCellNumber or x is not finite.
///
/// cell_m  of at most 24 significant bits, so that all products are exact
inline std::optional<std::int32_t> cell_number(double x, double cell_m) {
  const double guess = x / cell_m;
  if (!(std::abs(guess) < kMostCellNumber)) return std::nullopt;
  // The error of the quotient is far below one.
  auto number = static_cast<std::int32_t>(guess + kMostCellNumber) - kMostCellNumber;
  if (number * cell_m > x) --number;
  else if ((number + 1) * cell_m <= x) ++number;
  return number;
}

/// The start of a ray: a point in a cell, at an odd number of 64ths along each axis, so that it is not on a border.
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

/// A ray along one axis, by the times at which it crosses the borders of cells.
struct AxisRay {
  std::int32_t start = 0;  // the cell it begins in
  std::int32_t step = 0;   // 1 or -1
  std::int64_t first = 0;  // time of the first border
  std::int64_t stride = 0;
  double per_stride = 0;  // its reciprocal

  /// Number of borders crossed up to and including `time`, from 0 to the ray's end.
  std::int64_t borders(std::int64_t time) const {
    const std::int64_t ahead = time - first;
    // The error of the product is below one: a few roundings at a size of at most 2^14.
    const auto guess = static_cast<std::int64_t>(static_cast<double>(ahead) * per_stride);
    const std::int64_t rest = ahead - guess * stride;
    return guess + 1 + static_cast<std::int64_t>(rest >= stride) - static_cast<std::int64_t>(rest < 0);
  }
};

/// A segment from its start to the centre of the cell `end`. Times are integers over one denominator, so that the cells
/// whose interior it meets are determined exactly.
///
/// end  within kLongestRayCells of the start along each axis
struct CellRay {
  CellRay(const RayStart& from, const VoxelNumber& to) {
    const std::int64_t x_length = set(x, from, to, 0), y_length = set(y, from, to, 1), z_length = set(z, from, to, 2);
    end = x_length * y_length * z_length;
    const double per_end = 1 / (static_cast<double>(kUnitsPerCell) * static_cast<double>(end));
    scale(x, x_length, y_length * z_length, per_end);
    scale(y, y_length, z_length * x_length, per_end);
    scale(z, z_length, x_length * y_length, per_end);
  }

  AxisRay x, y, z;
  std::int64_t end = 0;  // a time on no border

 private:
  /// Returns its length along the axis, which is odd and thus never 0: no ray runs along a border.
  static std::int64_t set(AxisRay& ray, const RayStart& from, const VoxelNumber& to, std::size_t axis) {
    const std::int64_t along =
        kUnitsPerCell * (std::int64_t{to[axis]} - from.cell[axis]) + kUnitsPerCell / 2 - from.units[axis];
    ray.start = from.cell[axis];
    ray.step = along < 0 ? -1 : 1;
    ray.first = along < 0 ? from.units[axis] : kUnitsPerCell - from.units[axis];
    return std::abs(along);
  }
  static void scale(AxisRay& ray, std::int64_t length, std::int64_t others, double per_end) {
    ray.first *= others;
    ray.stride = kUnitsPerCell * others;
    ray.per_stride = static_cast<double>(length) * per_end;
  }
};

/// Numbers blocks by their place: neighbours along x differ by `x`, and likewise for y and z; place 0, 0, 0 has
/// `origin`.
struct BlockNumbering {
  std::int64_t origin = 0;
  std::int64_t x = 1, y = 0, z = 0;
};

/// A walk along one axis.
template <int kBits>
struct AxisWalk {
  AxisWalk(const AxisRay& ray, std::int64_t from) : step(ray.step), stride(ray.stride << kBits) {
    constexpr std::int32_t kSide = 1 << kBits;
    const std::int64_t met = from == 0 ? 0 : ray.borders(from);
    const std::int32_t cell = ray.start + static_cast<std::int32_t>(met) * ray.step;
    const std::int32_t within = cell & (kSide - 1);
    block = cell >> kBits;
    next = ray.first + (met + (step > 0 ? kSide - 1 - within : within)) * ray.stride;
  }

  std::int32_t block = 0;
  std::int64_t step = 0;
  std::int64_t next = 0;  // time at which it leaves the block
  std::int64_t stride = 0;
};

/// The blocks of 2^kBits cells along each axis whose interior a ray meets, in order, from a time on. At an edge or a
/// corner it continues with the block beyond, since the adjacent blocks are only touched.
template <int kBits>
class BlockWalk {
 public:
  /// mask  the significant bits of places
  BlockWalk(const CellRay& ray, std::int64_t from, const BlockNumbering& by, std::int32_t mask = -1)
      : x_(ray.x, from), y_(ray.y, from), z_(ray.z, from) {
    at_ = by.origin + (x_.block & mask) * by.x + (y_.block & mask) * by.y + (z_.block & mask) * by.z;
    x_.step *= by.x;
    y_.step *= by.y;
    z_.step *= by.z;
  }

  /// The number of the current block.
  std::int64_t at() const { return at_; }
  /// When it leaves its block; beyond the ray's end if that is within the block.
  std::int64_t leaves() const { return std::min(x_.next, std::min(y_.next, z_.next)); }
  void step() {
    const std::int64_t soonest = leaves();
    go_on(x_, soonest);
    go_on(y_, soonest);
    go_on(z_, soonest);
  }

 private:
  /// Branch-free, since the branch would be unpredictable.
  void go_on(AxisWalk<kBits>& axis, std::int64_t time) {
    const auto is_met = -static_cast<std::int64_t>(axis.next == time);
    at_ += axis.step & is_met;
    axis.next += axis.stride & is_met;
  }

  AxisWalk<kBits> x_, y_, z_;
  std::int64_t at_ = 0;
};

}  // namespace collided::client
