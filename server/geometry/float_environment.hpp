#pragma once

namespace collided {

/// The proofs assume rounding to nearest, denormals kept and no traps. A library built with -ffast-math turns denormals
/// off for the thread that loads it, and threads inherit that. Sets the calling thread's floating-point environment
/// back where it differs.
///
/// returns  true if it had to be set back
/// cost     a few nanoseconds
bool restore_float_environment();

}  // namespace collided
