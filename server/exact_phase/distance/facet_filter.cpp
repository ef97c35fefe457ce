#include "server/exact_phase/distance/facet_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/plain_range.hpp"
#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/exact_phase/overlap/box_lanes.hpp"

namespace collided::engine::kernel {
namespace {

/// Differences between two cores, and the extents of both, in plain double.
struct Spread {
  std::array<Triple, 9> between;  // points of a from points of b
  int between_count = 0;
  std::array<Triple, 6> axis;  // of the boxes, with half lengths
  std::array<double, 6> half_m;
  int axis_count = 0;
  double size = 0;

  Spread(const Core& a, const Core& b) {
    for (int i = 0; i < a.point_count; ++i) {
      for (int j = 0; j < b.point_count; ++j) {
        between[between_count] = triple(a.point[i]) - triple(b.point[j]);
        size = std::max(size, between[between_count++].largest());
      }
    }
    for (const Core* core : {&a, &b}) {
      for (int i = 0; core->is_box && i < 3; ++i) {
        axis[axis_count] = {core->axes(0, i), core->axes(1, i), core->axes(2, i)};
        half_m[axis_count] = core->half_m[i];
        size += half_m[axis_count] * axis[axis_count].largest();
        ++axis_count;
      }
    }
  }

  /// Times |n|, as in pushes_along(): the lesser of both directions.
  double push_along(const Triple& n) const {
    double largest = dot(n, between[0]);
    double smallest = largest;
    for (int i = 1; i < between_count; ++i) {
      const double along = dot(n, between[i]);
      largest = std::max(largest, along);
      smallest = std::min(smallest, along);
    }
    double reach = 0;
    for (int i = 0; i < axis_count; ++i) reach += half_m[i] * std::abs(dot(n, axis[i]));
    return reach + std::min(largest, -smallest);
  }
};

Triple difference(const EdgeDirection& edge) { return triple(edge.to) - triple(edge.from); }

}  // namespace

namespace {

/// Collects depths with their errors.
class Depths {
 public:
  /// push: times |n|; error: of the depth, times |n|.
  void add(int number, double push, double square, double error) {
    const double inverse = 1 / std::sqrt(square);
    const double depth = push * inverse;
    const double off = error * inverse;
    // Parallel edges have no reliable normal, and out of range no bound holds: such an axis stays.
    const bool is_known = in_plain_range(square) && std::isfinite(depth) && std::isfinite(off);
    low_[number] = is_known ? depth - off : -std::numeric_limits<double>::infinity();
    if (is_known) least_high_ = std::min(least_high_, depth + off);
  }
  std::uint32_t may_be_least(int count) const {
    std::uint32_t may_be = 0;
    for (int i = 0; i < count; ++i) {
      // Index apart from the shift: g++ 12 with -fsanitize=undefined uses another i for the element than for the shift.
      const std::uint32_t may_be_this = low_[i] <= least_high_ ? 1 : 0;
      may_be |= may_be_this << i;
    }
    return may_be;
  }

 private:
  double low_[15];
  double least_high_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::uint32_t axes_of_least_push(const FacetAxes& axes, const Core& a, const Core& b) {
  if (a.is_box && b.is_box) {
    return least_pushes_in_lanes({a.point[0], a.axes, a.half_m}, {b.point[0], b.axes, b.half_m}, kDepthError);
  }
  Depths depths;
  const Spread spread(a, b);
  for (int i = 0; i < axes.count; ++i) {
    const Triple u = difference(axes.axis[i].u);
    const Triple v = difference(axes.axis[i].v);
    const Triple n = cross(u, v);
    depths.add(i, spread.push_along(n), dot(n, n), kDepthError * spread.size * (u.largest() * v.largest()));
  }
  return depths.may_be_least(axes.count);
}

}  // namespace collided::engine::kernel
