#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "server/intake/polygons/planar.hpp"
#include "server/intake/polygons/sweep_triangulation.hpp"

namespace collided::engine {

/// A polygon with holes, its points numbered by x, then y: for each the next and the one before, the inside to the left.
struct PolygonRings {
  std::vector<PlanePoint> points;
  std::vector<std::uint32_t> original;  // numbers of the points as they were given
  std::vector<std::uint32_t> next;
  std::vector<std::uint32_t> previous;
};

/// Joins the points to rings and turns each the right way; a flaw, in these numbers, for equal points and rings that fold
/// flat.
std::optional<PolygonFlaw> join_rings(std::span<const PlanePoint> points, std::span<const std::uint32_t> ring_ends,
                                      PolygonRings& rings);

/// Diagonals, as pairs of points, that cut the polygon into pieces that every upright line meets in one stretch.
class MonotonePieces {
 public:
  explicit MonotonePieces(const PolygonRings& rings);

  /// A flaw where edges cross or touch; the diagonals are of no use then.
  std::optional<PolygonFlaw> find();
  const std::vector<PolygonFlaw>& diagonals() const { return diagonals_; }

 private:
  /// Edges by the number of the point they begin at; those under the sweep line, from below.
  struct IsBelow {
    MonotonePieces* pieces;
    bool operator()(std::uint32_t a, std::uint32_t b) const { return pieces->is_below(a, b); }
  };
  using Edges = std::set<std::uint32_t, IsBelow>;

  static bool comes_first(std::uint32_t a, std::uint32_t b) { return a < b; }
  std::uint32_t left_of(std::uint32_t edge) const;
  std::uint32_t right_of(std::uint32_t edge) const;
  int turn_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return turn(rings_.points[a], rings_.points[b], rings_.points[c]);
  }
  bool is_below(std::uint32_t a, std::uint32_t b);
  bool meet(std::uint32_t edge, std::uint32_t other) const;
  void check(Edges::iterator lower, Edges::iterator upper);
  void remove(std::uint32_t edge);
  void insert(std::uint32_t edge, std::uint32_t helper);
  void pass(std::uint32_t point);
  void pass_start(std::uint32_t point, int side);
  void pass_end(std::uint32_t point, int side);
  std::optional<std::uint32_t> edge_below(std::uint32_t point, Edges::iterator place);
  void join_if_merge(std::uint32_t point, std::uint32_t edge);
  void see_from_below(std::uint32_t point, Edges::iterator place);

  const PolygonRings& rings_;
  Edges edges_;
  std::vector<Edges::iterator> place_;  // by edge
  std::vector<std::uint32_t> helper_;   // by edge: the last point that sees it from above
  std::vector<bool> is_merge_;          // by point: the sweep ends two edges there, and the inside goes on
  std::vector<PolygonFlaw> diagonals_;
  std::optional<PolygonFlaw> flaw_;
};

}  // namespace collided::engine
