#include "client/fleet/shards/question_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace collided::client {
namespace {

using shards::ShardBox;
using shards::ShardMap;
using shards::ShardSet;

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<double>::max();
/// Relative: thousands of the roundings that it is put on.
constexpr double kSlack = 0x1p-40;
/// Of a unit vector's component: below it a quotient by it says nothing.
constexpr double kLeastComponent = 0x1p-900;

double down(double length) { return length - std::abs(length) * kSlack; }
double up(double length) { return length + std::abs(length) * kSlack; }

/// Between which lengths along the ray it is within the box's two planes of one axis, rounded outward.
struct RayStretch {
  double from = -kEndless;
  double to = kEndless;
};

RayStretch within_planes(double low, double high, double origin, double direction) {
  if (direction == 0) return origin < low || origin > high ? RayStretch{kEndless, -kEndless} : RayStretch{};
  // So slow along this axis that a length beyond all numbers may reach the planes.
  if (std::abs(direction) < kLeastComponent)
    return origin < low || origin > high ? RayStretch{0, kEndless} : RayStretch{};
  double first = (low - origin) / direction;
  double last = (high - origin) / direction;
  if (first > last) std::swap(first, last);
  // A length that is no number any more may be a little beyond the largest one.
  const bool is_far = std::isinf(first) && first > 0 && std::isfinite(direction > 0 ? low : high);
  return {is_far ? kLargest : down(first), up(last)};
}

Vec3 unit_of(const Vec3& direction) {
  const Vec3 scaled = direction / direction.cwiseAbs().maxCoeff();
  return scaled / scaled.norm();
}

ShardBox box_around(const Vec3& center, const Vec3& half_m) {
  const ShardBox point{{center.x(), center.y(), center.z()}, {center.x(), center.y(), center.z()}};
  ShardBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const ShardBox grown_box = grown(point, half_m[static_cast<Eigen::Index>(axis)]);
    box.low[axis] = grown_box.low[axis];
    box.high[axis] = grown_box.high[axis];
  }
  return box;
}

template <class Entry>
ShardSet where_entered(const ShardMap& map, const Entry& enters) {
  ShardSet touched = 0;
  for (std::size_t place = 0; place < map.size(); ++place) touched |= ShardSet{enters(map.at(place).box)} << place;
  return touched & map.all();
}

}  // namespace

std::optional<double> entry_m(const ShardBox& box, const RayQuestion& ray) {
  const Vec3 unit = unit_of(ray.direction);
  double from = 0;
  double to = ray.length_m;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    const bool is_along = ray.direction[at] != 0;
    // A component that underflows is no zero.
    const double along = is_along && unit[at] == 0 ? kLeastComponent / 2 : unit[at];
    const RayStretch within = within_planes(box.low[axis], box.high[axis], ray.origin[at], along);
    from = std::max(from, within.from);
    to = std::min(to, within.to);
  }
  if (from > to) return std::nullopt;
  return from;
}

double entry_m(const ShardBox& box, const NearQuestion& near) {
  Vec3 out = Vec3::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    out[at] = std::max({0.0, box.low[axis] - near.point[at], near.point[at] - box.high[axis]});
  }
  const double largest = out.maxCoeff();
  if (largest == 0) return 0;
  const double distance = largest * (out / largest).norm();
  return std::isfinite(distance) ? down(distance) : kLargest;
}

Vec3 entry_point(const ShardBox& box, const RayQuestion& ray) {
  const double along = entry_m(box, ray).value_or(0);
  return along == 0 ? ray.origin : Vec3(ray.origin + along * unit_of(ray.direction));
}

Vec3 entry_point(const ShardBox& box, const Vec3& beginning) {
  const Vec3 low(box.low.data());
  const Vec3 high(box.high.data());
  return beginning.cwiseMax(low).cwiseMin(high);
}

ShardSet touched_shards(const ShardMap& map, const RayQuestion& ray) {
  return where_entered(map, [&](const ShardBox& box) { return entry_m(box, ray).has_value(); });
}

ShardSet touched_shards(const ShardMap& map, const SphereQuestion& sphere) {
  return map.touched_by(box_around(sphere.center, Vec3::Constant(sphere.radius_m)));
}

ShardSet touched_shards(const ShardMap& map, const BoxQuestion& box) {
  const bool is_turned = box.rotation.vec() != Vec3::Zero();
  if (!is_turned) return map.touched_by(box_around(box.center, box.half_m));
  const Eigen::Matrix3d axes = box.rotation.normalized().toRotationMatrix().cwiseAbs();
  return map.touched_by(
      box_around(box.center, (axes * box.half_m) * (1 + kSlack) + Vec3::Constant(kSlack * box.half_m.sum())));
}

ShardSet touched_shards(const ShardMap& map, const NearQuestion& near) {
  return where_entered(map, [&](const ShardBox& box) { return entry_m(box, near) <= near.within_m; });
}

ShardSet touched_shards(const ShardMap& map, const InsideQuestion& inside) {
  return ShardSet{1} << map.owner_of({inside.point.x(), inside.point.y(), inside.point.z()});
}

}  // namespace collided::client
