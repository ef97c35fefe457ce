#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "server/geometry/vector.hpp"

namespace collided::engine {

/// One step of a polynomial in x, y, z on a stack of values: the author's formula in postfix order. Kept as written
/// instead of expanded, because products of its doubles need not be doubles.
struct PolynomialStep {
  enum class Kind : std::uint8_t { constant, x, y, z, add, subtract, multiply, negate, power };
  Kind kind = Kind::constant;
  std::uint8_t exponent = 0;  // exponent of a power
  double constant = 0;
};

/// The points with f(x, y, z) = 0 in a closed box; f < 0 is its inside. Steps and degree must be those of a valid
/// polynomial within the limits below; code that fills this by hand must keep them.
struct ImplicitSurface {
  /// The degree as written, before anything cancels.
  static constexpr int kMostDegree = 8;
  /// Constants and variables included: so that fewer than 2^13 roundings follow each other (kBoundSlack).
  static constexpr int kMostSteps = 1000;
  /// Values on the stack at one time.
  static constexpr int kMostStack = 16;

  std::vector<PolynomialStep> steps;
  int degree = 0;
  Vec3 low = Vec3::Constant(-std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(std::numeric_limits<double>::infinity());
};

}  // namespace collided::engine
