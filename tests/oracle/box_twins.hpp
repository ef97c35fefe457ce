#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "server/exact_phase/distance/core.hpp"
#include "server/exact_phase/distance/facet_filter.hpp"
#include "server/exact_phase/motion/box_motion_filter.hpp"
#include "server/exact_phase/overlap/box_pair.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::oracle {
using namespace engine;

// The tests of two boxes that the engine runs on several axes or edges at a time, one by one.

inline bool is_plain_length(double x) { return x >= 0x1p-100 && x <= 0x1p100; }

/// Of kernel::quickly_overlaps.
inline Decision plain_overlap(const Box& a, const Box& b, double off_m) {
  using kernel::Triple;
  const kernel::BoxPair pair(a, b);
  const double axis = pair.axis();
  if (!is_plain_length(axis) || !is_plain_length(pair.reach())) return Decision::undecided;
  const double error = (kSeparationError * pair.reach() + 4 * off_m) * axis * axis;
  if (!(std::min(pair.a.volume, pair.b.volume) > kSeparationError * axis * axis * axis)) return Decision::undecided;
  const auto same = [](const Triple& p, const Triple& q, double sign) {
    return p.x == sign * q.x && p.y == sign * q.y && p.z == sign * q.z;
  };
  bool is_apart = false;
  bool is_sure = true;
  pair.for_each_axis([&](int number, const Triple& n, double extent) {
    if (number >= 6) {
      const Triple& p = pair.a.axis[(number - 6) / 3];
      const Triple& q = pair.b.axis[(number - 6) % 3];
      if (same(p, q, 1) || same(p, q, -1)) return true;
    }
    const double gap = std::abs(kernel::dot(pair.between, n)) - extent;
    is_apart = is_apart || gap > error;
    is_sure = is_sure && gap < -error;
    return true;
  });
  if (is_apart) return Decision::no;
  return is_sure ? Decision::yes : Decision::undecided;
}

/// Of kernel::axes_of_least_push for boxes.
inline std::uint32_t plain_least_pushes(const Box& a, const Box& b) {
  const kernel::BoxPair pair(a, b);
  const double error = kernel::kDepthError * pair.reach() * pair.axis() * pair.axis();
  double low[15];
  double least_high = std::numeric_limits<double>::infinity();
  pair.for_each_axis([&](int number, const kernel::Triple& n, double extent) {
    const double square = kernel::dot(n, n);
    const double inverse = 1 / std::sqrt(square);
    const double depth = (extent - std::abs(kernel::dot(pair.between, n))) * inverse;
    const double off = error * inverse;
    const bool is_known = square > 0x1p-400 && square < 0x1p400 && std::isfinite(depth) && std::isfinite(off);
    low[number] = is_known ? depth - off : -std::numeric_limits<double>::infinity();
    if (is_known) least_high = std::min(least_high, depth + off);
    return true;
  });
  std::uint32_t left = 0;
  for (int i = 0; i < 15; ++i) left |= (low[i] <= least_high ? 1u : 0u) << i;
  return left;
}

/// Of kernel::surely_apart for boxes on their motions.
inline bool plain_parted(const kernel::MovingBox& a, const kernel::MovingBox& b) {
  using kernel::Triple;
  const kernel::BoxPair pair(a.at_end, b.at_end);
  const Triple unturned = pair.between - kernel::triple(b.travel - a.travel);
  const Triple before = kernel::triple(b.at_start.center) - kernel::triple(a.at_start.center);
  const double reach = pair.reach() + unturned.largest() + before.largest();
  if (!is_plain_length(reach) || !is_plain_length(pair.axis())) return false;
  const double scale = 4 * pair.axis() * pair.axis();
  const double error = (a.error_m + b.error_m + 0x1p-40 * reach) * scale;
  const double turned = error + (a.turn_m + b.turn_m) * scale;
  const double bent = error + (a.bend_m + b.bend_m) * scale;
  const auto is_apart = [](double first, double last, double extent) {
    return std::min(first, last) > extent || std::max(first, last) < -extent;
  };
  const auto extent_of = [](const Triple& n, const Box& box) {
    double extent = 0;
    for (int i = 0; i < 3; ++i) {
      extent += box.half_m[i] * std::abs(kernel::dot(n, Triple{box.axes(0, i), box.axes(1, i), box.axes(2, i)}));
    }
    return extent;
  };
  return !pair.for_each_axis([&](int, const Triple& n, double extent) {
    const double last = kernel::dot(pair.between, n);
    if (is_apart(kernel::dot(unturned, n), last, extent + turned)) return false;
    if (!(a.turn_m + b.turn_m > 0) || !is_apart(last, last, extent + bent)) return true;
    const double then = extent_of(n, a.at_start) + extent_of(n, b.at_start);
    return !is_apart(kernel::dot(before, n), last, std::max(extent, then) + bent);
  });
}

/// The middle of the part of a segment that lies within {x : |n . (x - centre)| <= reach} for three normals, with the
/// planes in the engine's form.
inline std::optional<Vec3> plain_clipped(const Box& box, double slack_m, const Vec3& from, const Vec3& to) {
  double low = 0;
  double high = 1;
  const auto unit = [](const Vec3& v) { return Vec3(v / std::sqrt(v.squaredNorm())); };
  const Vec3 u[3] = {unit(box.axes.col(0)), unit(box.axes.col(1)), unit(box.axes.col(2))};
  for (int i = 0; i < 3; ++i) {
    const Vec3 n = unit(u[(i + 1) % 3].cross(u[(i + 2) % 3]));
    const double reach = box.half_m[i] * std::abs(n.dot(box.axes.col(i))) + slack_m;
    const double middle = n.dot(box.center);
    const double ends[2][2] = {{n.dot(from) - (middle + reach), n.dot(to) - (middle + reach)},
                               {-n.dot(from) - (-middle + reach), -n.dot(to) - (-middle + reach)}};
    for (const auto& [at_from, at_to] : ends) {
      if (at_from > 0 && at_to > 0) return std::nullopt;
      if (at_from > 0) low = std::max(low, at_from / (at_from - at_to));
      else if (at_to > 0) high = std::min(high, at_from / (at_from - at_to));
    }
  }
  if (low > high) return std::nullopt;
  return Vec3(from + (low + high) / 2 * (to - from));
}

/// Of kernel::middle_of_boxes.
inline std::optional<Vec3> plain_middle(const Box& a, const Box& b, double size_m) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const auto& [own, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const Mat3 reach = own->axes * own->half_m.asDiagonal();
    for (int k = 0; k < 3; ++k) {
      for (int which = 0; which < 4; ++which) {
        const Vec3 middle =
            own->center + (which & 1 ? 1 : -1) * reach.col((k + 1) % 3) + (which & 2 ? 1 : -1) * reach.col((k + 2) % 3);
        const auto clipped = plain_clipped(*other, kClipSlack * size_m, middle - reach.col(k), middle + reach.col(k));
        if (!clipped) continue;
        sum += *clipped;
        ++count;
      }
    }
  }
  if (count == 0 || !sum.allFinite()) return std::nullopt;
  return Vec3(sum / count);
}

}  // namespace collided::oracle
