#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace collided::engine {

/// The proofs assume rounding to nearest, denormals kept and no traps. A library built with -ffast-math turns denormals
/// off for the thread that loads it, and threads inherit that. Resets the calling thread's floating-point environment
/// if it differs.
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

#if defined(__SSE2__)
// Inline: a single ray sets it, and two calls would cost it as much as half a node of the tree.
namespace float_environment {
inline constexpr unsigned kFlags = 0x003f;    // exceptions raised so far: not a setting
inline constexpr unsigned kDefault = 0x1f80;  // all traps masked, round to nearest, denormals kept
/// Keeps the order of arithmetic and control word, whose dependence the compiler does not know: values read from memory
/// are used on this side.
inline void keep_order() { asm volatile("" : : : "memory"); }
}  // namespace float_environment

// Reading the word waits for all arithmetic in flight; writing an unchanged word costs nothing. The host's flags are
// not cleared, so that restoring usually writes an unchanged word.
inline OwnFloatEnvironment::OwnFloatEnvironment() : host_{_mm_getcsr(), 0} {
  if ((host_[0] & ~float_environment::kFlags) != float_environment::kDefault) _mm_setcsr(float_environment::kDefault);
  float_environment::keep_order();
}
inline OwnFloatEnvironment::~OwnFloatEnvironment() {
  float_environment::keep_order();
  _mm_setcsr(static_cast<unsigned>(host_[0]));
}
#endif

}  // namespace collided::engine
