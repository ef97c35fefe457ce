#include "server/broad_phase/grid/grid_levels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace collided::engine::grid {
namespace {

constexpr int kLeastExponent = -1000;
constexpr int kMostExponent = 1000;
constexpr std::int16_t kEmpty = std::numeric_limits<std::int16_t>::max();
constexpr std::int16_t kUnbounded = kEmpty - 1;
/// Cells are at least this share of their coordinates, so that cell numbers are exact.
constexpr double kLeastCellOfReach = 0x1p-40;
/// Up to this many boxes of a size are cheaper to test every time than to look up.
constexpr std::uint32_t kFewBoxes = 16;

/// Testing up to this many boxes takes a ray less time than a node of the tree.
constexpr std::uint32_t kFewForTree = 3;

/// Cells are at least this share as wide as long: narrower ones would give a query many rows to look up.
constexpr double kLeastCellAspect = 0x1p-6;

/// The boxes of one binary exponent.
struct SizeClass {
  std::uint32_t count = 0;
  double largest = 0;
  Vec3 extent = Vec3::Zero();  // the largest on each axis
};

/// Counts of boxes by the exponent of their size.
using Histogram = std::array<SizeClass, kMostExponent - kLeastExponent + 1>;

/// The largest absolute coordinate.
double reach_of(const Aabb& box) { return std::max(box.high.cwiseAbs().maxCoeff(), box.low.cwiseAbs().maxCoeff()); }

/// The size that determines the level, metres; infinite for a box that no cell can hold. reach: of all boxes.
double effective_size(const Aabb& box, double reach) {
  const double size = std::max((box.high - box.low).maxCoeff(), 0x1p-1000);
  return size >= reach * kLeastCellOfReach ? size : std::max(size, reach_of(box) * kLeastCellOfReach);
}

/// The binary exponent of a normal number.
int exponent_of(double value) { return static_cast<int>(std::bit_cast<std::uint64_t>(value) >> 52) - 1023; }

/// Sizes up to a factor of four share a level, unless there are so many small ones that larger cells would be crowded;
/// far smaller ones join only if they are few.
bool joins(std::uint32_t count, std::uint32_t group_count, int exponents_below) {
  return exponents_below <= 1 ? count / 4 <= group_count : count <= group_count / 8;
}

/// Neighbouring exponents that share a level.
struct Group {
  int least = 0;
  int most = 0;
  std::uint32_t count = 0;
  double largest = 0;
  Vec3 extent = Vec3::Zero();
};

std::vector<Group> group_sizes(const Histogram& histogram) {
  std::vector<Group> groups;
  for (int exponent = kMostExponent; exponent >= kLeastExponent; --exponent) {
    const SizeClass& size = histogram[exponent - kLeastExponent];
    if (size.count == 0) continue;
    if (!groups.empty() && joins(size.count, groups.back().count, groups.back().most - exponent)) {
      groups.back().least = exponent;
      groups.back().count += size.count;
      groups.back().extent = groups.back().extent.cwiseMax(size.extent);
    } else {
      groups.push_back({exponent, exponent, size.count, size.largest, size.extent});
    }
  }
  std::reverse(groups.begin(), groups.end());
  return groups;
}

/// reach: at least the largest coordinate of the level's boxes; a larger value only makes cells wider than necessary.
void set_cells(GridLevel& level, double reach) {
  const double largest = level.cell_m.maxCoeff();
  // Never more than the largest box: such a cell holds its own coordinates.
  const double least = std::max(largest * kLeastCellAspect, std::min(largest, reach * kLeastCellOfReach));
  for (int k = 0; k < 3; ++k) {
    level.cell_m[k] = std::max(level.cell_m[k], least) * (1 + 0x1p-9);
    level.inverse[k] = 1 / level.cell_m[k];
  }
}

std::uint32_t whole_blocks(std::uint32_t places) { return (places + kBlock - 1) / kBlock * kBlock; }

/// Makes room for some more: gives back memory after a peak.
template <class T>
void make_room(bvh::PlainArray<T>& array, std::size_t size) {
  constexpr std::size_t kKept = 4'096;
  if (array.size() < size || array.size() > 4 * size + kKept) array = bvh::PlainArray<T>(size + size / 32);
}

}  // namespace

