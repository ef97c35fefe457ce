#pragma once

#include <memory>
#include <span>
#include <string>

#include "server/geometry/aabb.hpp"

namespace collided::bench {
using namespace engine;

/// One library's moving boxes.
class FramePeer {
 public:
  virtual ~FramePeer() = default;
  virtual std::string name() const = 0;
  /// Moves every box to its new place; the number of overlapping pairs.
  virtual std::size_t frame(std::span<const Aabb> boxes) = 0;
};

std::unique_ptr<FramePeer> bullet_frames(std::span<const Aabb> boxes);
/// Nothing where it would not end.
std::unique_ptr<FramePeer> bullet_sweep_frames(std::span<const Aabb> boxes);
std::unique_ptr<FramePeer> cgal_frames(std::span<const Aabb> boxes);
std::unique_ptr<FramePeer> fcl_frames(std::span<const Aabb> boxes);

}  // namespace collided::bench
