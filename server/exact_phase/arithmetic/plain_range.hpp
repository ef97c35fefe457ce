#pragma once

namespace collided::engine::kernel {

/// Squares whose sums and products neither lose their digits nor overflow; false for what is not a number.
inline bool in_plain_range(double largest_m2) { return largest_m2 > 0x1p-400 && largest_m2 < 0x1p400; }

}  // namespace collided::engine::kernel
