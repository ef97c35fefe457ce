#pragma once

#include <cstdint>

#include "idl/clocks.hpp"

namespace collided::engine {

/// When a search has to end. The search asks at each of its tests, so that no walk runs on after its time; without a
/// deadline that costs one comparison.
///
/// cost     reads the clock at every kTestsAReading-th call
/// threads  one
class Deadline {
 public:
  Deadline() = default;
  /// at_ns  steady clock; 0: none
  explicit Deadline(std::int64_t at_ns) : at_ns_(at_ns) {}

  /// Whether the search has to end now; once true, always.
  bool is_over() { return at_ns_ != 0 && look(); }
  /// Whether is_over() was ever true: the search was cut short, and what it has not found is unknown.
  bool was_over() const { return was_over_; }

 private:
  /// A test takes from 0.1 us to some 100 us, a reading of the clock 0.03 us.
  static constexpr std::uint32_t kTestsAReading = 8;

  bool look() {
    if (was_over_ || tests_++ % kTestsAReading != 0) return was_over_;
    return was_over_ = wire_contract::steady_ns() > at_ns_;
  }

  std::int64_t at_ns_ = 0;
  std::uint32_t tests_ = 0;
  bool was_over_ = false;
};

}  // namespace collided::engine
