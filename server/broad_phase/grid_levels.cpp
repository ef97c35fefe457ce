#include "server/broad_phase/grid_levels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace collided::grid {
namespace {

constexpr int kLeastExponent = -1000;
constexpr int kMostExponent = 1000;
constexpr std::int16_t kEmpty = std::numeric_limits<std::int16_t>::max();
constexpr std::int16_t kUnbounded = kEmpty - 1;
constexpr std::uint32_t kNoBucket = 0xffffffffu;
/// Cells are at least this part of the coordinates they hold, so that cell numbers are exact.
constexpr double kLeastCellOfReach = 0x1p-40;
/// So few boxes of a size are cheaper to ask each time than to look up.
constexpr std::uint32_t kFewBoxes = 16;

struct SizeClass {
  std::uint32_t count = 0;
  double largest = 0;
};

/// Boxes by the exponent of their size.
using Histogram = std::array<SizeClass, kMostExponent - kLeastExponent + 1>;

/// The size that decides about the level, in metres; infinite for a box that no cell can hold.
double effective_size(const Aabb& box) {
  const double size = (box.high - box.low).maxCoeff();
  const double reach = std::max(box.high.cwiseAbs().maxCoeff(), box.low.cwiseAbs().maxCoeff());
  return std::max({size, reach * kLeastCellOfReach, 0x1p-1000});
}

/// Sizes up to a factor of four share a level, unless the smaller ones are so many that larger cells would crowd
/// them; far smaller ones join when they are few.
bool joins(std::uint32_t count, std::uint32_t group_count, int exponents_below) {
  return exponents_below <= 1 ? count / 4 <= group_count : count <= group_count / 8;
}

/// A group of neighbouring exponents.
struct Group {
  int least = 0;
  int most = 0;
  std::uint32_t count = 0;
  double largest = 0;
};

std::vector<Group> group_sizes(const Histogram& histogram) {
  std::vector<Group> groups;
  for (int exponent = kMostExponent; exponent >= kLeastExponent; --exponent) {
    const SizeClass& size = histogram[exponent - kLeastExponent];
    if (size.count == 0) continue;
    if (!groups.empty() && joins(size.count, groups.back().count, groups.back().most - exponent)) {
      groups.back().least = exponent;
      groups.back().count += size.count;
    } else {
      groups.push_back({exponent, exponent, size.count, size.largest});
    }
  }
  std::reverse(groups.begin(), groups.end());
  return groups;
}

void widen(CellRange& range, const Cell (&cell)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    range.low[axis] = std::min(range.low[axis], cell[axis]);
    range.high[axis] = std::max(range.high[axis], cell[axis]);
  }
}

Level make_level(const Group& group, std::uint32_t first_bucket) {
  Level level;
  level.cell_m = group.largest * (1 + 0x1p-9);
  level.inverse = 1 / level.cell_m;
  level.first_bucket = first_bucket;
  level.row_mask = std::bit_ceil(group.count) - 1;
  for (int axis = 0; axis < 3; ++axis) {
    level.occupied.low[axis] = std::numeric_limits<Cell>::max();
    level.occupied.high[axis] = std::numeric_limits<Cell>::min();
  }
  return level;
}

void store(const Aabb& box, std::size_t number, Entry& entry) {
  for (int axis = 0; axis < 3; ++axis) {
    entry.lane[axis] = box.low[axis];
    entry.lane[3 + axis] = -box.high[axis];
  }
  entry.lane[6] = static_cast<double>(number);
  entry.lane[7] = 0;
}

}  // namespace

void Levels::rebuild(std::span<const Aabb> boxes) {
  Histogram histogram{};
  exponent_of_box.resize(boxes.size());
  bucket_of_box.resize(boxes.size());
  entry_count = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    exponent_of_box[i] = kEmpty;
    if (boxes[i].empty()) continue;
    ++entry_count;
    const double size = effective_size(boxes[i]);
    exponent_of_box[i] = kUnbounded;
    if (!(size < 0x1p999)) continue;
    const int exponent = std::ilogb(size);
    exponent_of_box[i] = static_cast<std::int16_t>(exponent);
    SizeClass& same = histogram[exponent - kLeastExponent];
    ++same.count;
    same.largest = std::max(same.largest, size);
  }

  // Levels and their tables.
  levels.clear();
  std::array<std::int16_t, kMostExponent - kLeastExponent + 1> level_of_exponent;
  level_of_exponent.fill(-1);
  std::uint32_t bucket_count = 0;
  for (const Group& group : group_sizes(histogram)) {
    if (group.count <= kFewBoxes) continue;
    for (int e = group.least; e <= group.most; ++e) {
      level_of_exponent[e - kLeastExponent] = static_cast<std::int16_t>(levels.size());
    }
    levels.push_back(make_level(group, bucket_count));
    bucket_count += levels.back().row_mask + 1 + static_cast<std::uint32_t>(kRowMask) + 1;
  }

  // Counting sort by bucket; the loose ones come last.
  starts.assign(bucket_count + 2, 0);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const std::int16_t exponent = exponent_of_box[i];
    bucket_of_box[i] = kNoBucket;
    if (exponent == kEmpty) continue;
    bucket_of_box[i] = bucket_count;
    const std::int16_t number = exponent == kUnbounded ? -1 : level_of_exponent[exponent - kLeastExponent];
    if (number >= 0) {
      Level& level = levels[number];
      const Aabb& box = boxes[i];
      const Cell cell[3] = {level.cell_of(box.low[0]), level.cell_of(box.low[1]), level.cell_of(box.low[2])};
      widen(level.occupied, cell);
      level.bounds.extend(box);
      bucket_of_box[i] = level.bucket(cell[0], cell[1], cell[2]);
    }
    ++starts[bucket_of_box[i]];
  }
  for (std::size_t b = 1; b < starts.size(); ++b) starts[b] += starts[b - 1];
  if (entries.size() < entry_count) entries = bsp::PlainArray<Entry>(entry_count + entry_count / 8);
  // Filled from behind: starts holds each bucket's end until its last entry has been placed.
  for (std::size_t i = boxes.size(); i-- > 0;) {
    if (bucket_of_box[i] != kNoBucket) store(boxes[i], i, entries[--starts[bucket_of_box[i]]]);
  }
  loose_begin = starts[bucket_count];
  for (Level& level : levels) {
    level.begin = starts[level.first_bucket];
    level.end = starts[level.first_bucket + level.row_mask + static_cast<std::uint32_t>(kRowMask) + 1];
  }
}

std::size_t Levels::bytes() const {
  return entries.bytes() + starts.capacity() * sizeof(starts[0]) + levels.capacity() * sizeof(Level) +
         bucket_of_box.capacity() * sizeof(bucket_of_box[0]) + exponent_of_box.capacity() * sizeof(exponent_of_box[0]);
}

}  // namespace collided::grid
