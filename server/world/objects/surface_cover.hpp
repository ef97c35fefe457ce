#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Which triangles of a mesh are neighbours: over an edge of exactly two triangles of one part. Corners with equal
/// coordinates count as one.
class TriangleNeighbours {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// part_of  the part's number for each triangle
  TriangleNeighbours(const TriangleMesh& mesh, std::span<const std::uint32_t> part_of);

  /// The neighbour over the edge from corner k to the next; kNone if there is none or more than one.
  std::uint32_t across(std::uint32_t triangle, std::size_t k) const { return across_[3 * std::size_t{triangle} + k]; }

 private:
  std::vector<std::uint32_t> across_;
};

/// Bounds how far a triangle's points are from a surface that lies over it like a sheet over a table.
///
/// Grows a piece of the surface from one triangle over its edges, until no edge of the piece's border runs over the
/// inside of the table. Then, seen along the table's normal, the number of times the piece covers a point is the same
/// modulo 2 all over the table. If it is odd at one point, every point of the table has a point of the piece above or
/// below it, so the piece's greatest height over the table bounds the distance.
///
/// threads  one object per thread
class SheetOverTable {
 public:
  /// Both must outlive this object.
  SheetOverTable(const TriangleMesh& sheet, const TriangleNeighbours& neighbours);

  /// A bound in metres, or infinity if none is found: at borders, at folds, for a table without area.
  ///
  /// seed  the triangle from which the piece grows, near the table
  double height_at_most(const Triangle& table, std::uint32_t seed);

 private:
  using Flat = Eigen::Vector2d;
  // A point in the table's coordinates: its foot in the plane and its height over it.
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
  std::vector<std::uint32_t> taken_at_;  // by triangle: the number of the last table whose piece took it
  std::uint32_t table_number_ = 0;
  std::vector<std::uint32_t> piece_;            // triangle numbers in the sheet
  std::vector<std::array<Raised, 3>> corners_;  // corners of the piece's triangles, in the same order
  std::vector<Raised> polygon_;
  std::vector<Raised> clipped_;

  Vec3 origin_ = Vec3::Zero();
  Mat3 axes_ = Mat3::Identity();  // rows: along an edge of the table, across it in its plane, its normal
  std::array<Flat, 3> inside_;    // the table, shrunk by kRim
  std::array<Flat, 3> outline_;   // the table itself
  Flat middle_ = Flat::Zero();
  double size_ = 0;   // longest edge of the table, metres
  double reach_ = 0;  // largest coordinate met, metres; scales the slack for rounding
};

}  // namespace collided::engine
