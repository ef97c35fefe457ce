#pragma once

namespace collided::engine::kernel {

/// Squares whose sums and products neither lose their digits nor overflow; false for what is not a number.
inline constexpr double kLargestPlain2 = 0x1p400;
inline bool in_plain_range(double largest_m2) { return largest_m2 > 1 / kLargestPlain2 && largest_m2 < kLargestPlain2; }

}  // namespace collided::engine::kernel
