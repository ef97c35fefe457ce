#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <span>
#include <vector>

#include "server/geometry/shapes.hpp"
#include "server/geometry/vector.hpp"

namespace collided::engine {

/// The point that decides to which tile a triangle belongs.
inline Vec3 centroid(const Triangle& triangle) { return triangle.a / 3 + triangle.b / 3 + triangle.c / 3; }

/// Assigns points to tiles. First pass it all points, in any order that is the same each time, then finish it, then
/// query it.
///
/// threads  one at a time
class TileSplit {
 public:
  virtual ~TileSplit() = default;
  virtual void see(const Vec3& point) = 0;
  /// throws  LoadError if there would be too many tiles
  virtual void finish() = 0;
  /// At most kMostTiles, of which some may stay empty.
  virtual std::size_t tile_count() const = 0;
  virtual std::uint32_t tile_of(const Vec3& point) const = 0;
};

/// Cubes of one size, with corners at whole multiples of it.
class CubeSplit final : public TileSplit {
 public:
  explicit CubeSplit(double size_m) : size_m_(size_m) {}

  void see(const Vec3& point) override;
  void finish() override;
  std::size_t tile_count() const override { return tiles_.size(); }
  std::uint32_t tile_of(const Vec3& point) const override;

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Vec3& point) const;

  double size_m_;
  std::map<Cell, std::uint32_t> tiles_;
  Cell last_{};  // cell of the last point: the next one is usually there too
};

/// A k-d tree with about as many points in each leaf: split across the longest side at the median. For many points it
/// uses a sample, which is the same each time.
class MedianSplit final : public TileSplit {
 public:
  /// most_points  in a tile, as nearly as a sample allows
  explicit MedianSplit(std::size_t most_points) : most_points_(most_points) {}

  void see(const Vec3& point) override;
  void finish() override;
  std::size_t tile_count() const override { return leaf_count_; }
  std::uint32_t tile_of(const Vec3& point) const override;

 private:
  struct CutNode {
    double plane = 0;         // points below it are on the lower side
    std::int32_t axis = -1;   // -1: a leaf
    std::uint32_t lower = 0;  // its node, or the leaf's number
    std::uint32_t upper = 0;
  };

  std::uint32_t split(std::span<Vec3> points, double points_each);

  std::size_t most_points_;
  std::uint64_t seen_ = 0;
  std::vector<Vec3> sample_;
  std::mt19937_64 random_{28};
  std::vector<CutNode> nodes_;
  std::uint32_t leaf_count_ = 0;
};

}  // namespace collided::engine
