#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <span>

namespace collided::engine::bvh {

/// Four floats: x, y, z, and a fourth for other data.
using Float4 = Eigen::Array4f;

/// A box in local coordinates; empty at first.
struct FloatBox {
  Float4 low = Float4::Constant(3e38f);
  Float4 high = Float4::Constant(-3e38f);

  void extend(const Float4& other_low, const Float4& other_high) {
    low = low.min(other_low);
    high = high.max(other_high);
  }
  void extend(const FloatBox& other) { extend(other.low, other.high); }
  /// Half the surface; 0 when empty.
  float half_area() const {
    const Float4 size = (high - low).max(0.0f);
    return size[0] * (size[1] + size[2]) + size[1] * size[2];
  }
};

/// A triangle's bounds in local coordinates, rounded outward; its number is stored in the fourth component of low.
struct Primitive {
  Float4 low;
  Float4 high;

  std::uint32_t triangle() const { return std::bit_cast<std::uint32_t>(low[3]); }
};

/// Primitives [begin, end), the bounds of their boxes, and the bounds of the boxes' centres (times two).
struct Range {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  FloatBox bounds;
  FloatBox centers;

  std::uint32_t size() const { return end - begin; }
  void add(const Primitive& primitive) {
    bounds.extend(primitive.low, primitive.high);
    const Float4 center = primitive.low + primitive.high;
    centers.extend(center, center);
  }
};

/// Cuts a range of at least two primitives into two non-empty ones, reordering them: at the plane of least surface-area
/// cost among 16 per axis, or in halves by count if no plane separates or `by_count` is set.
///
/// source  Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007
/// returns the axis along which the right range lies above the left one; 0 after halving by count
int split(std::span<Primitive> primitives, const Range& range, bool by_count, Range& left, Range& right);

}  // namespace collided::engine::bvh
