#include "server/exact_phase/solid/solid_segment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/exact_phase/solid/point_signs.hpp"

namespace collided::engine {
namespace {

/// An exact fraction of the segment: over / under, under > 0.
struct ExactShare {
  Dyadic over;
  Dyadic under = 1.0;

  ParameterBracket bracket() const {
    if (over.sign() == 0) return {0, 0};
    if ((over - under).sign() == 0) return {1, 1};
    const auto [fraction, power] = over.split();
    const auto [divisor, divisor_power] = under.split();
    const long shift = std::clamp(power - divisor_power, -2000L, 2000L);
    const double share = std::ldexp(fraction / divisor, static_cast<int>(shift));
    return {std::max(0.0, share * (1 - 8 * kRoundoff) - kUnderflow),
            std::min(1.0, share * (1 + 8 * kRoundoff) + kUnderflow)};
  }
};

/// over / under for an `under` of any sign but 0.
ExactShare share_of(const Dyadic& over, const Dyadic& under) {
  return under.sign() < 0 ? ExactShare{-over, -under} : ExactShare{over, under};
}

int compare(const ExactShare& a, const ExactShare& b) { return (a.over * b.under - b.over * a.under).sign(); }

}  // namespace

/// One segment's walk through a tree. Its points are defined by the plane in which they lie: doubles with bounds decide
/// nearly all questions about them, and exact numbers are computed only for the rest.
class SolidSegment {
 public:
  SolidSegment(const SolidTree& tree, const Vec3& a, const Vec3& b);

  std::vector<SegmentPart> parts() const;

 private:
  /// Where the segment meets a plane; if that is null, one of its ends.
  struct WayPoint {
    const SplitPlane* plane = nullptr;
    Bounded share;  // along the segment
    Vec3 at = Vec3::Zero();
    double error_m = 0;  // per coordinate
  };
  struct Span {
    SolidSide side;
    WayPoint from;
    WayPoint to;
  };

  /// The point at which the segment meets a plane; its ends must lie on different sides.
  WayPoint meeting(const SplitPlane& plane) const;
  ExactShare exact(const WayPoint& point) const;
  ParameterBracket bracket(const WayPoint& point) const;
  int compare(const WayPoint& a, const WayPoint& b) const;
  /// The side of the plane that the point is on; it must lie in the mesh's bounds.
  int side_of(const SplitPlane& plane, const WayPoint& point) const;
  bool clip(WayPoint& from, WayPoint& to) const;
  SolidSide side_at(std::uint32_t at, const WayPoint& point) const;
  void walk(std::uint32_t at, const WayPoint& from, const WayPoint& to, std::vector<Span>& spans) const;
  void put_together(const std::vector<Span>& front, const std::vector<Span>& back, std::vector<Span>& spans) const;

