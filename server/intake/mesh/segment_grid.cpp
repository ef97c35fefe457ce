#include "server/intake/mesh/segment_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "server/intake/mixed.hpp"

namespace collided::engine {
namespace {

/// Most levels: each halves the cells of the one before. Cell numbers then fit 64 bits easily.
constexpr int kMostHalvings = 40;

}  // namespace

SegmentGrid::Cell SegmentGrid::cell_of(const Level& level, const Vec3& point) const {
  const auto number = [&](int axis) {
    return static_cast<std::int64_t>(std::floor(std::ldexp(point[axis] - origin_[axis], -level.power)));
  };
  return {number(0), number(1), number(2)};
}

std::uint64_t SegmentGrid::key_of(const Level& level, const Cell& cell) {
  std::uint64_t key = mixed(static_cast<std::uint64_t>(level.power));
  for (const std::int64_t number : {cell.x, cell.y, cell.z}) key = mixed(key + static_cast<std::uint64_t>(number));
  return key;
}

SegmentGrid::SegmentGrid(std::span<const MeshSegment> segments, const Aabb& bounds, double reach_m)
    : origin_(bounds.empty() ? Vec3::Zero() : bounds.low), reach_m_(reach_m) {
  const double diagonal_m = bounds.empty() ? 1 : (bounds.high - bounds.low).norm();
  const int least_power = std::ilogb(std::max(diagonal_m, std::numeric_limits<double>::min())) - kMostHalvings;
  std::vector<Entry> entries;
  entries.reserve(4 * segments.size());
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    const Vec3 low = segments[i].a.cwiseMin(segments[i].b).array() - reach_m;
    const Vec3 high = segments[i].a.cwiseMax(segments[i].b).array() + reach_m;
    const double size_m = std::max((high - low).maxCoeff(), std::numeric_limits<double>::min());
    const Level level{std::max(std::ilogb(size_m) + 1, least_power)};
    const auto known =
        std::find_if(levels_.begin(), levels_.end(), [&](const Level& l) { return l.power == level.power; });
    if (known == levels_.end()) levels_.push_back(level);
    const Cell first = cell_of(level, low);
    const Cell last = cell_of(level, high);
    for (std::int64_t x = first.x; x <= last.x; ++x) {
      for (std::int64_t y = first.y; y <= last.y; ++y) {
        for (std::int64_t z = first.z; z <= last.z; ++z) entries.push_back({key_of(level, {x, y, z}), i});
      }
    }
  }
  mask_ = std::bit_ceil(entries.size() + 1) - 1;
  starts_.assign(mask_ + 2, 0);
  for (const Entry& entry : entries) ++starts_[(entry.key & mask_) + 1];
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  entries_.resize(entries.size());
  std::vector<std::uint32_t> places(starts_.begin(), starts_.end() - 1);
  for (const Entry& entry : entries) entries_[places[entry.key & mask_]++] = entry;
}

}  // namespace collided::engine
