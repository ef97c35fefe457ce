#pragma once

#include "server/exact_phase/motion/body_motion.hpp"

namespace collided::engine {

/// Two motions seen from a point near them. Far from the world's origin placing rounds by more than a narrow bracket allows:
/// a billion metres out by a tenth of a micrometre. Differences of neighbouring coordinates are exact there, so that nothing
/// but this rounding changes.
class CommonOrigin {
 public:
  /// Takes the second body's first position as the origin, if the two are far out and all their positions can be seen from
  /// there without rounding.
  CommonOrigin(const BodyMotion& a, const BodyMotion& b);
  CommonOrigin(const CommonOrigin&) = delete;
  CommonOrigin& operator=(const CommonOrigin&) = delete;

  /// The two are seen from origin(); else the rest has no meaning.
  bool is_taken() const { return is_taken_; }
  const Vec3& origin() const { return origin_; }
  const BodyMotion& a() const { return a_; }
  const BodyMotion& b() const { return b_; }

 private:
  bool see(const BodyMotion& motion, BodyMotion& seen, Pose& given) const;

  Vec3 origin_;
  BodyMotion a_;
  BodyMotion b_;
  Pose given_a_;  // what the motions' `given` points to
  Pose given_b_;
  bool is_taken_ = false;
};

}  // namespace collided::engine
