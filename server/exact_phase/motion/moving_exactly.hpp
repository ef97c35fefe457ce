#pragma once

#include "server/exact_phase/motion/moving_kernel.hpp"

namespace collided::engine::kernel {

/// The last rung, in rationals: isolates real roots and decides the sign of every condition at them. `from` is a time
/// before which there certainly is no contact; if it is 0, the start itself is still undecided. Coordinates must be
/// finite.
Decision first_contact_exactly(const Quartet& q, double from, double width, TimeBracket& bracket);

}  // namespace collided::engine::kernel
