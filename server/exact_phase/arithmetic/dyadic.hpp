#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

namespace collided::engine {

/// An exact rational whose denominator is a power of two: mantissa * 2^exponent. Sums, differences and products of
/// doubles never leave this set, so no common divisor is ever computed. A number that is not finite has no sign.
///
/// cost  about 0.1 to 0.3 us per operation; allocates
class Dyadic {
 public:
  Dyadic() = default;
  Dyadic(double exact) : Dyadic(short_of(exact)) {}  // NOLINT: a double is an exact number

  Dyadic(mpz_class mantissa, long exponent) : mantissa_(std::move(mantissa)), exponent_(exponent) {}

  bool finite() const { return finite_; }
  /// The number is mantissa() * 2^exponent().
  const mpz_class& mantissa() const { return mantissa_; }
  long exponent() const { return exponent_; }
  int sign() const { return sgn(mantissa_); }

  /// The number as fraction * 2^power with 0.5 <= |fraction| < 1, cut to 53 bits (or 0, 0).
  std::pair<double, long> split() const {
    if (sign() == 0) return {0.0, 0};
    long power;
    const double fraction = mpz_get_d_2exp(&power, mantissa_.get_mpz_t());
    return {fraction, power + exponent_};
  }

  /// True if split() would lose no digit.
  bool short_mantissa() const { return mpz_sizeinbase(mantissa_.get_mpz_t(), 2) <= 53; }

  friend Dyadic operator-(Dyadic a) {
    mpz_neg(a.mantissa_.get_mpz_t(), a.mantissa_.get_mpz_t());
    return a;
  }
  friend Dyadic operator+(const Dyadic& a, const Dyadic& b) { return sum(a, b, false); }
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return sum(a, b, true); }
  // Operations that reuse the memory of a temporary if possible; same numbers in the same form.
  friend Dyadic operator+(Dyadic&& a, const Dyadic& b) { return sum_in_place(std::move(a), b, false); }
  friend Dyadic operator-(Dyadic&& a, const Dyadic& b) { return sum_in_place(std::move(a), b, true); }
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    Dyadic result;
    result.finite_ = a.finite_ && b.finite_;
    mpz_mul(result.mantissa_.get_mpz_t(), a.mantissa_.get_mpz_t(), b.mantissa_.get_mpz_t());
    result.exponent_ = a.exponent_ + b.exponent_;
    return result;
  }
  /// b * a, without constructing a number for b.
  friend Dyadic times(const Dyadic& a, double b) {
    const Short factor = short_of(b);
    Dyadic result;
    result.finite_ = a.finite_ && factor.finite;
    mpz_mul_si(result.mantissa_.get_mpz_t(), a.mantissa_.get_mpz_t(), factor.mantissa);
    result.exponent_ = a.exponent_ + factor.exponent;
    return result;
  }

 private:
  /// A double as mantissa * 2^exponent. The mantissa is odd, or zero: mantissas stay short, since most scenes are full
  /// of small integers and halves.
  struct Short {
    long mantissa = 0;
    long exponent = 0;
    bool finite = true;
  };
  static Short short_of(double exact) {
    constexpr int kFractionBits = 52;
    constexpr std::uint64_t kHidden = std::uint64_t{1} << kFractionBits;
    constexpr long kMostBiased = 0x7ff;
    const auto bits = std::bit_cast<std::uint64_t>(exact);
    const auto biased = static_cast<long>(bits >> kFractionBits) & kMostBiased;
    if (biased == kMostBiased) return {.finite = false};
    const std::uint64_t fraction = (bits & (kHidden - 1)) | (biased != 0 ? kHidden : 0);
    if (fraction == 0) return {};
    const int zeros = std::countr_zero(fraction);
    const auto mantissa = static_cast<long>(fraction >> zeros);
    return {.mantissa = std::signbit(exact) ? -mantissa : mantissa,
            .exponent = std::max(biased, 1L) - (1'023 + kFractionBits) + zeros};
  }
  explicit Dyadic(const Short& exact) : mantissa_(exact.mantissa), exponent_(exact.exponent), finite_(exact.finite) {}

  static Dyadic sum_in_place(Dyadic&& a, const Dyadic& b, bool subtract) {
    if (&a == &b || (b.sign() != 0 && a.sign() != 0 && a.exponent_ < b.exponent_)) return sum(a, b, subtract);
    a.finite_ = a.finite_ && b.finite_;
    if (b.sign() == 0) return std::move(a);
    if (a.sign() != 0 && a.exponent_ > b.exponent_) {
      mpz_mul_2exp(a.mantissa_.get_mpz_t(), a.mantissa_.get_mpz_t(),
                   static_cast<mp_bitcnt_t>(a.exponent_ - b.exponent_));
    }
    a.exponent_ = b.exponent_;
    if (subtract) a.mantissa_ -= b.mantissa_;
    else a.mantissa_ += b.mantissa_;
    return std::move(a);
  }
  static Dyadic sum(const Dyadic& a, const Dyadic& b, bool subtract) {
    Dyadic result;
    result.finite_ = a.finite_ && b.finite_;
    if (b.sign() == 0) {
      result.mantissa_ = a.mantissa_;
      result.exponent_ = a.exponent_;
    } else if (a.sign() == 0 || a.exponent_ >= b.exponent_) {
      const long shift = a.sign() == 0 ? 0 : a.exponent_ - b.exponent_;
      mpz_mul_2exp(result.mantissa_.get_mpz_t(), a.mantissa_.get_mpz_t(), static_cast<mp_bitcnt_t>(shift));
      result.exponent_ = b.exponent_;
      if (subtract) result.mantissa_ -= b.mantissa_;
      else result.mantissa_ += b.mantissa_;
    } else {
      const long shift = b.exponent_ - a.exponent_;
      mpz_mul_2exp(result.mantissa_.get_mpz_t(), b.mantissa_.get_mpz_t(), static_cast<mp_bitcnt_t>(shift));
      result.exponent_ = a.exponent_;
      if (subtract) mpz_neg(result.mantissa_.get_mpz_t(), result.mantissa_.get_mpz_t());
      result.mantissa_ += a.mantissa_;
    }
    return result;
  }

  mpz_class mantissa_ = 0;
  long exponent_ = 0;
  bool finite_ = true;
};

}  // namespace collided::engine
