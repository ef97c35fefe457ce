#include "server/geometry/float_environment.hpp"

#if defined(__SSE2__)
#include <xmmintrin.h>
#elif defined(__aarch64__)
#include <cstdint>
#else
#error "This processor's floating-point control word is not known here"
#endif

namespace collided::engine {

#if defined(__SSE2__)

bool restore_float_environment() {
  using namespace float_environment;
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

OwnFloatEnvironment::OwnFloatEnvironment() {
  asm volatile("mrs %0, fpcr" : "=r"(host_[0]));
  asm volatile("mrs %0, fpsr" : "=r"(host_[1]));
  asm volatile("msr fpcr, %0" : : "r"(std::uint64_t{0}));
}

OwnFloatEnvironment::~OwnFloatEnvironment() {
  asm volatile("msr fpcr, %0" : : "r"(host_[0]));
  asm volatile("msr fpsr, %0" : : "r"(host_[1]));
}

#endif

}  // namespace collided::engine
