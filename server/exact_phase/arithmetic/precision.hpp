#pragma once

#include <cstdint>

#include "server/exact_phase/arithmetic/decision.hpp"

namespace collided::engine {

/// How much arithmetic the tests of one thread may use. The defaults decide everything and refine every number.
struct Precision {
  /// Rungs above this are not used: tests give `undecided` instead, and numbers keep the bound they have.
  Level highest = Level::rational;
  /// A distance, depth or time known to within this many metres is not refined further. Decisions stay exact.
  double error_asked_m = 0;
};

/// Counts of the rungs that one thread's tests have needed since it started.
struct RungCounts {
  std::uint64_t uncertain = 0;  // tests undecided by double with a running bound
  std::uint64_t expansion = 0;  // of those, tried with expansions or, out of a double's range, with scaled numbers
  std::uint64_t rational = 0;   // of those, decided by rationals
  std::uint64_t sharpened = 0;  // numbers calculated again because double knew too few digits
};

namespace kernel {
// Read only after a filter has failed, so that the certain majority never pays for it.
inline thread_local constinit Precision precision;
// Counted only after a filter has failed, for the same reason.
inline thread_local constinit RungCounts rungs;
}  // namespace kernel

/// Sets the calling thread's precision for the scope's lifetime; scopes nest.
class PrecisionScope {
 public:
  explicit PrecisionScope(const Precision& wanted) : before_(kernel::precision) { kernel::precision = wanted; }
  ~PrecisionScope() { kernel::precision = before_; }
  PrecisionScope(const PrecisionScope&) = delete;
  PrecisionScope& operator=(const PrecisionScope&) = delete;

 private:
  Precision before_;
};

}  // namespace collided::engine
