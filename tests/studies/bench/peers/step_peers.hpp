#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/geometry/pose.hpp"
#include "server/geometry/shape.hpp"

namespace collided::bench {
using namespace engine;

/// What a peer needs to know of a crowd: one sphere or one box each, around its own origin.
struct StepBodies {
  std::vector<Primitive> shapes{};
  std::vector<Pose> poses{};
  std::size_t moving = 0;  // the first so many move in every step, the rest never
};

/// One library's world of bodies: told new poses, it finds the touching pairs.
class StepPeer {
 public:
  virtual ~StepPeer() = default;
  virtual std::string name() const = 0;
  /// Takes the poses of the moving bodies, and finds the touching pairs.
  virtual void step(std::span<const Pose> poses) = 0;
  /// How many pairs with a moving body the last step found. Not timed.
  virtual std::size_t pairs() const = 0;
};

/// Its dynamic tree, and its exact test for each pair; contacts: with a contact point, normal and depth a pair.
std::unique_ptr<StepPeer> fcl_steps(const StepBodies& bodies, bool contacts);
/// Its collision world over dynamic trees, with contact manifolds (it has no other way); in single precision.
std::unique_ptr<StepPeer> bullet_steps(const StepBodies& bodies);

}  // namespace collided::bench
