#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/vector.hpp"

namespace collided::engine {

/// The straight line from a to b, metres.
struct MeshSegment {
  Vec3 a;
  Vec3 b;
};

/// Finds which of many segments may lie within a fixed distance, the reach, of a point. Each segment is stored on the
/// level of its size, in the up to eight cells of a hashed grid that its box, widened by the reach, overlaps. A point
/// looks up one cell on each level.
///
/// promise   finds every segment within reach, and others as well
/// threads   immutable once made; any number of threads may query
/// cost      about 0.3 us per segment to build, one look-up per level for each point
class SegmentGrid {
 public:
  /// bounds  of the segments; its diagonal must be finite too
  SegmentGrid(std::span<const MeshSegment> segments, const Aabb& bounds, double reach_m);

  /// Calls visit(segment number) for every segment that may be within reach of the point, once each.
  template <class Visit>
  void visit_near(const Vec3& point, Visit&& visit) const {
    for (const Level& level : levels_) {
      const std::uint64_t key = key_of(level, cell_of(level, point));
      const std::size_t bucket = key & mask_;
      for (std::uint32_t i = starts_[bucket]; i < starts_[bucket + 1]; ++i) {
        if (entries_[i].key == key) visit(entries_[i].segment);
      }
    }
  }

 private:
  struct Level {
    int power = 0;  // cells of 2^power m
  };
  struct Cell {
    std::int64_t x = 0, y = 0, z = 0;
  };
  struct Entry {
    std::uint64_t key = 0;
    std::uint32_t segment = 0;
  };

  Cell cell_of(const Level& level, const Vec3& point) const;
  static std::uint64_t key_of(const Level& level, const Cell& cell);

  Vec3 origin_;
  double reach_m_;
  std::vector<Level> levels_;
  std::vector<std::uint32_t> starts_;  // start of each bucket in entries_; a bucket is the low bits of a key
  std::vector<Entry> entries_;
  std::size_t mask_ = 0;
};

}  // namespace collided::engine
