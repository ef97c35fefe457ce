#include "server/broad_phase/grid_levels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <compare>
#include <limits>
#include <utility>

namespace collided::grid {
namespace {

constexpr int kLeastExponent = -1000;
constexpr int kMostExponent = 1000;
constexpr std::int16_t kEmpty = std::numeric_limits<std::int16_t>::max();
constexpr std::int16_t kUnbounded = kEmpty - 1;
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

Level make_level(const Group& group) {
  Level level;
  level.cell_m = group.largest * (1 + 0x1p-9);
  level.inverse = 1 / level.cell_m;
  return level;
}

CellRange nowhere() {
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    range.low[axis] = std::numeric_limits<Cell>::max();
    range.high[axis] = std::numeric_limits<Cell>::min();
  }
  return range;
}

void store(const Aabb& box, std::size_t number, Entry& entry) {
  for (int axis = 0; axis < 3; ++axis) {
    entry.lane[axis] = box.low[axis];
    entry.lane[3 + axis] = -box.high[axis];
  }
  entry.lane[6] = static_cast<double>(number);
  entry.lane[7] = 0;
}

/// Cells of a level as one number in the order z, y, x, where their ranges allow it.
struct KeyLayout {
  const Level& level;
  int x_bits;
  int xy_bits;
  int bits;

  explicit KeyLayout(const Level& of_level) : level(of_level) {
    x_bits = bits_for(0);
    xy_bits = x_bits + bits_for(1);
    bits = xy_bits + bits_for(2);
  }
  int bits_for(int axis) const {
    return static_cast<int>(
        std::bit_width(static_cast<std::uint64_t>(level.occupied.high[axis] - level.occupied.low[axis])));
  }
  std::uint64_t key(const Aabb& box) const {
    const auto x = static_cast<std::uint64_t>(level.cell_of(box.low[0]) - level.occupied.low[0]);
    const auto y = static_cast<std::uint64_t>(level.cell_of(box.low[1]) - level.occupied.low[1]);
    const auto z = static_cast<std::uint64_t>(level.cell_of(box.low[2]) - level.occupied.low[2]);
    return z << xy_bits | y << x_bits | x;
  }
};

constexpr int kBoxBits = 32;

/// Sorts numbers by their bits above kBoxBits, which number `bits`; stable, a counting sort for every eleven of them.
void radix_sort(std::vector<std::uint64_t>& values, std::vector<std::uint64_t>& other, int bits) {
  constexpr int kDigitBits = 11;
  constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
  other.resize(values.size());
  for (int shift = kBoxBits; shift < kBoxBits + bits; shift += kDigitBits) {
    std::array<std::uint32_t, kDigits> place{};
    for (const std::uint64_t value : values) ++place[value >> shift & (kDigits - 1)];
    std::uint32_t sum = 0;
    for (std::uint32_t& count : place) sum += std::exchange(count, sum);
    for (const std::uint64_t value : values) other[place[value >> shift & (kDigits - 1)]++] = value;
    values.swap(other);
  }
}

/// Box numbers of a level by z, y, x of their cells, in the low kBoxBits of `sorted`.
void sort_by_cell(std::span<const Aabb> boxes, std::span<const std::uint32_t> members, const Level& level,
                  std::vector<std::uint64_t>& sorted, std::vector<std::uint64_t>& scratch) {
  const KeyLayout layout(level);
  sorted.resize(members.size());
  if (layout.bits <= 64 - kBoxBits) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      sorted[i] = layout.key(boxes[members[i]]) << kBoxBits | members[i];
    }
    radix_sort(sorted, scratch, layout.bits);
    return;
  }
  // A world of more than 2^32 cells: by comparison, which costs no more where boxes are few for its size.
  struct Placed {
    Cell z, y, x;
    std::uint32_t box;
    auto operator<=>(const Placed&) const = default;
  };
  std::vector<Placed> placed;
  placed.reserve(members.size());
  for (const std::uint32_t box : members) {
    const Vec3& low = boxes[box].low;
    placed.push_back({level.cell_of(low[2]), level.cell_of(low[1]), level.cell_of(low[0]), box});
  }
  std::sort(placed.begin(), placed.end());
  for (std::size_t i = 0; i < placed.size(); ++i) sorted[i] = placed[i].box;
}

}  // namespace