  const SolidTree& tree_;
  Vec3 a_;
  Vec3 b_;
  std::array<SplitPlane, 6> borders_;  // of the mesh's bounds: the low and the high one of each axis
};

SolidSegment::SolidSegment(const SolidTree& tree, const Vec3& a, const Vec3& b) : tree_(tree), a_(a), b_(b) {
  for (int axis = 0; axis < 3; ++axis) {
    borders_[static_cast<std::size_t>(2 * axis)] = plane_across(axis, tree.bounds_.low[axis]);
    borders_[static_cast<std::size_t>(2 * axis + 1)] = plane_across(axis, tree.bounds_.high[axis]);
  }
}

SolidSegment::WayPoint SolidSegment::meeting(const SplitPlane& plane) const {
  const BoundedPlane rough(*tree_.mesh_, plane);
  const Bounded height = rough.height(a_);
  WayPoint point{.plane = &plane, .share = height / (height - rough.height(b_)), .at = a_, .error_m = 0};
  for (int axis = 0; axis < 3; ++axis) {
    const Bounded along = Bounded(a_[axis]) + point.share * (Bounded(b_[axis]) - Bounded(a_[axis]));
    point.at[axis] = along.value;
    point.error_m = greater_error(point.error_m, along.bound());
  }
  if (point.at.allFinite() && std::isfinite(point.error_m)) return point;
  point.at.setZero();
  point.error_m = std::numeric_limits<double>::infinity();
  return point;
}

ExactShare SolidSegment::exact(const WayPoint& point) const {
  if (point.plane == nullptr) return {point.share.value, 1.0};
  const ExactPlane plane(*tree_.mesh_, *point.plane);
  const Dyadic height = plane.height(a_);
  return share_of(height, height - plane.height(b_));
}

ParameterBracket SolidSegment::bracket(const WayPoint& point) const {
  const Bounded& share = point.share;
  if (point.plane == nullptr) return {share.value, share.value};
  const bool is_sharp = share.bound() <= 8 * kRoundoff * std::abs(share.value);
  if (!is_sharp) return exact(point).bracket();
  return {std::max(0.0, share.low()), std::min(1.0, share.high())};
}

int SolidSegment::compare(const WayPoint& a, const WayPoint& b) const {
  if (a.plane == b.plane && a.share.value == b.share.value) return 0;
  if (a.share.high() < b.share.low()) return -1;
  if (a.share.low() > b.share.high()) return 1;
  return engine::compare(exact(a), exact(b));
}

int SolidSegment::side_of(const SplitPlane& plane, const WayPoint& point) const {
  if (point.plane == &plane) return 0;
  if (const int quick = plane.quick_side(point.at, point.error_m)) return quick;
  if (point.plane == nullptr && !plane.is_across())
    return PlainPoint(point.at).height(tree_.mesh_->triangle(plane.triangle));
  const ExactPlane given(*tree_.mesh_, plane);
  const ExactShare share = exact(point);
  const Dyadic height = given.height(a_);
  return (height * share.under + share.over * (given.height(b_) - height)).sign();
}

/// For a segment within a plane: merges the spans of both halves, `on` where they differ.
void SolidSegment::put_together(const std::vector<Span>& front, const std::vector<Span>& back,
                                std::vector<Span>& spans) const {
  std::size_t i = 0;
  std::size_t k = 0;
  WayPoint from = front.front().from;
  while (i < front.size() && k < back.size()) {
    const int order = compare(front[i].to, back[k].to);
    const WayPoint& to = order <= 0 ? front[i].to : back[k].to;
    spans.push_back({front[i].side == back[k].side ? front[i].side : SolidSide::on, from, to});
    from = to;
    if (order <= 0) ++i;
    if (order >= 0) ++k;
  }
}

/// Clips the segment to the closed bounds of the mesh; false if nothing remains.
bool SolidSegment::clip(WayPoint& from, WayPoint& to) const {
  for (int axis = 0; axis < 3; ++axis) {
    const double begin = a_[axis];
    const double end = b_[axis];
    const double low = tree_.bounds_.low[axis];
    const double high = tree_.bounds_.high[axis];
    if (std::max(begin, end) < low || std::min(begin, end) > high) return false;
    const auto border = [&](bool is_high) -> const SplitPlane& {
      return borders_[static_cast<std::size_t>(2 * axis + (is_high ? 1 : 0))];
    };
    if (begin < low || begin > high) {
      const WayPoint first = meeting(border(begin > high));
      if (compare(first, from) > 0) from = first;
    }
    if (end < low || end > high) {
      const WayPoint last = meeting(border(end > high));
      if (compare(last, to) < 0) to = last;
    }
  }
  return compare(from, to) <= 0;
}

SolidSide SolidSegment::side_at(std::uint32_t at, const WayPoint& point) const {
  while (at < SolidTree::kIn) {
    const SolidTree::SplitNode& node = tree_.nodes_[at];
    const int side = side_of(node.plane, point);
    if (side == 0) {
      const SolidSide front = side_at(node.front, point);
      if (front == SolidSide::on) return front;
      return side_at(node.back, point) == front ? front : SolidSide::on;
    }
    at = side > 0 ? node.front : node.back;
  }
  return at == SolidTree::kIn ? SolidSide::in : SolidSide::out;
}

void SolidSegment::walk(std::uint32_t at, const WayPoint& from, const WayPoint& to, std::vector<Span>& spans) const {
  if (at >= SolidTree::kIn) {
    spans.push_back({at == SolidTree::kIn ? SolidSide::in : SolidSide::out, from, to});
    return;
  }
  const SolidTree::SplitNode& node = tree_.nodes_[at];
  const int begins = side_of(node.plane, from);
  const int ends = side_of(node.plane, to);
  if (begins == 0 && ends == 0) {
    std::vector<Span> front;
    std::vector<Span> back;
    walk(node.front, from, to, front);
    walk(node.back, from, to, back);
    return put_together(front, back, spans);
  }
  const bool begins_in_front = begins != 0 ? begins > 0 : ends > 0;
  const std::uint32_t first = begins_in_front ? node.front : node.back;
  if (begins * ends >= 0) return walk(first, from, to, spans);
  const WayPoint crossing = meeting(node.plane);
  walk(first, from, crossing, spans);
  walk(begins_in_front ? node.back : node.front, crossing, to, spans);
}

std::vector<SegmentPart> SolidSegment::parts() const {
  const WayPoint begin{.plane = nullptr, .share = 0.0, .at = a_, .error_m = 0};
  const WayPoint end{.plane = nullptr, .share = 1.0, .at = b_, .error_m = 0};
  WayPoint from = begin;
  WayPoint to = end;
  if (!clip(from, to)) return {{SolidSide::out, {0, 0}, {1, 1}}};
  if (a_ == b_) return {{side_at(0, begin), {0, 0}, {1, 1}}};
  std::vector<Span> spans;
  if (compare(begin, from) < 0) spans.push_back({SolidSide::out, begin, from});
  if (compare(from, to) < 0) walk(0, from, to, spans);
  if (compare(to, end) < 0) spans.push_back({SolidSide::out, to, end});
  std::vector<SegmentPart> parts;
  const auto put = [&](SolidSide side, const WayPoint& first, const WayPoint& last) {
    parts.push_back({side, bracket(first), bracket(last)});
  };
  // Between two spans there is a point of its own: two that are out may meet at an edge that the segment touches.
  const auto point_between = [&](const Span* before, const Span* after) {
    const WayPoint& t = after != nullptr ? after->from : before->to;
    const bool is_outside = compare(t, from) < 0 || compare(t, to) > 0;
    const SolidSide side = is_outside ? SolidSide::out : side_at(0, t);
    const bool is_alone = (before == nullptr || before->side != side) && (after == nullptr || after->side != side);
    const bool is_border = before != nullptr && after != nullptr && before->side != after->side;
    if (is_alone && !is_border) put(side, t, t);
    return side;
  };
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const Span* before = i == 0 ? nullptr : &spans[i - 1];
    const SolidSide between = point_between(before, &spans[i]);
    const bool goes_on = before != nullptr && before->side == spans[i].side && between == spans[i].side;
    if (goes_on) parts.back().to = bracket(spans[i].to);
    else put(spans[i].side, spans[i].from, spans[i].to);
  }
  point_between(&spans.back(), nullptr);
  return parts;
}

std::vector<SegmentPart> segment_parts(const SolidTree& tree, const Vec3& a, const Vec3& b) {
  return SolidSegment(tree, a, b).parts();
}

}  // namespace collided::engine
