#pragma once

#include "server/exact_phase/motion/moving_kernel.hpp"

namespace collided::engine::kernel {

/// The last word, in rationals: real roots isolated, every condition's sign decided at them. `from` is a time up to
/// which contact is known not to be; at 0, the start itself is still open. The coordinates are finite.
Decision first_contact_exactly(const Quartet& q, double from, double width, TimeBracket& bracket);

}  // namespace collided::engine::kernel
