#include "server/geometry/float_environment.hpp"

#if defined(__SSE2__)
#include <xmmintrin.h>
#elif defined(__aarch64__)
#include <cstdint>
#else
#error "This processor's floating-point control word is not known here"
#endif

namespace collided {

#if defined(__SSE2__)

bool restore_float_environment() {
  constexpr unsigned kFlags = 0x003f;   // what has happened so far: not a setting
  constexpr unsigned kDefault = 0x1f80;  // all traps masked, round to nearest, denormals kept
  const unsigned word = _mm_getcsr();
  if ((word & ~kFlags) == kDefault) return false;
  _mm_setcsr(kDefault | (word & kFlags));
  return true;
}

#else

bool restore_float_environment() {
  std::uint64_t word;
  asm volatile("mrs %0, fpcr" : "=r"(word));
  if (word == 0) return false;
  asm volatile("msr fpcr, %0" : : "r"(std::uint64_t{0}));
  return true;
}

#endif

}  // namespace collided
