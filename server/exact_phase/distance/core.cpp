#include "server/exact_phase/distance/core.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "server/exact_phase/distance/box_middle.hpp"
#include "server/exact_phase/distance/nearest_value.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

/// The directions of a core's edges; returns how many.
int edge_directions(const Core& core, EdgeDirection* edges) {
  if (core.is_box) {
    for (int i = 0; i < 3; ++i) edges[i] = {core.axes.col(i), Vec3::Zero()};
    return 3;
  }
  if (core.point_count == 1) return 0;
  edges[0] = {core.point[1], core.point[0]};
  if (core.point_count == 2) return 1;
  edges[1] = {core.point[2], core.point[1]};
  edges[2] = {core.point[0], core.point[2]};
  return 3;
}

void append(FacetAxes& axes, const EdgeDirection& u, const EdgeDirection& v) { axes.axis[axes.count++] = {u, v}; }

struct Edge {
  Vec3 a;
  Vec3 b;
};

/// Up to `Capacity` items, on the stack: contacts are computed while a request waits, so nothing is allocated.
template <class T, int Capacity>
class Few {
 public:
  void push_back(const T& item) { items_[count_++] = item; }
  bool empty() const { return count_ == 0; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + count_; }

 private:
  std::array<T, Capacity> items_;
  int count_ = 0;
};

using Edges = Few<Edge, 12>;

Edges edges_of(const Core& core) {
  Edges edges;
  if (core.is_box) {
    const Mat3 reach = core.axes * core.half_m.asDiagonal();
    for (int k = 0; k < 3; ++k) {
      for (int which = 0; which < 4; ++which) {
        const Vec3 middle = core.point[0] + (which & 1 ? 1 : -1) * reach.col((k + 1) % 3) +
                            (which & 2 ? 1 : -1) * reach.col((k + 2) % 3);
        edges.push_back({middle - reach.col(k), middle + reach.col(k)});
      }
    }
  } else if (core.point_count == 1) {
    edges.push_back({core.point[0], core.point[0]});
  } else if (core.point_count == 2) {
    edges.push_back({core.point[0], core.point[1]});
  } else {
    for (int i = 0; i < 3; ++i) edges.push_back({core.point[i], core.point[(i + 1) % 3]});
  }
  return edges;
}

/// {x : -back_offset <= normal . x <= offset}; a few of them bound a core.
struct CoreSlab {
  Vec3 normal;
  double offset;
  double back_offset = std::numeric_limits<double>::infinity();
};

using Slabs = Few<CoreSlab, 4>;

/// The slabs that bound a core, grown by the slack of clipping; none for points and segments.
Slabs slabs_of(const Core& core, double size_m) {
  Slabs slabs;
  const double slack = kClipSlack * size_m;
  if (core.is_box) {
    const Vec3 along[3] = {unit(Vec3(core.axes.col(0))), unit(Vec3(core.axes.col(1))), unit(Vec3(core.axes.col(2)))};
    for (int i = 0; i < 3; ++i) {
      const Vec3 normal = unit(Vec3(along[(i + 1) % 3].cross(along[(i + 2) % 3])));
      const double reach = core.half_m[i] * std::abs(normal.dot(core.axes.col(i))) + slack;
      const double middle = normal.dot(core.point[0]);
      slabs.push_back({normal, middle + reach, -middle + reach});
    }
  } else if (core.point_count == 3) {
    const Vec3 normal = any_normal(Triangle{core.point[0], core.point[1], core.point[2]});
    const double middle = normal.dot(core.point[0]);
    slabs.push_back({normal, middle + slack, -middle + slack});
    for (int i = 0; i < 3; ++i) {
      const Vec3 outward = unit(Vec3(unit(Vec3(core.point[(i + 1) % 3] - core.point[i])).cross(normal)));
      slabs.push_back({outward, outward.dot(core.point[i]) + slack});
    }
  }
  return slabs;
}

