#include "server/intake/polygons/monotone_pieces.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace collided::engine {
namespace {

/// Whether p, which is on the line through a and b, is between them or one of them.
bool lies_between(const PlanePoint& a, const PlanePoint& b, const PlanePoint& p) {
  return std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) && std::min(a[1], b[1]) <= p[1] &&
         p[1] <= std::max(a[1], b[1]);
}

}  // namespace

std::optional<PolygonFlaw> join_rings(std::span<const PlanePoint> points, std::span<const std::uint32_t> ring_ends,
                                      PolygonRings& rings) {
  const auto count = static_cast<std::uint32_t>(points.size());
  rings.original.resize(count);
  std::iota(rings.original.begin(), rings.original.end(), 0u);
  std::sort(rings.original.begin(), rings.original.end(),
            [&](std::uint32_t a, std::uint32_t b) { return points[a] != points[b] ? points[a] < points[b] : a < b; });
  std::vector<std::uint32_t> number(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    number[rings.original[i]] = i;
    rings.points.push_back(points[rings.original[i]]);
    if (i > 0 && rings.points[i] == rings.points[i - 1]) return PolygonFlaw{i - 1, i};
  }
  rings.next.resize(count);
  rings.previous.resize(count);
  std::uint32_t first = 0;
  for (const std::uint32_t end : ring_ends) {
    if (end < first + 3) return PolygonFlaw{number[first], number[first]};
    std::uint32_t leftmost = number[first];
    for (std::uint32_t i = first; i < end; ++i) {
      const std::uint32_t after = number[i + 1 == end ? first : i + 1];
      rings.next[number[i]] = after;
      rings.previous[after] = number[i];
      leftmost = std::min(leftmost, number[i]);
    }
    const int side =
        turn(rings.points[rings.previous[leftmost]], rings.points[leftmost], rings.points[rings.next[leftmost]]);
    if (side == 0) return PolygonFlaw{rings.previous[leftmost], leftmost};
    const bool is_hole = first > 0;
    if ((side < 0) != is_hole) {
      for (std::uint32_t i = first; i < end; ++i) std::swap(rings.next[number[i]], rings.previous[number[i]]);
    }
    first = end;
  }
  return std::nullopt;
}

MonotonePieces::MonotonePieces(const PolygonRings& rings)
    : rings_(rings),
      edges_(IsBelow{this}),
      place_(rings.points.size()),
      helper_(rings.points.size()),
      is_merge_(rings.points.size(), false) {}

std::optional<PolygonFlaw> MonotonePieces::find() {
  for (std::uint32_t point = 0; point < rings_.points.size(); ++point) {
    pass(point);
    if (flaw_) break;
  }
  return flaw_;
}

std::uint32_t MonotonePieces::left_of(std::uint32_t edge) const {
  return comes_first(edge, rings_.next[edge]) ? edge : rings_.next[edge];
}
std::uint32_t MonotonePieces::right_of(std::uint32_t edge) const {
  return comes_first(edge, rings_.next[edge]) ? rings_.next[edge] : edge;
}

/// The order of two edges that the sweep line crosses. An end on the other edge is a flaw, found here or when its
/// neighbours are compared.
bool MonotonePieces::is_below(std::uint32_t a, std::uint32_t b) {
  if (a == b) return false;
  const std::uint32_t left_a = left_of(a);
  const std::uint32_t left_b = left_of(b);
  const bool a_is_longer = comes_first(left_a, left_b);
  const std::uint32_t longer = a_is_longer || left_a == left_b ? a : b;
  const std::uint32_t other = longer == a ? b : a;
  int side = left_a == left_b ? 0 : turn_of(left_of(longer), right_of(longer), left_of(other));
  if (side == 0) {
    if (left_a != left_b) flaw_ = PolygonFlaw{a, b};
    side = turn_of(left_of(longer), right_of(longer), right_of(other));
    if (side == 0) flaw_ = PolygonFlaw{a, b};
  }
  return longer == a ? side > 0 : side < 0;
}

