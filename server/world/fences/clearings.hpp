#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/aabb.hpp"

namespace collided::engine {

/// Boxes around movers that contain no fence. While fences stand still, most movers stay in their box for many steps,
/// which then need no search for fences.
///
/// threads  one
class Clearings {
 public:
  /// True if the box lies in the mover's clearing.
  bool hold(std::uint32_t mover, const Aabb& box) const {
    if (mover >= boxes_.size() || boxes_[mover].empty() || box.empty()) return false;
    const Aabb& clearing = boxes_[mover];
    return (box.low.array() >= clearing.low.array()).all() && (box.high.array() <= clearing.high.array()).all();
  }
  void set(std::uint32_t mover, const Aabb& clearing) {
    if (mover >= boxes_.size()) boxes_.resize(mover + 1);
    boxes_[mover] = clearing;
  }
  /// Call when a fence was added or moves.
  void forget_all() { boxes_.clear(); }

 private:
  std::vector<Aabb> boxes_;
};

}  // namespace collided::engine