/// How far an edge's ends are beyond each plane of some slabs, and which are (Cohen and Sutherland's outcodes): these
/// alone show that most edges are outside or inside, without a branch for each plane.
struct EdgeSides {
  double at_a[8];
  double at_b[8];
  unsigned a_beyond = 0;  // one bit per plane
  unsigned b_beyond = 0;

  EdgeSides(const Edge& edge, const Slabs& slabs) {
    int plane = 0;
    for (const CoreSlab& slab : slabs) {
      const double a = slab.normal.dot(edge.a);
      const double b = slab.normal.dot(edge.b);
      add(plane++, a - slab.offset, b - slab.offset);
      add(plane++, -a - slab.back_offset, -b - slab.back_offset);
    }
  }

 private:
  void add(int plane, double a, double b) {
    at_a[plane] = a;
    at_b[plane] = b;
    a_beyond |= (a > 0 ? 1u : 0u) << plane;
    b_beyond |= (b > 0 ? 1u : 0u) << plane;
  }
};

/// The middle of the part of an edge that lies in all slabs; false if there is none.
bool clipped_middle(const Edge& edge, const Slabs& slabs, Vec3& middle) {
  const EdgeSides sides(edge, slabs);
  if ((sides.a_beyond & sides.b_beyond) != 0) return false;
  double low = 0;
  double high = 1;
  for (unsigned beyond = sides.a_beyond | sides.b_beyond; beyond != 0; beyond &= beyond - 1) {
    const int plane = std::countr_zero(beyond);
    const double at = sides.at_a[plane] / (sides.at_a[plane] - sides.at_b[plane]);
    if (sides.at_a[plane] > 0) low = std::max(low, at);
    else high = std::min(high, at);
  }
  if (low > high) return false;
  middle = edge.a + (low + high) / 2 * (edge.b - edge.a);
  return true;
}

/// The point of a core farthest along n.
Vec3 farthest_along(const Core& core, const Vec3& n) {
  Vec3 best = core.point[0];
  for (int i = 1; i < core.point_count; ++i) {
    if (n.dot(core.point[i]) > n.dot(best)) best = core.point[i];
  }
  for (int i = 0; core.is_box && i < 3; ++i) {
    const Vec3 axis = core.axes.col(i);
    // A face perpendicular to n counts with its middle, not with one of its corners.
    const double along = n.dot(axis);
    if (std::abs(along) > kClipSlack * axis.norm()) best += std::copysign(core.half_m[i], along) * axis;
  }
  return best;
}

/// Nearest points of two segments (Ericson 5.1.9), with parameters clamped to [0, 1].
WitnessPair nearest_on_edges(const Edge& s, const Edge& t) {
  const Vec3 d = s.b - s.a;
  const Vec3 e = t.b - t.a;
  const Vec3 w = s.a - t.a;
  const double dd = d.squaredNorm();
  const double ee = e.squaredNorm();
  const double de = d.dot(e);
  const double dw = d.dot(w);
  const double ew = e.dot(w);
  const double determinant = dd * ee - de * de;
  double u = determinant > 0 ? std::clamp((de * ew - dw * ee) / determinant, 0.0, 1.0) : 0.0;
  double v = ee > 0 ? std::clamp((de * u + ew) / ee, 0.0, 1.0) : 0.0;
  u = dd > 0 ? std::clamp((de * v - dw) / dd, 0.0, 1.0) : 0.0;
  v = ee > 0 ? std::clamp((de * u + ew) / ee, 0.0, 1.0) : 0.0;
  return {s.a + u * d, t.a + v * e};
}

}  // namespace

double extent(const Core& core) {
  double largest = 0;
  for (int i = 0; i < core.point_count; ++i) largest = std::max(largest, core.point[i].cwiseAbs().maxCoeff());
  return core.is_box ? largest + core.span_m : largest;
}

