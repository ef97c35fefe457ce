#pragma once

#include "server/exact_phase/arithmetic/dyadic.hpp"

namespace collided::engine {

/// A number of 256 bits, cut after each operation: for searches for which double is too coarse; their results are then
/// tested exactly. The exponent is practically unlimited.
///
/// cost  about 0.2 us per operation; allocates
class LongFloat {
 public:
  LongFloat() = default;
  LongFloat(double exact) : value_(exact) {}  // NOLINT: a double is an exact number
  explicit LongFloat(const Dyadic& value) : value_(cut(value)) {}

  /// Its value, exactly.
  const Dyadic& exact() const { return value_; }
  int sign() const { return value_.sign(); }

  friend LongFloat operator-(const LongFloat& a) { return LongFloat(-a.value_); }
  friend LongFloat operator+(const LongFloat& a, const LongFloat& b) { return LongFloat(a.value_ + b.value_); }
  friend LongFloat operator-(const LongFloat& a, const LongFloat& b) { return LongFloat(a.value_ - b.value_); }
  friend LongFloat operator*(const LongFloat& a, const LongFloat& b) { return LongFloat(a.value_ * b.value_); }
  /// b must not be zero.
  friend LongFloat operator/(const LongFloat& a, const LongFloat& b) {
    const mpz_class raised = a.value_.mantissa() << 2 * kBits;
    return LongFloat(Dyadic(raised / b.value_.mantissa(), a.value_.exponent() - b.value_.exponent() - 2 * kBits));
  }
  /// a must not be negative.
  friend LongFloat sqrt(const LongFloat& a) {
    const long up = 2 * kBits + (a.value_.exponent() & 1);
    const mpz_class raised = a.value_.mantissa() << static_cast<mp_bitcnt_t>(up);
    return LongFloat(Dyadic(mpz_class(sqrt(raised)), (a.value_.exponent() - up) / 2));
  }

 private:
  static constexpr long kBits = 256;

  static Dyadic cut(const Dyadic& value) {
    const long excess = static_cast<long>(mpz_sizeinbase(value.mantissa().get_mpz_t(), 2)) - kBits;
    if (excess <= 0) return value;
    mpz_class mantissa;
    mpz_tdiv_q_2exp(mantissa.get_mpz_t(), value.mantissa().get_mpz_t(), static_cast<mp_bitcnt_t>(excess));
    return {std::move(mantissa), value.exponent() + excess};
  }

  Dyadic value_;
};

}  // namespace collided::engine
