#pragma once

#include <cmath>
#include <limits>

#include "server/geometry/lost_in_sum.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

/// A double with a proved bound on its distance from the exact value (running error analysis: Higham, "Accuracy and
/// Stability of Numerical Algorithms", 3.3). Overflow makes the bound infinite or NaN, and every predicate about such a
/// number answers "unsure".
///
/// error  never read it directly: bound() adds the slack for the roundings of the error terms themselves
struct Bounded {
  double value = 0;
  double error = 0;

  constexpr Bounded() = default;
  constexpr Bounded(double exact) : value(exact) {}  // NOLINT: a double is an exact number
  constexpr Bounded(double approximate, double bound) : value(approximate), error(bound) {}

  double bound() const { return error * (1 + kBoundSlack); }
  double low() const { return value - bound() * (1 + kBoundSlack) - kRoundoff * 2 * std::abs(value); }
  double high() const { return value + bound() * (1 + kBoundSlack) + kRoundoff * 2 * std::abs(value); }
  bool exactly_zero() const { return std::abs(value) + error == 0; }
};

inline Bounded operator-(const Bounded& a) { return {-a.value, a.error}; }

inline Bounded operator+(const Bounded& a, const Bounded& b) {
  const double value = a.value + b.value;
  return {value, (a.error + b.error) + kRoundoff * std::abs(value)};
}

inline Bounded operator-(const Bounded& a, const Bounded& b) {
  const double value = a.value - b.value;
  return {value, (a.error + b.error) + kRoundoff * std::abs(value)};
}

inline Bounded operator*(const Bounded& a, const Bounded& b) {
  const double value = a.value * b.value;
  const double error = (std::abs(a.value) * b.error + std::abs(b.value) * a.error) + a.error * b.error;
  // A factor that is exactly zero gives exactly zero; otherwise no sign would ever be certain in axis-aligned scenes.
  const double underflow = a.exactly_zero() || b.exactly_zero() ? 0.0 : kUnderflow;
  return {value, (error + kRoundoff * std::abs(value)) + underflow};
}

/// The bound is infinite if the divisor may be zero.
inline Bounded operator/(const Bounded& a, const Bounded& b) {
  if (a.exactly_zero() && std::abs(b.value) > b.bound()) return {};
  const double smallest_divisor = std::abs(b.value) - b.bound() * (1 + kBoundSlack);
  if (!(smallest_divisor > 0)) return {0, std::numeric_limits<double>::infinity()};
  const double value = a.value / b.value;
  const double error = (a.error + std::abs(value) * b.error) / smallest_divisor * (1 + kBoundSlack);
  return {value, (error + 2 * kRoundoff * std::abs(value)) + kUnderflow};
}

inline Bounded abs(const Bounded& a) { return {std::abs(a.value), a.error}; }

/// Keeps a NaN bound, which must not vanish behind a number.
inline double greater_error(double a, double b) { return a > b || a != a ? a : b; }

inline Bounded max(const Bounded& a, const Bounded& b) {
  return {a.value > b.value ? a.value : b.value, greater_error(a.error, b.error)};
}

inline Bounded min(const Bounded& a, const Bounded& b) { return -max(-a, -b); }

/// Like Bounded, but each operation adds its actual error, found by an error-free transformation. Half as fast, but
/// exact (error 0, signs of zero included) on small integers, halves and the like, at which scenes touch.
/// Source: Knuth (sum), Dekker (product); Ogita, Rump, Oishi, "Accurate Sum and Dot Product", 2005.
struct Traced {
  double value = 0;
  double error = 0;

  constexpr Traced() = default;
  constexpr Traced(double exact) : value(exact) {}  // NOLINT: a double is an exact number
  constexpr Traced(double approximate, double bound) : value(approximate), error(bound) {}

  double bound() const { return error * (1 + kBoundSlack); }
  bool exactly_zero() const { return std::abs(value) + error == 0; }
};

inline Traced operator-(const Traced& a) { return {-a.value, a.error}; }

inline Traced operator+(const Traced& a, const Traced& b) {
  const double value = a.value + b.value;
  return {value, (a.error + b.error) + std::abs(lost_in_sum(a.value, b.value, value))};
}

inline Traced operator-(const Traced& a, const Traced& b) { return a + -b; }

inline Traced operator*(const Traced& a, const Traced& b) {
  const double value = a.value * b.value;
  // Returns the product instead of zero: the other factor may be NaN.
  if (a.exactly_zero() || b.exactly_zero()) return value;
  constexpr double kSplit = 0x1p27 + 1;
  const double a_big = kSplit * a.value;
  const double b_big = kSplit * b.value;
  const double a_high = a_big - (a_big - a.value);
  const double b_high = b_big - (b_big - b.value);
  const double a_low = a.value - a_high;
  const double b_low = b.value - b_high;
  const double lost = a_low * b_low - (((value - a_high * b_high) - a_low * b_high) - a_high * b_low);
  const double error = (std::abs(a.value) * b.error + std::abs(b.value) * a.error) + a.error * b.error;
  // If a factor is too large to split, `lost` and the bound become NaN; if the product is too small, `lost` may
  // underflow. So may the product of an error: 2^-1074 times a quarter would look like zero.
  const bool error_underflows = error < kUnderflow && a.error + b.error != 0;
  const double underflow = std::abs(value) < kSmallestPlain || error_underflows ? kUnderflow : 0.0;
  return {value, (error + std::abs(lost)) + underflow};
}

inline Traced abs(const Traced& a) { return {std::abs(a.value), a.error}; }
inline Traced max(const Traced& a, const Traced& b) {
  return {a.value > b.value ? a.value : b.value, greater_error(a.error, b.error)};
}

/// The square root of a number known to be >= 0 (its value may be slightly below).
inline Bounded sqrt(const Bounded& a) {
  if (a.exactly_zero()) return {};
  const double value = a.value > 0 ? std::sqrt(a.value) : 0;
  const double bound = a.bound();
  // |sqrt(x + e) - sqrt(x)| <= sqrt(e), and <= e / sqrt(x) if that is less.
  const double far = bound < a.value ? bound / value : std::sqrt(bound + std::abs(std::fmin(a.value, 0.0)));
  return {value, far * (1 + kBoundSlack) + 2 * kRoundoff * value + kUnderflow};
}

}  // namespace collided::engine
