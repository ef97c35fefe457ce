#include "server/intake/tiles/tile_split.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "server/geometry/aabb.hpp"
#include "server/intake/scene.hpp"
#include "server/intake/tiles/tile_format.hpp"

namespace collided::engine {
namespace {

/// Points of a sample: some hundred for each of the tiles of a hundred million triangles.
constexpr std::size_t kSampledPoints = std::size_t{1} << 19;

/// Cells are counted from the origin in whole numbers, which a double holds up to here.
constexpr double kMostCells = 0x1p53;

/// Half of the points are below it. If that many lie in the lowest plane, the others are cut off.
double median_plane(std::span<Vec3> points, Eigen::Index axis, double low) {
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::ranges::nth_element(points, middle, {}, [axis](const Vec3& point) { return point[axis]; });
  if ((*middle)[axis] > low) return (*middle)[axis];
  double plane = std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) {
    if (point[axis] > low) plane = std::min(plane, point[axis]);
  }
  return plane;
}

[[noreturn]] void refuse_size(double size_m, std::string_view why) {
  throw LoadError(fmt::format("tiles of {} m: {}; larger ones, or 'auto', will do. Nothing was written.", size_m, why));
}

}  // namespace

CubeSplit::Cell CubeSplit::cell_of(const Vec3& point) const {
  Cell cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double number = std::floor(point[static_cast<Eigen::Index>(axis)] / size_m_);
    if (!(std::abs(number) < kMostCells))
      refuse_size(size_m_, fmt::format("too small for a coordinate of {} m", point[static_cast<Eigen::Index>(axis)]));
    cell[axis] = static_cast<std::int64_t>(number);
  }
  return cell;
}

void CubeSplit::see(const Vec3& point) {
  const Cell cell = cell_of(point);
  if (cell == last_ && !tiles_.empty()) return;
  last_ = cell;
  if (tiles_.try_emplace(cell, 0).second && tiles_.size() > kMostTiles)
    refuse_size(size_m_, fmt::format("more than {} of them", kMostTiles));
}

void CubeSplit::finish() {
  std::uint32_t number = 0;
  for (auto& [cell, tile] : tiles_) tile = number++;
}

std::uint32_t CubeSplit::tile_of(const Vec3& point) const { return tiles_.at(cell_of(point)); }

void MedianSplit::see(const Vec3& point) {
  ++seen_;
  if (sample_.size() < kSampledPoints) return sample_.push_back(point);
  // Vitter, "Random sampling with a reservoir", 1985: each point is in the sample with equal probability.
  const std::uint64_t place = random_() % seen_;
  if (place < kSampledPoints) sample_[place] = point;
}

void MedianSplit::finish() {
  if (sample_.empty()) return;
  split(sample_, static_cast<double>(seen_) / static_cast<double>(sample_.size()));
  sample_ = {};
  if (leaf_count_ > kMostTiles)
    throw LoadError(
        fmt::format("{} tiles, limit {}: it has too many triangles. Nothing was written.", leaf_count_, kMostTiles));
}

/// Returns the number of the node.
std::uint32_t MedianSplit::split(std::span<Vec3> points, double points_each) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Aabb box;
  for (const Vec3& point : points) box.extend(point);
  Eigen::Index axis = 0;
  // Halved, since the difference of two finite numbers may overflow.
  const double side_m = (box.high / 2 - box.low / 2).maxCoeff(&axis);
  if (side_m == 0 || static_cast<double>(points.size()) * points_each <= static_cast<double>(most_points_)) {
    nodes_[number].lower = leaf_count_++;
    return number;
  }
  const double plane = median_plane(points, axis, box.low[axis]);
  const auto upper = std::ranges::partition(points, [&](const Vec3& point) { return point[axis] < plane; });
  const auto below = static_cast<std::size_t>(upper.begin() - points.begin());
  const std::uint32_t lower_node = split(points.first(below), points_each);
  const std::uint32_t upper_node = split(points.subspan(below), points_each);
  nodes_[number] = {.plane = plane, .axis = static_cast<std::int32_t>(axis), .lower = lower_node, .upper = upper_node};
  return number;
}

std::uint32_t MedianSplit::tile_of(const Vec3& point) const {
  std::uint32_t at = 0;
  while (nodes_[at].axis >= 0) {
    const CutNode& node = nodes_[at];
    at = point[node.axis] < node.plane ? node.lower : node.upper;
  }
  return nodes_[at].lower;
}

}  // namespace collided::engine
