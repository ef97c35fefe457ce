#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "server/intake/polygons/planar.hpp"
#include "server/intake/polygons/sweep_triangulation.hpp"

namespace collided::engine {

/// A polygon with holes. Points are numbered in the order of x, then y. Each has a next and a previous one on its ring,
/// with the inside to the left.
struct PolygonRings {
  std::vector<PlanePoint> points;
  std::vector<std::uint32_t> original;  // by point: its number in the input
  std::vector<std::uint32_t> next;
  std::vector<std::uint32_t> previous;
};

/// Makes the rings, each with the inside to the left. Returns a flaw, by the numbers of the rings' points, if points
/// coincide or a ring has no area.
std::optional<PolygonFlaw> join_rings(std::span<const PlanePoint> points, std::span<const std::uint32_t> ring_ends,
                                      PolygonRings& rings);

/// Finds diagonals that cut a polygon into monotone pieces: every line parallel to the y axis meets a piece in one
/// interval. A sweep line moves along x and keeps the edges that it crosses ordered from below.
///
/// owner    the caller, which must keep the rings
/// threads  one at a time
class MonotonePieces {
 public:
  explicit MonotonePieces(const PolygonRings& rings);

  /// Runs the sweep. Returns a flaw if edges cross or touch; then the diagonals are unusable.
  std::optional<PolygonFlaw> find();
  /// As pairs of points.
  const std::vector<PolygonFlaw>& diagonals() const { return diagonals_; }

 private:
  /// An edge has the number of the point at which it begins. The edges that the sweep line crosses, from below.
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
  std::vector<std::uint32_t> helper_;   // by edge: the last point passed from which it is visible below
  std::vector<bool> is_merge_;          // by point: two edges end there and the inside continues
  std::vector<PolygonFlaw> diagonals_;
  std::optional<PolygonFlaw> flaw_;
};

}  // namespace collided::engine