void Levels::choose_levels(std::span<const Aabb> boxes, RebuildScratch& scratch) {
  Histogram histogram{};
  exponent_of_box_.resize(boxes.size());
  entry_count = 0;
  all_ = Extent{};
  for (const Aabb& box : boxes) {
    if (!box.empty()) all_.extend(box);
  }
  const double reach = reach_of(all_.bounds);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    exponent_of_box_[i] = kEmpty;
    if (boxes[i].empty()) continue;
    ++entry_count;
    const double size = effective_size(boxes[i], reach);
    exponent_of_box_[i] = kUnbounded;
    if (!(size < 0x1p999)) continue;
    const int exponent = exponent_of(size);
    exponent_of_box_[i] = static_cast<std::int16_t>(exponent);
    SizeClass& same = histogram[exponent - kLeastExponent];
    ++same.count;
    same.largest = std::max(same.largest, size);
    same.extent = same.extent.cwiseMax(boxes[i].high - boxes[i].low);
  }
  levels.clear();
  scratch.level_of_exponent.assign(histogram.size(), -1);
  for (const Group& group : group_sizes(histogram)) {
    if (group.count <= kFewBoxes) continue;
    for (int e = group.least; e <= group.most; ++e) {
      scratch.level_of_exponent[e - kLeastExponent] = static_cast<std::int16_t>(levels.size());
    }
    levels.emplace_back();
    levels.back().end = group.count;  // only the count, until lay_out() assigns places
    levels.back().cell_m = group.extent;
    // The size that determined the level may be the reach instead of the box.
    int longest = 0;
    group.extent.maxCoeff(&longest);
    levels.back().cell_m[longest] = std::max(group.extent[longest], group.largest);
  }
}

/// Assigns places to levels and loose boxes; returns their number, padding included.
std::uint32_t Levels::lay_out() {
  std::uint32_t place = 0;
  std::uint32_t loose_count = entry_count;
  for (GridLevel& level : levels) {
    const std::uint32_t count = level.end;
    loose_count -= count;
    level.begin = place;
    level.end = place + count;
    place = whole_blocks(level.end + 1);
  }
  loose_begin = place;
  loose_end = place + loose_count;
  return whole_blocks(loose_end);
}

/// Writes the numbers of each level's boxes and of the loose ones into scratch.members, at the level's places.
void Levels::share_out(std::span<const Aabb> boxes, RebuildScratch& scratch) {
  std::vector<std::uint32_t> next;
  for (const GridLevel& level : levels) next.push_back(level.begin);
  next.push_back(loose_begin);
  scratch.members.resize(loose_end);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const std::int16_t exponent = exponent_of_box_[i];
    if (exponent == kEmpty) continue;
    const std::int16_t level =
        exponent == kUnbounded ? std::int16_t{-1} : scratch.level_of_exponent[exponent - kLeastExponent];
    scratch.members[next[level < 0 ? levels.size() : static_cast<std::size_t>(level)]++] =
        static_cast<std::uint32_t>(i);
  }
}

void Levels::set_axes(std::span<const Aabb> boxes, GridLevel& level, std::span<const std::uint32_t> members) {
  Extent extent = all_;
  if (!members.empty()) {
    extent = Extent{};
    for (const std::uint32_t member : members) extent.extend(boxes[member]);
  }
  level.bounds = extent.bounds;
  set_cells(level, reach_of(level.bounds));
  for (int k = 0; k < 3; ++k) {
    level.occupied.low[k] = level.cell_of(k, extent.bounds.low[k]);
    level.occupied.high[k] = level.cell_of(k, extent.highest_low[k]);
    level.axes[k].set(level.occupied.low[k], level.occupied.high[k]);
  }
  const auto bits = [&] { return level.axes[0].bits() + level.axes[1].bits() + level.axes[2].bits(); };
  if (bits() > kMostKeyBits) {
    for (int k = 0; k < 3; ++k) {
      std::vector<Cell> cells;
      cells.reserve(level.count());
      for (std::uint32_t i = 0; i < level.count(); ++i) {
        cells.push_back(level.cell_of(k, boxes[members.empty() ? i : members[i]].low[k]));
      }
      level.axes[k].set(std::move(cells));
    }
    // Only with more than a million boxes: then nearly all cells are occupied by single boxes, so sharing crowds none.
    const int over = bits() - kMostKeyBits;
    for (Axis& axis : level.axes) axis.coarsen(over > 0 ? (over + 2) / 3 : 0);
  }
  level.y_shift = level.axes[0].bits();
  level.z_shift = level.y_shift + level.axes[1].bits();
}

/// Marks places as unused.
void Levels::pad(std::uint32_t from, std::uint32_t to) {
  const Vec3 nowhere = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  for (std::uint32_t place = from; place < to; ++place) store({nowhere, nowhere}, 0, kNoKey, place);
}

template <class Element>
void Levels::fill_level(std::span<const Aabb> boxes, const GridLevel& level, std::span<const std::uint32_t> members,
                        std::vector<Element>& sorted, std::vector<Element>& other) {
  sorted.resize(level.count());
  for (std::uint32_t i = 0; i < level.count(); ++i) {
    const std::uint32_t box = members.empty() ? i : members[i];
    sorted[i] = Element::of(level.key(boxes[box].low), box);
  }
  radix_sort(sorted, other, level.z_shift + level.axes[2].bits());
  for (std::uint32_t i = 0; i < level.count(); ++i) {
    constexpr std::uint32_t kAhead = 16;
    if (i + kAhead < level.count()) {
      const auto* ahead = reinterpret_cast<const char*>(&boxes[sorted[i + kAhead].box()]);
      __builtin_prefetch(ahead);
      __builtin_prefetch(ahead + sizeof(Aabb) - 1);
    }
    store(boxes[sorted[i].box()], sorted[i].box(), sorted[i].key(), level.begin + i);
  }
}

