#include "tests/model/client_plain_boxes.hpp"

#include <fnmatch.h>

#include <algorithm>

namespace collided::model {

bool share_a_point(const PlainBox& a, const PlainBox& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

double gap(const PlainBox& a, const PlainBox& b) {
  return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(Vec3::Zero()).norm();
}

double depth(const PlainBox& a, const PlainBox& b) { return (a.high - b.low).cwiseMin(b.high - a.low).minCoeff(); }

double gap(const Vec3& point, const PlainBox& box) { return gap(PlainBox{point, point}, box); }

std::optional<double> entry(const AxisRay& ray, const PlainBox& box) {
  for (int k = 0; k < 3; ++k) {
    if (k != ray.axis && (ray.origin[k] < box.low[k] || ray.origin[k] > box.high[k])) return std::nullopt;
  }
  const double ahead =
      ray.sign > 0 ? box.low[ray.axis] - ray.origin[ray.axis] : ray.origin[ray.axis] - box.high[ray.axis];
  const double beyond = ahead + box.high[ray.axis] - box.low[ray.axis];
  if (beyond < 0 || ahead > ray.length_m) return std::nullopt;
  return std::max(ahead, 0.0);
}

std::optional<double> first_contact(const PlainBox& moving, int axis, double travel_m, const PlainBox& box) {
  for (int k = 0; k < 3; ++k) {
    if (k != axis && (moving.low[k] > box.high[k] || box.low[k] > moving.high[k])) return std::nullopt;
  }
  const double ahead = travel_m > 0 ? box.low[axis] - moving.high[axis] : moving.low[axis] - box.high[axis];
  const double beyond = travel_m > 0 ? box.high[axis] - moving.low[axis] : moving.high[axis] - box.low[axis];
  if (beyond < 0 || ahead > std::abs(travel_m)) return std::nullopt;
  return std::max(ahead, 0.0) / std::abs(travel_m);
}

std::vector<PlainBox> PlainObject::boxes() const {
  std::vector<PlainBox> placed;
  for (const auto& [center, half] : parts) {
    const Vec3 at = metres(origin) + metres(center);
    placed.push_back({at - metres(half), at + metres(half)});
  }
  return placed;
}

bool may_meet(const PlainObject& a, const PlainObject& b) {
  return (a.layers & b.mask) != 0 && (b.layers & a.mask) != 0 && (a.group == 0 || a.group != b.group);
}

bool share_a_point(const PlainObject& a, const PlainObject& b) {
  const std::vector<PlainBox> of_a = a.boxes(), of_b = b.boxes();
  return std::any_of(of_a.begin(), of_a.end(), [&](const PlainBox& one) {
    return std::any_of(of_b.begin(), of_b.end(), [&](const PlainBox& other) { return share_a_point(one, other); });
  });
}

std::set<PlainBoxes::Pair> PlainBoxes::contacts() const {
  std::set<Pair> pairs;
  for (auto a = objects.begin(); a != objects.end(); ++a) {
    for (auto b = std::next(a); b != objects.end(); ++b) {
      if (a->second.is_scene && b->second.is_scene) continue;
      if (may_meet(a->second, b->second) && share_a_point(a->second, b->second)) pairs.insert({a->first, b->first});
    }
  }
  return pairs;
}

std::map<std::string, std::vector<PlainBox>> PlainBoxes::allowed(const AskOptions& options) const {
  const auto matches = [](const std::string& glob, const std::string& name) {
    return ::fnmatch(glob.c_str(), name.c_str(), 0) == 0;
  };
  std::map<std::string, std::vector<PlainBox>> chosen;
  for (const auto& [name, object] : objects) {
    if ((object.layers & options.mask) == 0) continue;
    if (!options.only.empty() && !matches(options.only, name)) continue;
    if (!options.skip.empty() && matches(options.skip, name)) continue;
    chosen.emplace(name, object.boxes());
  }
  return chosen;
}

std::string sheet(std::array<int, 2> low, std::array<int, 2> high, int z) {
  const auto corner = [&](int x, int y) {
    const Vec3 v = metres({x, y, z});
    return "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
  };
  return "o sheet\n" + corner(low[0], low[1]) + corner(high[0], low[1]) + corner(high[0], high[1]) +
         corner(low[0], high[1]) + "f 1 2 3\nf 1 3 4\n";
}

}  // namespace collided::model
