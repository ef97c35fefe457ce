#pragma once

namespace collided::engine {

/// The rounding error of the sum of two doubles: a + b is exactly sum + lost_in_sum(a, b, sum), unless it overflows.
///
/// sum     a + b in double
/// source  Knuth, "The Art of Computer Programming", vol. 2, 4.2.2, theorem B (TwoSum)
constexpr double lost_in_sum(double a, double b, double sum) {
  const double b_part = sum - a;
  return (a - (sum - b_part)) + (b - b_part);
}

}  // namespace collided::engine