/// Fills the directory: the first place of each bucket of keys, about one bucket per two boxes.
void Levels::index_level(GridLevel& level) {
  level.last_key = keys[level.end - 1];
  level.bucket_shift = 0;
  while (level.last_key >> level.bucket_shift > level.count() / 2) ++level.bucket_shift;
  level.first_bucket = static_cast<std::uint32_t>(directory.size());
  const auto buckets = static_cast<std::uint32_t>(level.last_key >> level.bucket_shift) + 1;
  directory.resize(directory.size() + buckets + 1);
  std::uint32_t* first_of = directory.data() + level.first_bucket;
  std::uint32_t bucket = 0;
  for (std::uint32_t place = level.begin; place < level.end; ++place) {
    const auto own = static_cast<std::uint32_t>(keys[place] >> level.bucket_shift);
    while (bucket <= own) first_of[bucket++] = place;
  }
  first_of[bucket] = level.end;
}

/// Collects the boxes if they are few. A resting scene of many parts has an entry for each, though few move.
bool Levels::are_few(std::span<const Aabb> boxes) {
  few_numbers.clear();
  for (std::uint32_t i = 0; i < boxes.size() && few_numbers.size() <= kSweptBoxes; ++i) {
    if (!boxes[i].empty()) few_numbers.push_back(i);
  }
  return few_numbers.size() <= kSweptBoxes;
}

void Levels::rebuild_few(std::span<const Aabb> boxes, RebuildScratch& scratch) {
  exponent_of_box_.clear();
  scratch.few_boxes.clear();
  for (const std::uint32_t number : few_numbers) scratch.few_boxes.push_back(boxes[number]);
  few.update(scratch.few_boxes);
  levels.clear();
  directory.clear();
  loose_begin = 0;
  loose_end = static_cast<std::uint32_t>(few.size());
  entry_count = loose_end;
  const std::uint32_t place_count = whole_blocks(loose_end + 1);
  make_room(blocks, place_count / kBlock);
  make_room(keys, place_count);
  make_room(numbers, place_count);
  for (std::uint32_t place = 0; place < loose_end; ++place) {
    const std::uint32_t number = few.number(place);
    store(scratch.few_boxes[number], few_numbers[number], kNoKey, place);
  }
  pad(loose_end, place_count);
}

bool Levels::holds(std::uint32_t number) const {
  if (few.size() > 0) return std::binary_search(few_numbers.begin(), few_numbers.end(), number);
  return number < exponent_of_box_.size() && exponent_of_box_[number] != kEmpty;
}

void Levels::rebuild(std::span<const Aabb> boxes, bool for_rays, RebuildScratch& scratch) {
  if (are_few(boxes)) rebuild_few(boxes, scratch);
  else rebuild_many(boxes, scratch);
  if (!for_rays || entry_count <= kFewForTree) {
    tree.reset();
    return;
  }
  if (!tree) tree.emplace();
  tree->rebuild(boxes);
}

void Levels::rebuild_many(std::span<const Aabb> boxes, RebuildScratch& scratch) {
  few.clear();
  choose_levels(boxes, scratch);
  const std::uint32_t place_count = lay_out();
  make_room(blocks, place_count / kBlock);
  make_room(keys, place_count);
  make_room(numbers, place_count);
  const bool all_in_one = levels.size() == 1 && levels[0].count() == boxes.size();
  if (!all_in_one) share_out(boxes, scratch);
  directory.clear();
  for (GridLevel& level : levels) {
    std::span<const std::uint32_t> members;  // empty: every box is a member
    if (!all_in_one) members = std::span(scratch.members).subspan(level.begin, level.count());
    set_axes(boxes, level, members);
    if (level.z_shift + level.axes[2].bits() <= kPackedKeyBits) {
      fill_level(boxes, level, members, scratch.packed, scratch.other_packed);
    } else {
      fill_level(boxes, level, members, scratch.keyed, scratch.other_keyed);
    }
    pad(level.end, whole_blocks(level.end + 1));
    index_level(level);
  }
  for (std::uint32_t i = loose_begin; i < loose_end; ++i)
    store(boxes[scratch.members[i]], scratch.members[i], kNoKey, i);
  pad(loose_end, place_count);
}

std::size_t RebuildScratch::bytes() const {
  return few_boxes.capacity() * sizeof(Aabb) + level_of_exponent.capacity() * sizeof(level_of_exponent[0]) +
         members.capacity() * sizeof(members[0]) + (packed.capacity() + other_packed.capacity()) * sizeof(Packed) +
         (keyed.capacity() + other_keyed.capacity()) * sizeof(Keyed);
}

std::size_t Levels::bytes() const {
  std::size_t bytes = (tree ? tree->bytes() : 0) + few.bytes() + blocks.bytes() + keys.bytes() + numbers.bytes() +
                      directory.capacity() * sizeof(directory[0]) +
                      exponent_of_box_.capacity() * sizeof(exponent_of_box_[0]);
  for (const GridLevel& level : levels) {
    for (const Axis& axis : level.axes) bytes += axis.bytes();
  }
  return bytes;
}

}  // namespace collided::engine::grid
