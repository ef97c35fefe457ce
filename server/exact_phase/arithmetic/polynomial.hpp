#pragma once

#include <array>
#include <utility>

#include "server/exact_phase/arithmetic/number.hpp"

namespace collided::engine::kernel {

/// Binomial coefficients: entry [n][j] is n over j.
template <int kRows>
constexpr std::array<std::array<double, kRows>, kRows> binomials() {
  std::array<std::array<double, kRows>, kRows> rows{};
  for (int n = 0; n < kRows; ++n) {
    rows[n][0] = 1;
    for (int j = 1; j <= n; ++j) rows[n][j] = rows[n - 1][j - 1] + (j < n ? rows[n - 1][j] : 0);
  }
  return rows;
}

/// A polynomial in time or in a ray's parameter, over a number type; it supports + - * like a number, so the vectors of
/// number.hpp can hold it: the coplanarity of four moving points is dot(a, cross(b, c)) of polynomials of degree 1.
///
/// range  degree kDegree; a product of higher degree is an error of the caller
template <class N, int kDegree = 3>
class Polynomial {
 public:
  static constexpr int kCoefficients = kDegree + 1;
  using Coefficients = std::array<N, kCoefficients>;

  Polynomial() = default;  // zero
  explicit Polynomial(N constant) : count_(1) { coefficient_[0] = std::move(constant); }
  Polynomial(N at_zero, N slope) : count_(2) {
    coefficient_[0] = std::move(at_zero);
    coefficient_[1] = std::move(slope);
  }

  /// The first `count` coefficients, the constant first.
  Polynomial(Coefficients coefficient, int count) : coefficient_(std::move(coefficient)), count_(count) {}

  /// Number of coefficients, 0 for the zero polynomial; the highest ones may be zero until trim().
  int count() const { return count_; }
  const N& operator[](int power) const { return coefficient_[power]; }

  /// Drops the highest coefficients that are exactly zero.
  void trim() {
    while (count_ > 0 && sign(coefficient_[count_ - 1]) == Sign::zero) --count_;
  }

  /// Divided by its variable; the constant coefficient must be zero.
  Polynomial without_root_at_zero() const {
    Polynomial result;
    result.count_ = count_ - 1;
    for (int i = 1; i < count_; ++i) result.coefficient_[i - 1] = coefficient_[i];
    return result;
  }

  N at(const N& t) const {
    if (count_ == 0) return N(0.0);
    N value = coefficient_[count_ - 1];
    for (int i = count_ - 2; i >= 0; --i) value = value * t + coefficient_[i];
    return value;
  }

  Polynomial derivative() const {
    Polynomial result;
    result.count_ = count_ > 0 ? count_ - 1 : 0;
    for (int i = 1; i < count_; ++i) result.coefficient_[i - 1] = N(static_cast<double>(i)) * coefficient_[i];
    return result;
  }

  /// The Bernstein coefficients on [low, high], each times its binomial: entry j belongs to (t - low)^j (high -
  /// t)^(degree - j). If all have the same sign, so has the polynomial (Bernstein), and their sign changes exceed the
  /// number of roots in the open interval by an even number (Descartes).
  Coefficients on_span(const N& low, const N& high) const {
    static constexpr auto kBinomial = binomials<kCoefficients>();
    Coefficients span;
    if (count_ == 0) return span;
    span[0] = coefficient_[count_ - 1];
    for (int degree = 1; degree < count_; ++degree) {
      const N& next = coefficient_[count_ - 1 - degree];
      span[degree] = span[degree - 1] * high + next;
      for (int j = degree - 1; j > 0; --j) {
        span[j] = (span[j] * low + span[j - 1] * high) + next * N(kBinomial[degree][j]);
      }
      span[0] = span[0] * low + next;
    }
    return span;
  }

  /// The sign on the whole closed interval; unsure if it changes or cannot be determined.
  Sign sign_on(const N& low, const N& high) const {
    if (count_ == 0) return Sign::zero;
    const Coefficients span = on_span(low, high);
    const Sign first = sign(span[0]);
    for (int j = 1; j < count_; ++j) {
      if (sign(span[j]) != first) return Sign::unsure;
    }
    return first;
  }

  friend Polynomial operator-(Polynomial a) {
    for (int i = 0; i < a.count_; ++i) a.coefficient_[i] = -a.coefficient_[i];
    return a;
  }
  friend Polynomial operator+(const Polynomial& a, const Polynomial& b) {
    const Polynomial& longer = a.count_ < b.count_ ? b : a;
    Polynomial result = longer;
    const int common = a.count_ < b.count_ ? a.count_ : b.count_;
    for (int i = 0; i < common; ++i) result.coefficient_[i] = a.coefficient_[i] + b.coefficient_[i];
    return result;
  }
  friend Polynomial operator-(const Polynomial& a, const Polynomial& b) {
    Polynomial result = a;
    for (int i = 0; i < b.count_; ++i) {
      result.coefficient_[i] = i < a.count_ ? a.coefficient_[i] - b.coefficient_[i] : -b.coefficient_[i];
    }
    if (b.count_ > a.count_) result.count_ = b.count_;
    return result;
  }
  friend Polynomial operator*(const Polynomial& a, const Polynomial& b) {
    Polynomial result;
    if (a.count_ == 0 || b.count_ == 0) return result;
    for (int i = 0; i < a.count_; ++i) {
      for (int j = 0; j < b.count_; ++j) {
        N& sum = result.coefficient_[i + j];
        N product = a.coefficient_[i] * b.coefficient_[j];
        sum = i + j < result.count_ ? sum + product : std::move(product);
        if (i + j >= result.count_) result.count_ = i + j + 1;
      }
    }
    return result;
  }

  /// Remainder and quotient of a by b: (quotient, remainder), both times a power of b's leading coefficient. Both
  /// trimmed, b not zero.
  static std::pair<Polynomial, Polynomial> divided(Polynomial a, const Polynomial& b) {
    Polynomial quotient;
    const N& top = b.coefficient_[b.count_ - 1];
    for (int shift = a.count_ - b.count_; shift >= 0; --shift) {
      const N lead = a.coefficient_[shift + b.count_ - 1];
      for (int i = 0; i < quotient.count_; ++i) quotient.coefficient_[i] = quotient.coefficient_[i] * top;
      if (quotient.count_ == 0) quotient.count_ = shift + 1;
      quotient.coefficient_[shift] = lead;
      for (int i = 0; i < shift + b.count_ - 1; ++i) a.coefficient_[i] = a.coefficient_[i] * top;
      for (int i = shift; i < shift + b.count_ - 1; ++i) {
        a.coefficient_[i] = a.coefficient_[i] - lead * b.coefficient_[i - shift];
      }
      a.count_ = shift + b.count_ - 1;
    }
    a.trim();
    return {std::move(quotient), std::move(a)};
  }

 private:
  Coefficients coefficient_{};
  int count_ = 0;
};

}  // namespace collided::engine::kernel
