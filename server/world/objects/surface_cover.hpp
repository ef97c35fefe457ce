#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Which triangles of a mesh hang together over an edge of exactly two triangles of one part. Corners with equal
/// coordinates count as one.
class TriangleNeighbours {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// part_of  a number for each triangle
  TriangleNeighbours(const TriangleMesh& mesh, std::span<const std::uint32_t> part_of);

  /// Across the edge from corner k to the next; kNone: nothing, or more than one.
  std::uint32_t across(std::uint32_t triangle, std::size_t k) const { return across_[3 * std::size_t{triangle} + k]; }

 private:
  std::vector<std::uint32_t> across_;
};

/// How far a triangle's points are at most from a surface that lies over it like a sheet over a table.
///
/// A piece of the surface is grown from one triangle over its edges until no edge of its border runs over the inside of
/// the table. Seen along the table's normal, how often the piece covers a point, modulo 2, then is the same all over the
/// table; where that is odd at one point, each point of the table has one of the piece above or below it, and the piece's
/// greatest height over the table bounds its distance.
///
/// threads  one object a thread
class SheetOverTable {
 public:
  /// Both must live as long as this.
  SheetOverTable(const TriangleMesh& sheet, const TriangleNeighbours& neighbours);

  /// A bound, or infinity where none is found: over borders, folds, tables without area.
  /// seed  the triangle that the piece grows from, near the table
  double height_at_most(const Triangle& table, std::uint32_t seed);

 private:
  using Flat = Eigen::Vector2d;
  struct Raised {
    Flat at;
    double height;
  };

  bool set_table(const Triangle& table);
  Raised raised(const Vec3& point) const;
  bool grow(std::uint32_t seed);
  void take(std::uint32_t triangle);
  bool may_run_over(const Raised& a, const Raised& b) const;
  int covers_middle(const std::array<Raised, 3>& corners) const;
  double height_over_table(const std::array<Raised, 3>& corners);

  const TriangleMesh& sheet_;
  const TriangleNeighbours& neighbours_;
  std::vector<std::uint32_t> taken_at_;  // by triangle: the number of the last table whose piece had it
  std::uint32_t table_number_ = 0;
  std::vector<std::uint32_t> piece_;
  std::vector<std::array<Raised, 3>> corners_;  // of the piece
  std::vector<Raised> polygon_;
  std::vector<Raised> clipped_;

  Vec3 origin_ = Vec3::Zero();
  Mat3 axes_ = Mat3::Identity();  // rows: along an edge of the table, across it in its plane, its normal
  std::array<Flat, 3> inside_;    // the table, a little smaller
  std::array<Flat, 3> outline_;   // and itself
  Flat middle_ = Flat::Zero();
  double size_ = 0;     // of the table
  double reach_ = 0;    // the farthest coordinate met, for the roundings
};

}  // namespace collided::engine
