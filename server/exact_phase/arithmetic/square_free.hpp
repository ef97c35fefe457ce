#pragma once

#include "server/exact_phase/arithmetic/implicit_kernel.hpp"

namespace collided::engine::kernel {

using ExactRayPolynomial = RayPolynomial<Dyadic>;

/// The greatest common divisor, trimmed, times some number. Both trimmed; zero and b give b.
///
/// source  primitive remainder sequence: Knuth, "The Art of Computer Programming", 4.6.1, algorithm E. Without taking the
///         content out of every remainder, its digits would double with each step, which degree 8 has too many of.
ExactRayPolynomial common_divisor(const ExactRayPolynomial& a, const ExactRayPolynomial& b);

/// The same roots, each once. Trimmed, not zero.
ExactRayPolynomial square_free(const ExactRayPolynomial& polynomial);

}  // namespace collided::engine::kernel
