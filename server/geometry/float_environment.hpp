#pragma once

namespace collided::engine {

/// The proofs assume rounding to nearest, denormals kept and no traps. A library built with -ffast-math turns denormals
/// off for the thread that loads it, and threads inherit that. This resets the calling thread's floating-point
/// environment where it differs.
///
/// returns  true if it had to be reset
/// cost     a few nanoseconds
bool restore_float_environment();

/// Sets the engine's floating-point environment for its lifetime and restores the host's afterwards, flags included: a
/// host that rounds upward, flushes denormals or traps gets the same answers, and no trap. Intermediates that overflow
/// or become NaN are intended: they mean "unsure" and lead to the next rung of the ladder.
class OwnFloatEnvironment {
 public:
  OwnFloatEnvironment();
  ~OwnFloatEnvironment();
  OwnFloatEnvironment(const OwnFloatEnvironment&) = delete;
  OwnFloatEnvironment& operator=(const OwnFloatEnvironment&) = delete;

 private:
  unsigned long long host_[2];
};

}  // namespace collided::engine
