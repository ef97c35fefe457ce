#pragma once

namespace collided::engine {

/// The proofs assume rounding to nearest, denormals kept and no traps. A library built with -ffast-math turns denormals
/// off for the thread that loads it, and threads inherit that. Sets the calling thread's floating-point environment
/// back where it differs.
///
/// returns  true if it had to be set back
/// cost     a few nanoseconds
bool restore_float_environment();

/// The engine's own floating-point settings for as long as it lives, and then the host's again, flags included: a host
/// that rounds upward, flushes denormals or traps gets the same answers, and no trap. An intermediate that overflows or
/// is no number is no accident here: it says "not sure" to the next rung of the ladder.
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
