#include "server/intake/polygons/sweep_triangulation.hpp"

#include <algorithm>

#include "server/intake/polygons/monotone_pieces.hpp"

namespace collided::engine {
namespace {

/// The pieces into which diagonals cut a polygon. The directed edges that leave each point are sorted to the left,
/// starting with the one to the ring's next point. The piece to the left of an edge that arrives continues along the
/// edge that is sorted before it.
class Pieces {
 public:
  Pieces(const PolygonRings& rings, const std::vector<PolygonFlaw>& diagonals) : rings_(rings) {
    const std::size_t count = rings.points.size();
    first_motion_.assign(count + 1, 0);
    for (std::size_t i = 0; i < count; ++i) first_motion_[i + 1] = 1;
    for (const auto& [a, b] : diagonals) ++first_motion_[a + 1], ++first_motion_[b + 1];
    for (std::size_t i = 0; i < count; ++i) first_motion_[i + 1] += first_motion_[i];
    motions_.resize(first_motion_[count]);
    twin_.resize(motions_.size());
    sort_ways(diagonals);
  }

  /// Calls visit(points) for each piece, with its points counter-clockwise.
  template <class Visit>
  void visit(Visit&& visit) const {
    std::vector<bool> is_done(motions_.size(), false);
    std::vector<std::uint32_t> piece;
    for (std::uint32_t begin = 0; begin < motions_.size(); ++begin) {
      if (is_done[begin]) continue;
      piece.clear();
      for (std::uint32_t motion = begin; !is_done[motion]; motion = following(motion)) {
        is_done[motion] = true;
        piece.push_back(start_of(motion));
      }
      visit(piece);
    }
  }

 private:
  static constexpr std::uint32_t kRing = 0xffffffff;

  struct NeighbourVertex {
    std::uint32_t to;
    std::uint32_t diagonal;
  };

  std::uint32_t start_of(std::uint32_t motion) const { return starts_[motion]; }

  /// Whether a comes before b around the point `at`. Angles count from the ring's next point; those below half a turn
  /// come first.
  bool comes_before(std::uint32_t at, std::uint32_t a, std::uint32_t b) const {
    const auto& p = rings_.points;
    const std::uint32_t zero = rings_.next[at];
    const auto is_late = [&](std::uint32_t to) { return turn(p[at], p[zero], p[to]) < 0; };
    if (is_late(a) != is_late(b)) return is_late(b);
    return turn(p[at], p[a], p[b]) > 0;
  }

  void sort_ways(const std::vector<PolygonFlaw>& diagonals) {
    std::vector<std::uint32_t> filled(first_motion_.begin(), first_motion_.end() - 1);
    for (std::uint32_t i = 0; i < rings_.points.size(); ++i) motions_[filled[i]++] = {rings_.next[i], kRing};
    for (std::uint32_t d = 0; d < diagonals.size(); ++d) {
      motions_[filled[diagonals[d].first]++] = {diagonals[d].second, d};
      motions_[filled[diagonals[d].second]++] = {diagonals[d].first, d};
    }
    starts_.resize(motions_.size());
    std::vector<std::uint32_t> other(diagonals.size(), kRing);
    for (std::uint32_t i = 0; i < rings_.points.size(); ++i) {
      std::sort(motions_.begin() + first_motion_[i] + 1, motions_.begin() + first_motion_[i + 1],
                [&](const NeighbourVertex& a, const NeighbourVertex& b) { return comes_before(i, a.to, b.to); });
      for (std::uint32_t w = first_motion_[i]; w < first_motion_[i + 1]; ++w) {
        starts_[w] = i;
        if (motions_[w].diagonal == kRing) continue;
        std::uint32_t& partner = other[motions_[w].diagonal];
        if (partner != kRing) twin_[w] = partner, twin_[partner] = w;
        partner = w;
      }
    }
  }

  std::uint32_t following(std::uint32_t motion) const {
    // An edge of the ring arrives after all edges that leave; a diagonal arrives at its own other direction.
    if (motions_[motion].diagonal == kRing) return first_motion_[motions_[motion].to + 1] - 1;
    return twin_[motion] - 1;
  }

