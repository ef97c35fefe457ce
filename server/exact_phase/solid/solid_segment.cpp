#include "server/exact_phase/solid/solid_segment.hpp"

#include <algorithm>
#include <cmath>

namespace collided::engine {
namespace {

/// A share of the way, exactly: over / under, under > 0.
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

struct Span {
  SolidSide side;
  ExactShare from;
  ExactShare to;
};

}  // namespace

/// One segment's way through a tree.
class SolidSegment {
 public:
  SolidSegment(const SolidTree& tree, const Vec3& a, const Vec3& b) : tree_(tree), a_(a), b_(b) {}

  std::vector<SegmentPart> parts() const;

 private:
  /// Heights of both ends over a plane, of which only the signs and the quotient matter.
  struct Heights {
    Dyadic a;
    Dyadic b;
    /// At a share of the way; its sign alone.
    int sign_at(const ExactShare& t) const { return (a * t.under + t.over * (b - a)).sign(); }
  };
  Heights heights(const SolidTree::SplitNode& node) const {
    const ExactPlane plane(*tree_.mesh_, node.plane);
    return {plane.height(a_), plane.height(b_)};
  }
  /// Where the way runs within the closed bounds of the mesh; false: nowhere.
  bool clip(ExactShare& from, ExactShare& to) const;
  SolidSide side_at(std::uint32_t at, const ExactShare& t) const;
  void walk(std::uint32_t at, const ExactShare& from, const ExactShare& to, std::vector<Span>& spans) const;

  const SolidTree& tree_;
  Vec3 a_;
  Vec3 b_;
};

namespace {

/// Of a way that runs within a plane: what both halves say, on where they differ.
void put_together(const std::vector<Span>& front, const std::vector<Span>& back, std::vector<Span>& spans) {
  std::size_t i = 0;
  std::size_t k = 0;
  ExactShare from = front.front().from;
  while (i < front.size() && k < back.size()) {
    const int order = compare(front[i].to, back[k].to);
    const ExactShare& to = order <= 0 ? front[i].to : back[k].to;
    spans.push_back({front[i].side == back[k].side ? front[i].side : SolidSide::on, from, to});
    from = to;
    if (order <= 0) ++i;
    if (order >= 0) ++k;
  }
}

}  // namespace

bool SolidSegment::clip(ExactShare& from, ExactShare& to) const {
  for (int axis = 0; axis < 3; ++axis) {
    const Dyadic length = Dyadic(b_[axis]) - Dyadic(a_[axis]);
    const double ends[2] = {tree_.bounds_.low[axis], tree_.bounds_.high[axis]};
    if (length.sign() == 0 && (a_[axis] < ends[0] || a_[axis] > ends[1])) return false;
    if (length.sign() == 0) continue;
    const ExactShare first = share_of(Dyadic(ends[length.sign() > 0 ? 0 : 1]) - Dyadic(a_[axis]), length);
    const ExactShare last = share_of(Dyadic(ends[length.sign() > 0 ? 1 : 0]) - Dyadic(a_[axis]), length);
    if (compare(first, from) > 0) from = first;
    if (compare(last, to) < 0) to = last;
  }
  return compare(from, to) <= 0;
}

SolidSide SolidSegment::side_at(std::uint32_t at, const ExactShare& t) const {
  while (at < SolidTree::kIn) {
    const SolidTree::SplitNode& node = tree_.nodes_[at];
    const int side = heights(node).sign_at(t);
    if (side == 0) {
      const SolidSide front = side_at(node.front, t);
      if (front == SolidSide::on) return front;
      return side_at(node.back, t) == front ? front : SolidSide::on;
    }
    at = side > 0 ? node.front : node.back;
  }
  return at == SolidTree::kIn ? SolidSide::in : SolidSide::out;
}

void SolidSegment::walk(std::uint32_t at, const ExactShare& from, const ExactShare& to,
                        std::vector<Span>& spans) const {
  if (at >= SolidTree::kIn) {
    spans.push_back({at == SolidTree::kIn ? SolidSide::in : SolidSide::out, from, to});
    return;
  }
  const SolidTree::SplitNode& node = tree_.nodes_[at];
  const Heights over = heights(node);
  const int begins = over.sign_at(from);
  const int ends = over.sign_at(to);
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
  const ExactShare crossing = share_of(over.a, over.a - over.b);
  walk(first, from, crossing, spans);
  walk(begins_in_front ? node.back : node.front, crossing, to, spans);
}

std::vector<SegmentPart> SolidSegment::parts() const {
  const ExactShare begin{0.0, 1.0};
  const ExactShare end{1.0, 1.0};
  ExactShare from = begin;
  ExactShare to = end;
  if (!clip(from, to)) return {{SolidSide::out, {0, 0}, {1, 1}}};
  if (a_ == b_) return {{side_at(0, begin), {0, 0}, {1, 1}}};
  std::vector<Span> spans;
  if (compare(begin, from) < 0) spans.push_back({SolidSide::out, begin, from});
  if (compare(from, to) < 0) walk(0, from, to, spans);
  if (compare(to, end) < 0) spans.push_back({SolidSide::out, to, end});
  std::vector<SegmentPart> parts;
  const auto put = [&](SolidSide side, const ExactShare& first, const ExactShare& last) {
    parts.push_back({side, first.bracket(), last.bracket()});
  };
  // What lies between two spans is a point of its own: two that are out may meet at an edge that the segment touches.
  const auto point_between = [&](const Span* before, const Span* after) {
    const ExactShare& t = after != nullptr ? after->from : before->to;
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
    if (goes_on) parts.back().to = spans[i].to.bracket();
    else put(spans[i].side, spans[i].from, spans[i].to);
  }
  point_between(&spans.back(), nullptr);
  return parts;
}

std::vector<SegmentPart> segment_parts(const SolidTree& tree, const Vec3& a, const Vec3& b) {
  return SolidSegment(tree, a, b).parts();
}

}  // namespace collided::engine
