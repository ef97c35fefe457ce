#include "server/broad_phase/hierarchy/bvh_split.hpp"

#include <array>
#include <utility>

namespace collided::engine::bvh {
namespace {

constexpr int kBins = 16;
/// A leaf of eight costs one SIMD test however full it is, so cost counts groups of triangles.
constexpr std::uint32_t kGroup = 8;

struct Bin {
  FloatBox bounds;
  std::uint32_t count = 0;
};

struct Plane {
  int axis = -1;  // -1: no plane separates
  int first_right_bin = 0;
};

/// The bin into which a primitive's centre falls, on each axis.
struct Binning {
  Float4 low;
  Float4 scale;

  explicit Binning(const FloatBox& centers) : low(centers.low) {
    const Float4 size = centers.high - centers.low;
    for (int axis = 0; axis < 3; ++axis) {
      // Slightly below the number of bins, so that the highest centre lands in the last.
      scale[axis] = size[axis] > 1e-30f ? 0.9999f * static_cast<float>(kBins) / size[axis] : 0.0f;
    }
    scale[3] = 0;
  }
  Eigen::Array4i of(const Primitive& primitive) const {
    return ((primitive.low + primitive.high - low) * scale).cast<int>();
  }
  int of(const Primitive& primitive, int axis) const {
    return static_cast<int>((primitive.low[axis] + primitive.high[axis] - low[axis]) * scale[axis]);
  }
};

using Bins = std::array<std::array<Bin, kBins>, 3>;

float groups(std::uint32_t count) {
  const std::uint32_t full_or_begun = (count + kGroup - 1) / kGroup;
  return static_cast<float>(full_or_begun);
}

Plane best_plane(const Bins& bins, const Binning& binning) {
  Plane best;
  float best_cost = 3e38f;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(binning.scale[axis] > 0)) continue;
    std::array<float, kBins> right_cost{};
    FloatBox box;
    std::uint32_t count = 0;
    for (int i = kBins - 1; i > 0; --i) {
      box.extend(bins[axis][i].bounds);
      count += bins[axis][i].count;
      right_cost[i] = count == 0 ? -1 : box.half_area() * groups(count);
    }
    box = FloatBox{};
    count = 0;
    for (int i = 1; i < kBins; ++i) {
      box.extend(bins[axis][i - 1].bounds);
      count += bins[axis][i - 1].count;
      if (count == 0 || right_cost[i] < 0) continue;
      const float cost = box.half_area() * groups(count) + right_cost[i];
      if (cost < best_cost) {
        best_cost = cost;
        best = {axis, i};
      }
    }
  }
  return best;
}

void halve(std::span<const Primitive> primitives, const Range& range, Range& left, Range& right) {
  const std::uint32_t middle = range.begin + range.size() / 2;
  left = {range.begin, middle, {}, {}};
  right = {middle, range.end, {}, {}};
  for (std::uint32_t i = range.begin; i < middle; ++i) left.add(primitives[i]);
  for (std::uint32_t i = middle; i < range.end; ++i) right.add(primitives[i]);
}

}  // namespace

int split(std::span<Primitive> primitives, const Range& range, bool by_count, Range& left, Range& right) {
  const Binning binning(range.centers);
  Plane plane;
  if (!by_count) {
    Bins bins;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const Primitive& primitive = primitives[i];
      const Eigen::Array4i bin = binning.of(primitive);
      for (int axis = 0; axis < 3; ++axis) {
        bins[axis][bin[axis]].bounds.extend(primitive.low, primitive.high);
        ++bins[axis][bin[axis]].count;
      }
    }
    plane = best_plane(bins, binning);
  }
  if (plane.axis < 0) {
    halve(primitives, range, left, right);
    return 0;
  }
  left = {range.begin, range.begin, {}, {}};
  right = {range.end, range.end, {}, {}};
  while (left.end < right.begin) {
    Primitive& primitive = primitives[left.end];
    if (binning.of(primitive, plane.axis) < plane.first_right_bin) {
      left.add(primitive);
      ++left.end;
    } else {
      right.add(primitive);
      std::swap(primitive, primitives[--right.begin]);
    }
  }
  return plane.axis;
}

}  // namespace collided::engine::bvh