void scale(Core& core, int power) {
  const auto scale_vector = [power](Vec3& v) {
    for (double& x : v) x = std::ldexp(x, power);
  };
  for (Vec3& point : core.point) scale_vector(point);
  scale_vector(core.half_m);
  if (core.is_box) core.measure();
  core.radius_m = std::ldexp(core.radius_m, power);
}

FacetAxes facet_axes(const Core& a, const Core& b) {
  FacetAxes axes;
  EdgeDirection edge_a[3];
  EdgeDirection edge_b[3];
  const int count_a = edge_directions(a, edge_a);
  const int count_b = edge_directions(b, edge_b);
  if (a.is_box)
    for (int i = 0; i < 3; ++i) append(axes, edge_a[(i + 1) % 3], edge_a[(i + 2) % 3]);
  else if (count_a == 3) append(axes, edge_a[0], edge_a[1]);
  if (b.is_box)
    for (int i = 0; i < 3; ++i) append(axes, edge_b[(i + 1) % 3], edge_b[(i + 2) % 3]);
  else if (count_b == 3) append(axes, edge_b[0], edge_b[1]);
  for (int i = 0; i < count_a; ++i) {
    for (int j = 0; j < count_b; ++j) append(axes, edge_a[i], edge_b[j]);
  }
  return axes;
}

FacetAxis facet_axis_of_boxes(const Core& a, const Core& b, int number) {
  const auto edge = [](const Core& box, int i) { return EdgeDirection{box.axes.col(i % 3), Vec3::Zero()}; };
  if (number < 3) return {edge(a, number + 1), edge(a, number + 2)};
  if (number < 6) return {edge(b, number + 1), edge(b, number + 2)};
  return {edge(a, (number - 6) / 3), edge(b, number - 6)};
}

Vec3 middle_of_both(const Core& a, const Core& b, const Vec3& normal) {
  if (!a.is_box && a.point_count == 1) return a.point[0];
  if (!b.is_box && b.point_count == 1) return b.point[0];
  const double size_m = extent(a) + extent(b);
  if (a.is_box && b.is_box) {
    if (const std::optional<Vec3> middle = middle_of_boxes(a, b, size_m)) return *middle;
  }
  const std::array<const Core*, 2> cores{&a, &b};
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int side = 0; side < 2; ++side) {
    const Slabs slabs = slabs_of(*cores[1 - side], size_m);
    if (slabs.empty()) continue;
    for (const Edge& edge : edges_of(*cores[side])) {
      Vec3 middle;
      if (!clipped_middle(edge, slabs, middle)) continue;
      sum += middle;
      ++count;
    }
  }
  if (count > 0 && sum.allFinite()) return sum / count;
  if (a.point_count == 2 && b.point_count == 2) {
    const WitnessPair pair = nearest_witnesses(a, b);
    return pair.on_a / 2 + pair.on_b / 2;
  }
  return farthest_along(a, normal) / 2 + farthest_along(b, -normal) / 2;
}

WitnessPair nearest_witnesses(const Core& a, const Core& b) {
  WitnessPair best;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const WitnessPair& pair) {
    const double distance2 = (pair.on_a - pair.on_b).squaredNorm();
    if (!(distance2 < least)) return;
    least = distance2;
    best = pair;
  };
  for (const Edge& edge_a : edges_of(a)) {
    for (const Edge& edge_b : edges_of(b)) consider(nearest_on_edges(edge_a, edge_b));
  }
  for (int i = 0; i < b.point_count; ++i) {
    if (a.is_box) {
      const Box box{a.point[0], a.axes, a.half_m};
      consider({nearest_value(b.point[i], box).foot, b.point[i]});
    } else if (a.point_count == 3) {
      consider({nearest_value(b.point[i], Triangle{a.point[0], a.point[1], a.point[2]}).foot, b.point[i]});
    }
  }
  return best;
}

}  // namespace collided::engine::kernel
