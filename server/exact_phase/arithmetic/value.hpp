#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {

// Turns a kernel's numbers into reported doubles with bounds. Quotients and roots of exact numbers leave the range of
// double long before the answer does (the square of 1e-200 m), so the exponent is kept apart.

inline Scaled scaled(const Bounded& x) { return {x, 0}; }

inline Scaled scaled(const Traced& x) { return {{x.value, x.error}, 0}; }
inline Scaled scaled(const Scaled& x) { return x; }

inline Scaled scaled(const Expansion& x) {
  if (x.lost()) return {{0, std::numeric_limits<double>::infinity()}, 0};
  if (x.leading() == 0) return {};
  int power = 0;
  const double fraction = std::frexp(x.rounded(), &power);
  return {{fraction, x.single() ? 0 : 4 * kRoundoff}, power};
}

inline Scaled scaled(const Dyadic& x) {
  if (!x.finite()) return {{0, std::numeric_limits<double>::infinity()}, 0};
  const auto [fraction, power] = x.split();
  return {{fraction, x.short_mantissa() ? 0 : 2 * kRoundoff}, power};
}

/// Converts back to a double. Too large: the largest double, with an infinite bound.
inline Bounded plain(const Scaled& x) {
  if (x.power == 0) return x.value;
  const int clipped = static_cast<int>(std::clamp(x.power, -4000L, 4000L));
  const double value = std::ldexp(x.value.value, clipped);
  if (!std::isfinite(value)) {
    return {std::copysign(std::numeric_limits<double>::max(), value), std::numeric_limits<double>::infinity()};
  }
  // For denormals ldexp rounds again: the value, or an error that is much smaller than it.
  const bool value_cut = std::abs(value) < std::numeric_limits<double>::min() && !x.value.exactly_zero();
  const bool cut = value_cut || (x.value.error != 0 && std::abs(value) < kSmallestPlain);
  const double denormal = cut ? std::numeric_limits<double>::denorm_min() : 0.0;
  return {value, std::ldexp(x.value.error * (1 + kBoundSlack), clipped) + 2 * denormal};
}

template <class N>
double rounded(const N& x) {
  return plain(scaled(x)).value;
}

/// The same direction, scaled so that its longest component is near 1.
inline Vector<Bounded> in_range(const Vector<Scaled>& v) {
  const Scaled* component[3] = {&v.x, &v.y, &v.z};
  long power = std::numeric_limits<long>::min();
  for (const Scaled* c : component) {
    int own = 0;
    std::frexp(c->value.value, &own);
    if (c->value.value != 0) power = std::max(power, c->power + own);
  }
  if (power == std::numeric_limits<long>::min()) power = 0;
  return {shifted(v.x.value, v.x.power - power), shifted(v.y.value, v.y.power - power),
          shifted(v.z.value, v.z.power - power)};
}

/// True if scaling v by a power of two would change no digit of its unit vector: no square leaves the range of double.
inline bool has_plain_squares(const Vec3& v) {
  constexpr double kFarFromOne = 0x1p200;
  bool is_plain = true;
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    const double size = std::abs(v[i]);
    is_plain = is_plain && ((size >= 1 / kFarFromOne && size <= kFarFromOne) || size == 0);
    largest = std::max(largest, size);
  }
  return is_plain && largest > 0;
}

/// The unit vector along v, or zero if v is zero.
template <class N>
Vec3 unit(const Vector<N>& v) {
  if constexpr (std::same_as<N, Bounded>) {
    const Vec3 plain(v.x.value, v.y.value, v.z.value);
    if (has_plain_squares(plain)) return plain / std::sqrt(plain.squaredNorm());
  }
  const Vector<Bounded> near_one = in_range({scaled(v.x), scaled(v.y), scaled(v.z)});
  const Vec3 result(near_one.x.value, near_one.y.value, near_one.z.value);
  return result.isZero(0) ? Vec3(Vec3::Zero()) : Vec3(result / std::sqrt(result.squaredNorm()));
}

inline Vec3 unit(const Vec3& v) { return unit(Vector<Bounded>(v)); }

/// The smaller of two values; if their intervals overlap, the bound covers both.
inline Bounded lesser(const Bounded& a, const Bounded& b) {
  if (a.high() < b.low()) return a;
  if (b.high() < a.low()) return b;
  return min(a, b);
}
inline Bounded greater(const Bounded& a, const Bounded& b) { return -lesser(-a, -b); }

/// True if a value is precise enough to report: within the relative width below which an exact evaluation pays, within
/// the error that the thread's precision allows, or if that allows no exact evaluation.
inline bool sharp(const Bounded& x, double relative_width) {
  const double bound = x.bound();
  if (!std::isfinite(bound)) return false;
  return bound <= relative_width * std::abs(x.value) || bound <= precision.error_asked_m ||
         precision.highest == Level::filter;
}

/// A distance along a ray that is precise enough to report.
inline bool crisp(const Bounded& along_ray) { return sharp(along_ray, kRefineRay); }

}  // namespace collided::engine::kernel
