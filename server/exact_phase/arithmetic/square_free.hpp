#pragma once

#include "server/exact_phase/arithmetic/implicit_kernel.hpp"

namespace collided::engine::kernel {

/// A polynomial along a ray, with exact coefficients.
using ExactRayPolynomial = RayPolynomial<Dyadic>;

/// The greatest common divisor, trimmed, up to a constant factor. Both trimmed; zero and b give b.
///
/// source  primitive remainder sequence: Knuth, "The Art of Computer Programming", 4.6.1, algorithm E. If each
/// remainder kept its content, its digits would double with each step, too much for degree 8
ExactRayPolynomial common_divisor(const ExactRayPolynomial& a, const ExactRayPolynomial& b);

/// A polynomial with the same roots, each once. Trimmed, not zero.
ExactRayPolynomial square_free(const ExactRayPolynomial& polynomial);

}  // namespace collided::engine::kernel