void Levels::choose_levels(std::span<const Aabb> boxes) {
  Histogram histogram{};
  exponent_of_box_.resize(boxes.size());
  entry_count = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    exponent_of_box_[i] = kEmpty;
    if (boxes[i].empty()) continue;
    ++entry_count;
    const double size = effective_size(boxes[i]);
    exponent_of_box_[i] = kUnbounded;
    if (!(size < 0x1p999)) continue;
    const int exponent = std::ilogb(size);
    exponent_of_box_[i] = static_cast<std::int16_t>(exponent);
    SizeClass& same = histogram[exponent - kLeastExponent];
    ++same.count;
    same.largest = std::max(same.largest, size);
  }
  levels.clear();
  level_of_exponent_.assign(histogram.size(), -1);
  for (const Group& group : group_sizes(histogram)) {
    if (group.count <= kFewBoxes) continue;
    for (int e = group.least; e <= group.most; ++e) {
      level_of_exponent_[e - kLeastExponent] = static_cast<std::int16_t>(levels.size());
    }
    levels.push_back(make_level(group));
    // Counts for now; places once all are known.
    levels.back().end = group.count;
  }
}

void Levels::fill_level(std::span<const Aabb> boxes, std::span<const std::uint32_t> members, Level& level) {
  level.occupied = nowhere();
  for (const std::uint32_t box : members) {
    level.bounds.extend(boxes[box]);
    for (int axis = 0; axis < 3; ++axis) {
      const Cell cell = level.cell_of(boxes[box].low[axis]);
      level.occupied.low[axis] = std::min(level.occupied.low[axis], cell);
      level.occupied.high[axis] = std::max(level.occupied.high[axis], cell);
    }
  }
  sort_by_cell(boxes, members, level, keys_, other_keys_);
  level.row_begin = static_cast<std::uint32_t>(rows.size());
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    constexpr std::size_t kAhead = 12;
    if (i + kAhead < keys_.size()) __builtin_prefetch(&boxes[keys_[i + kAhead] & 0xffffffffu]);
    const auto number = static_cast<std::uint32_t>(keys_[i]);
    const auto place = level.begin + static_cast<std::uint32_t>(i);
    const Aabb& box = boxes[number];
    store(box, number, entries[place]);
    x_of_entry[place] = level.cell_of(box.low[0]);
    const Cell y = level.cell_of(box.low[1]);
    const Cell z = level.cell_of(box.low[2]);
    if (i == 0 || rows.back().y != y || rows.back().z != z) rows.push_back({y, z, place, place});
    rows.back().end = place + 1;
  }
  level.row_end = static_cast<std::uint32_t>(rows.size());
}

void Levels::index_rows(Level& level) {
  level.first_slot = static_cast<std::uint32_t>(slots.size());
  level.slot_mask = std::bit_ceil(2 * (level.row_end - level.row_begin)) - 1;
  slots.resize(slots.size() + level.slot_mask + 1, kNoRow);
  for (std::uint32_t row = level.row_begin; row < level.row_end; ++row) {
    std::uint32_t slot = level.slot_of(rows[row].y, rows[row].z);
    while (slots[level.first_slot + slot] != kNoRow) slot = (slot + 1) & level.slot_mask;
    slots[level.first_slot + slot] = row;
  }
}

void Levels::rebuild(std::span<const Aabb> boxes) {
  choose_levels(boxes);
  if (entries.size() < entry_count) entries = bsp::PlainArray<Entry>(entry_count + entry_count / 8);
  std::uint32_t place = 0;
  std::vector<std::uint32_t> cursor;
  for (Level& level : levels) {
    level.begin = place;
    cursor.push_back(place);
    place += std::exchange(level.end, level.end + place);
  }
  loose_begin = place;
  cursor.push_back(place);

  members_.resize(entry_count);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const std::int16_t exponent = exponent_of_box_[i];
    if (exponent == kEmpty) continue;
    const std::int16_t level = exponent == kUnbounded ? std::int16_t{-1} : level_of_exponent_[exponent - kLeastExponent];
    members_[cursor[level < 0 ? levels.size() : static_cast<std::size_t>(level)]++] = static_cast<std::uint32_t>(i);
  }
  x_of_entry.resize(loose_begin);
  rows.clear();
  slots.clear();
  for (Level& level : levels) {
    fill_level(boxes, std::span(members_).subspan(level.begin, level.count()), level);
    index_rows(level);
  }
  for (std::uint32_t i = loose_begin; i < entry_count; ++i) store(boxes[members_[i]], members_[i], entries[i]);
}

std::size_t Levels::bytes() const {
  return entries.bytes() + x_of_entry.capacity() * sizeof(Cell) + rows.capacity() * sizeof(Row) +
         slots.capacity() * sizeof(slots[0]) + members_.capacity() * sizeof(members_[0]) +
         exponent_of_box_.capacity() * sizeof(exponent_of_box_[0]) +
         (keys_.capacity() + other_keys_.capacity()) * sizeof(keys_[0]);
}

}  // namespace collided::grid
