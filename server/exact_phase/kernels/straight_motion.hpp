#pragma once

#include "server/exact_phase/arithmetic/number.hpp"

namespace collided::engine::kernel {

/// The motion of a relative to b while both move straight at constant speed, from time 0 to `until` in [0, 1]; not
/// rounded.
struct StraightMotion {
  Vec3 from_a = Vec3::Zero();
  Vec3 to_a = Vec3::Zero();
  Vec3 from_b = Vec3::Zero();
  Vec3 to_b = Vec3::Zero();
  double until = 1;

  /// The translation of a relative to b.
  template <class N>
  Vector<N> displacement() const {
    return N(until) * ((Vector<N>(to_a) - Vector<N>(from_a)) - (Vector<N>(to_b) - Vector<N>(from_b)));
  }
  /// The motion with a and b exchanged.
  StraightMotion turned() const { return {from_b, to_b, from_a, to_a, until}; }
};

}  // namespace collided::engine::kernel
