#pragma once

#include <random>
#include <span>
#include <string>
#include <vector>

#include "server/geometry/aabb.hpp"

namespace collided::bench {
using namespace engine;

enum class Motion { flight, teleport };

/// Boxes in a cube (or on a line) at one in ten cubic metres. In flight each goes straight on, a tenth of a metre an axis and frame at
/// most, and bounces off the cube's walls; teleported, each is somewhere else in every frame.
class Movers {
 public:
  /// kind: uniform, clustered (by hundreds, about one in three cubic metres at their middle), one giant (as large as the
  /// cube), in a line (two metres wide and high), sizes 1/8 to 8, in one cell (needles side by side, as long as a cell and apart), in one point
  Movers(std::size_t count, const std::string& kind, Motion motion, std::mt19937_64& random);
  void step();
  std::span<const Aabb> boxes() const { return boxes_; }

 private:
  Vec3 any(std::uniform_real_distribution<double> of);
  Vec3 any_place();
  void fly(std::size_t i);

  Vec3 edges_m_;
  Motion motion_;
  std::mt19937_64& random_;
  std::vector<Aabb> boxes_;
  std::vector<Vec3> velocities_;
};

}  // namespace collided::bench
