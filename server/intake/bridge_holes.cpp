#include "server/intake/bridge_holes.hpp"

#include <algorithm>

#include "server/intake/limits.hpp"
#include "server/intake/planar.hpp"

namespace collided {
namespace {

using Ring = std::vector<std::uint32_t>;

/// The coordinate plane that sees most of a ring.
class Plane {
 public:
  Plane(const Ring& ring, const std::vector<Vec3>& vertices) : vertices_(vertices) {
    const Vec3 normal = area(ring);
    normal.cwiseAbs().maxCoeff(&drop_);
    is_left_ = normal[drop_] > 0;
  }

  PlanePoint operator()(std::uint32_t corner) const {
    return {vertices_[corner][(drop_ + 1) % 3], vertices_[corner][(drop_ + 2) % 3]};
  }
  bool turns_left(const Ring& ring) const { return area(ring)[drop_] > 0; }
  bool is_left() const { return is_left_; }

 private:
  /// source    Newell's normal: Sutherland, Sproull, Schumacker, 1974
  Vec3 area(const Ring& ring) const {
    Vec3 sum = Vec3::Zero();
    const Vec3& origin = vertices_[ring[0]];
    for (std::size_t i = 0; i < ring.size(); ++i) {
      sum += (vertices_[ring[i]] - origin).cross(vertices_[ring[(i + 1) % ring.size()]] - origin);
    }
    return sum;
  }

  const std::vector<Vec3>& vertices_;
  int drop_ = 0;
  bool is_left_ = true;
};

bool within(double a, double x, double b) { return (a <= x && x <= b) || (b <= x && x <= a); }

/// The closed segment a b has a point of the closed segment c d, other than an end that both share.
bool blocks(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  if (a == c || a == d || b == c || b == d) return false;
  const int c_side = turn(a, b, c);
  const int d_side = turn(a, b, d);
  const int a_side = turn(c, d, a);
  const int b_side = turn(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  const auto on = [](int side, const PlanePoint& p, const PlanePoint& q, const PlanePoint& r) {
    return side == 0 && within(p[0], r[0], q[0]) && within(p[1], r[1], q[1]);
  };
  return on(c_side, a, b, c) || on(d_side, a, b, d) || on(a_side, c, d, a) || on(b_side, c, d, b);
}

class Bridges {
 public:
  Bridges(std::span<const Ring> rings, const std::vector<Vec3>& vertices)
      : plane_(rings[0], vertices), ring_(rings[0]), holes_(rings.begin() + 1, rings.end()) {
    for (Ring& hole : holes_) {
      if (plane_.turns_left(hole) == plane_.is_left()) std::reverse(hole.begin(), hole.end());
    }
    // The outermost along one axis first: nothing of the other holes lies between it and the ring there.
    const auto reach = [&](const Ring& hole) {
      double most = plane_(hole[0])[0];
      for (const std::uint32_t corner : hole) most = std::max(most, plane_(corner)[0]);
      return most;
    };
    std::stable_sort(holes_.begin(), holes_.end(), [&](const Ring& a, const Ring& b) { return reach(a) > reach(b); });
  }

  Bridging run(Ring& ring) {
    for (std::size_t i = 0; i < holes_.size(); ++i) {
      if (!join(i)) return test_count_ > kMaxBridgeTests ? Bridging::too_long : Bridging::no_bridge;
    }
    ring = std::move(ring_);
    return Bridging::done;
  }

 private:
  bool join(std::size_t hole_number) {
    Ring& hole = holes_[hole_number];
    const auto first = std::max_element(hole.begin(), hole.end(),
                                        [&](std::uint32_t a, std::uint32_t b) { return plane_(a)[0] < plane_(b)[0]; });
    std::rotate(hole.begin(), first, hole.end());
    const PlanePoint from = plane_(hole[0]);
    std::vector<std::pair<double, std::size_t>> corners;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const PlanePoint to = plane_(ring_[i]);
      corners.emplace_back((to[0] - from[0]) * (to[0] - from[0]) + (to[1] - from[1]) * (to[1] - from[1]), i);
    }
    std::sort(corners.begin(), corners.end());
    for (const auto& [distance2, i] : corners) {
      if (test_count_ > kMaxBridgeTests) return false;
      if (!opens_to(i, from) || !is_free(from, plane_(ring_[i]), hole_number)) continue;
      // There, once round the hole, and back.
      Ring bridge(hole);
      bridge.push_back(hole[0]);
      bridge.push_back(ring_[i]);
      ring_.insert(ring_.begin() + static_cast<std::ptrdiff_t>(i) + 1, bridge.begin(), bridge.end());
      return true;
    }
    return false;
  }

  /// From the ring's corner the point is seen on the polygon's side. A bridge's end stands in the ring twice, and only
  /// one of the two sees it.
  bool opens_to(std::size_t i, const PlanePoint& point) const {
    const PlanePoint before = plane_(ring_[(i + ring_.size() - 1) % ring_.size()]);
    const PlanePoint here = plane_(ring_[i]);
    const PlanePoint after = plane_(ring_[(i + 1) % ring_.size()]);
    if (here == point) return true;
    const int sign = plane_.is_left() ? 1 : -1;
    const bool left_of_first = sign * turn(before, here, point) > 0;
    const bool left_of_second = sign * turn(here, after, point) > 0;
    return sign * turn(before, here, after) > 0 ? left_of_first && left_of_second : left_of_first || left_of_second;
  }

  bool is_free(const PlanePoint& from, const PlanePoint& to, std::size_t first_hole) {
    if (crosses(from, to, ring_)) return false;
    for (std::size_t i = first_hole; i < holes_.size(); ++i) {
      if (crosses(from, to, holes_[i])) return false;
    }
    return true;
  }

  bool crosses(const PlanePoint& from, const PlanePoint& to, const Ring& ring) {
    test_count_ += ring.size();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      if (blocks(from, to, plane_(ring[i]), plane_(ring[(i + 1) % ring.size()]))) return true;
    }
    return false;
  }

  Plane plane_;
  Ring ring_;
  std::vector<Ring> holes_;
  std::uint64_t test_count_ = 0;
};

}  // namespace

Bridging bridge_holes(std::span<const std::vector<std::uint32_t>> rings, const std::vector<Vec3>& vertices,
                      std::vector<std::uint32_t>& ring) {
  return Bridges(rings, vertices).run(ring);
}

}  // namespace collided