  const PolygonRings& rings_;
  std::vector<std::uint32_t> first_motion_;  // by point
  std::vector<NeighbourVertex> motions_;
  std::vector<std::uint32_t> starts_;  // by motion: the point it leaves
  std::vector<std::uint32_t> twin_;    // by motion: for a diagonal, the opposite direction
};

/// Cuts monotone pieces, which every line parallel to the y axis meets in one interval, into triangles.
class MonotoneCut {
 public:
  MonotoneCut(const PolygonRings& rings, std::vector<TriangleCorners>& triangles)
      : rings_(rings), triangles_(triangles) {}

  void cut(const std::vector<std::uint32_t>& piece) {
    if (piece.size() == 3) {
      triangles_.push_back({piece[0], piece[1], piece[2]});
      return;
    }
    sort_both_chains(piece);
    stack_.assign(sorted_.begin(), sorted_.begin() + 2);
    for (std::size_t i = 2; i < sorted_.size(); ++i) {
      const bool is_last = i + 1 == sorted_.size();
      if (is_last || sorted_[i].is_lower != stack_.back().is_lower) take_all(sorted_[i]);
      else take_seen(sorted_[i]);
    }
  }

 private:
  struct Corner {
    std::uint32_t point;
    bool is_lower;  // on the chain that has the inside above it
  };

  void sort_both_chains(const std::vector<std::uint32_t>& piece) {
    const std::size_t count = piece.size();
    const auto first = static_cast<std::size_t>(std::min_element(piece.begin(), piece.end()) - piece.begin());
    std::size_t lower = first;                        // forward along the list, with the inside to the left
    std::size_t upper = (first + count - 1) % count;  // backward along the list
    sorted_.clear();
    sorted_.push_back({piece[lower], true});
    lower = (lower + 1) % count;
    while (sorted_.size() < count) {
      const bool take_lower = piece[lower] < piece[upper];
      if (take_lower || lower == upper) {
        sorted_.push_back({piece[lower], true});
        lower = (lower + 1) % count;
      } else {
        sorted_.push_back({piece[upper], false});
        upper = (upper + count - 1) % count;
      }
    }
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool is_lower) {
    triangles_.push_back(is_lower ? TriangleCorners{a, b, c} : TriangleCorners{a, c, b});
  }

  /// The whole other chain is visible from the corner: cuts all of it off.
  void take_all(const Corner& corner) {
    for (std::size_t k = 1; k < stack_.size(); ++k)
      add(stack_[k - 1].point, stack_[k].point, corner.point, stack_.back().is_lower);
    stack_ = {stack_.back(), corner};
  }

  /// Cuts off those corners of the same chain that are visible from the corner: as long as the turn is inward.
  void take_seen(const Corner& corner) {
    Corner last = stack_.back();
    stack_.pop_back();
    while (!stack_.empty()) {
      const int side = turn(rings_.points[stack_.back().point], rings_.points[last.point], rings_.points[corner.point]);
      if (side == 0 || (side > 0) != corner.is_lower) break;
      add(stack_.back().point, last.point, corner.point, corner.is_lower);
      last = stack_.back();
      stack_.pop_back();
    }
    stack_.push_back(last);
    stack_.push_back(corner);
  }

  const PolygonRings& rings_;
  std::vector<TriangleCorners>& triangles_;
  std::vector<Corner> sorted_;
  std::vector<Corner> stack_;
};

}  // namespace

std::optional<PolygonFlaw> triangulate_by_sweep(std::span<const PlanePoint> points,
                                                std::span<const std::uint32_t> ring_ends,
                                                std::vector<TriangleCorners>& triangles) {
  PolygonRings rings;
  const auto original = [&](const PolygonFlaw& flaw) {
    return PolygonFlaw{rings.original[flaw.first], rings.original[flaw.second]};
  };
  if (const auto flaw = join_rings(points, ring_ends, rings)) return original(*flaw);
  MonotonePieces pieces(rings);
  if (const auto flaw = pieces.find()) return original(*flaw);
  const std::size_t first_new = triangles.size();
  MonotoneCut cutter(rings, triangles);
  Pieces(rings, pieces.diagonals()).visit([&](const std::vector<std::uint32_t>& piece) { cutter.cut(piece); });
  for (std::size_t i = first_new; i < triangles.size(); ++i) {
    for (std::uint32_t& corner : triangles[i]) corner = rings.original[corner];
  }
  return std::nullopt;
}

}  // namespace collided::engine
