#pragma once

#include <algorithm>
#include <cmath>

#include "server/geometry/bounded.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {

/// value * 2^power: a double with its bound and a separate exponent, so that no square or product of doubles leaves the
/// range (the square of 1e-200 m, a sphere of 1e300 m).
///
/// cost  about three times that of Bounded, a quarter of that of exact numbers (a point near a triangle)
struct Scaled {
  Bounded value;
  long power = 0;

  Scaled() = default;
  Scaled(const Bounded& value_in, long power_in) : value(value_in), power(power_in) {}
  Scaled(double exact) : value(exact) {  // NOLINT: a double is an exact number
    if (exact == 0 || !std::isfinite(exact) || is_near_one(std::abs(exact))) return;
    int own = 0;
    value = std::frexp(exact, &own);
    power = own;
  }

  /// True if products of two such values, and sums of those, stay far from both ends of a double's range.
  static bool is_near_one(double size) {
    constexpr double kFarFromOne = 0x1p200;
    return size >= 1 / kFarFromOne && size <= kFarFromOne;
  }
};

/// x * 2^power, with the rounding at the ends of the range.
inline Bounded shifted(const Bounded& x, long power) {
  if (power == 0) return x;
  const int clipped = static_cast<int>(std::clamp(power, -4000L, 4000L));
  return {std::ldexp(x.value, clipped), std::ldexp(x.error, clipped) + (x.exactly_zero() ? 0 : kUnderflow)};
}

/// The same number with a value near 1; if the value is zero, with an error near 1.
inline Scaled settled(const Bounded& value, long power) {
  const double size = std::max(std::abs(value.value), value.error);
  if (size == 0 || !std::isfinite(size) || Scaled::is_near_one(size)) return {value, power};
  int own = 0;
  std::frexp(size, &own);
  return {shifted(value, -own), power + own};
}

inline Scaled operator*(const Scaled& a, const Scaled& b) { return settled(a.value * b.value, a.power + b.power); }
inline Scaled operator/(const Scaled& a, const Scaled& b) { return settled(a.value / b.value, a.power - b.power); }
inline Scaled operator-(const Scaled& a) { return {-a.value, a.power}; }

inline Scaled operator+(const Scaled& a, const Scaled& b) {
  if (a.value.exactly_zero()) return b;
  if (b.value.exactly_zero()) return a;
  if (a.power == b.power) return settled(a.value + b.value, a.power);
  const long power = std::max(a.power, b.power);
  return settled(shifted(a.value, a.power - power) + shifted(b.value, b.power - power), power);
}
inline Scaled operator-(const Scaled& a, const Scaled& b) { return a + -b; }

inline Scaled abs(const Scaled& a) { return {abs(a.value), a.power}; }
/// If it is unknown which is greater, the bound covers both.
inline Scaled max(const Scaled& a, const Scaled& b) {
  const long power = std::max(a.power, b.power);
  return settled(max(shifted(a.value, a.power - power), shifted(b.value, b.power - power)), power);
}

/// x must be >= 0.
inline Scaled sqrt(const Scaled& x) {
  const bool odd = x.power % 2 != 0;
  return {engine::sqrt(odd ? Bounded(2) * x.value : x.value), (x.power - (odd ? 1 : 0)) / 2};
}

}  // namespace collided::engine::kernel
