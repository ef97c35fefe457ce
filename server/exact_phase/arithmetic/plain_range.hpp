#pragma once

namespace collided::engine::kernel {

/// Squared lengths in this range keep their digits in sums and products and do not overflow; false for NaN.
inline bool in_plain_range(double largest_m2) { return largest_m2 > 0x1p-400 && largest_m2 < 0x1p400; }

}  // namespace collided::engine::kernel
