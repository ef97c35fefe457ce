#pragma once

namespace collided::engine::kernel {

/// Squared lengths in this range keep their digits in sums and products and do not overflow; false for NaN.
inline constexpr double kLargestPlain2 = 0x1p400;
inline bool in_plain_range(double largest_m2) { return largest_m2 > 1 / kLargestPlain2 && largest_m2 < kLargestPlain2; }

}  // namespace collided::engine::kernel