/// Whether two edges have a point in common that is not a common end, or lie on each other.
bool MonotonePieces::meet(std::uint32_t edge, std::uint32_t other) const {
  const std::uint32_t a = left_of(edge);
  const std::uint32_t b = right_of(edge);
  const std::uint32_t c = left_of(other);
  const std::uint32_t d = right_of(other);
  if (a == c) return turn_of(a, b, d) == 0;
  if (b == d) return turn_of(a, b, c) == 0;
  if (a == d || b == c) return false;  // one ends where the other begins
  const int side_c = turn_of(a, b, c);
  const int side_d = turn_of(a, b, d);
  const int side_a = turn_of(c, d, a);
  const int side_b = turn_of(c, d, b);
  const auto& p = rings_.points;
  if (side_c == 0 && lies_between(p[a], p[b], p[c])) return true;
  if (side_d == 0 && lies_between(p[a], p[b], p[d])) return true;
  if (side_a == 0 && lies_between(p[c], p[d], p[a])) return true;
  if (side_b == 0 && lies_between(p[c], p[d], p[b])) return true;
  return side_c * side_d < 0 && side_a * side_b < 0;
}

void MonotonePieces::check(Edges::iterator lower, Edges::iterator upper) {
  if (meet(*lower, *upper)) flaw_ = PolygonFlaw{*lower, *upper};
}

void MonotonePieces::remove(std::uint32_t edge) {
  const auto after = edges_.erase(place_[edge]);
  if (after != edges_.end() && after != edges_.begin()) check(std::prev(after), after);
}

void MonotonePieces::insert(std::uint32_t edge, std::uint32_t helper) {
  const auto [place, is_new] = edges_.insert(edge);
  if (!is_new) {
    flaw_ = PolygonFlaw{*place, edge};
    return;
  }
  place_[edge] = place;
  helper_[edge] = helper;
  if (place != edges_.begin()) check(std::prev(place), place);
  if (std::next(place) != edges_.end()) check(place, std::next(place));
}

/// The inside is above edges that run to the right. A point at which two intervals of the inside merge gets a diagonal
/// to the next point that is visible from it.
void MonotonePieces::join_if_merge(std::uint32_t point, std::uint32_t edge) {
  if (is_merge_[helper_[edge]]) diagonals_.push_back({point, helper_[edge]});
}

/// The nearest edge below the point that has the inside above it. `place` is an edge that begins or ends at the point.
std::optional<std::uint32_t> MonotonePieces::edge_below(std::uint32_t point, Edges::iterator place) {
  while (place != edges_.begin()) {
    --place;
    if (left_of(*place) == point) continue;
    if (comes_first(*place, rings_.next[*place])) return *place;
    break;
  }
  flaw_ = PolygonFlaw{point, point};  // the point is outside everything: rings are wrongly nested
  return std::nullopt;
}

void MonotonePieces::pass(std::uint32_t point) {
  const std::uint32_t before = rings_.previous[point];
  const std::uint32_t after = rings_.next[point];
  const bool before_is_left = comes_first(before, point);
  const bool after_is_left = comes_first(after, point);
  const int side = turn_of(before, point, after);
  if (before_is_left == after_is_left && side == 0) {
    flaw_ = PolygonFlaw{before, point};
    return;
  }
  if (!before_is_left && !after_is_left) return pass_start(point, side);
  if (before_is_left && after_is_left) return pass_end(point, side);
  if (before_is_left) {  // the inside is above
    join_if_merge(point, before);
    edges_.erase(place_[before]);
    insert(point, point);
    return;
  }
  edges_.erase(place_[point]);
  insert(before, before);
  if (!flaw_) see_from_below(point, place_[before]);
}

void MonotonePieces::see_from_below(std::uint32_t point, Edges::iterator place) {
  const std::optional<std::uint32_t> below = edge_below(point, place);
  if (!below) return;
  join_if_merge(point, *below);
  helper_[*below] = point;
}

/// Both edges at the point begin there: the inside is between them, or all around them.
void MonotonePieces::pass_start(std::uint32_t point, int side) {
  const std::uint32_t before = rings_.previous[point];
  insert(point, point);
  if (!flaw_) insert(before, before);
  if (side > 0 || flaw_) return;
  const std::optional<std::uint32_t> below = edge_below(point, place_[point]);
  if (!below) return;
  diagonals_.push_back({point, helper_[*below]});
  helper_[*below] = point;
}

/// Both edges at the point end there: the inside between them ends, or the two intervals around them merge.
void MonotonePieces::pass_end(std::uint32_t point, int side) {
  const std::uint32_t before = rings_.previous[point];
  join_if_merge(point, before);
  if (side < 0) {
    is_merge_[point] = true;
    see_from_below(point, place_[point]);
    if (flaw_) return;
  }
  edges_.erase(place_[point]);
  remove(before);
}

}  // namespace collided::engine
