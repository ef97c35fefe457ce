#pragma once

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace collided::client {

/// An exact number: a sum of doubles whose digits do not overlap, smallest first. If a product leaves the range of
/// double, the number is lost: it answers every question below with no, so that it proves nothing.
/// source  Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997
class ExactSum {
 public:
  ExactSum(double x = 0) { add(x); }  // NOLINT: a double is an exact number
  explicit ExactSum(const std::vector<double>& terms) {
    for (const double x : terms) add(x);
  }

  bool at_most_zero() const { return !lost_ && (terms_.empty() || terms_.back() < 0); }
  bool below_zero() const { return !lost_ && !terms_.empty() && terms_.back() < 0; }
  bool at_least_zero() const { return !lost_ && (terms_.empty() || terms_.back() > 0); }
  bool above_zero() const { return !lost_ && !terms_.empty() && terms_.back() > 0; }
  bool zero() const { return !lost_ && terms_.empty(); }

  friend ExactSum operator+(ExactSum a, const ExactSum& b) {
    for (const double x : b.terms_) a.add(x);
    a.lost_ = a.lost_ || b.lost_;
    return a;
  }
  friend ExactSum operator*(const ExactSum& a, const ExactSum& b) {
    ExactSum result;
    result.lost_ = a.lost_ || b.lost_;
    for (const double x : a.terms_) {
      for (const double y : b.terms_) {
        const double product = x * y;
        // The rounding error of a smaller product may not be a double.
        constexpr double kSmallestExactProduct = 0x1p-960;
        result.lost_ = result.lost_ || !(std::abs(product) > kSmallestExactProduct);
        result.add(std::fma(x, y, -product));
        result.add(product);
      }
    }
    return result;
  }
  friend ExactSum operator-(ExactSum a) {
    for (double& term : a.terms_) term = -term;
    return a;
  }
  friend ExactSum operator-(const ExactSum& a, const ExactSum& b) { return a + -b; }

 private:
  // Adds one double: each term gives its sum with x to the next, and keeps the exact rounding error.
  void add(double x) {
    std::vector<double> grown;
    for (const double term : terms_) {
      const double sum = x + term;
      const double part = sum - x;
      const double rest = (x - (sum - part)) + (term - part);
      if (rest != 0) grown.push_back(rest);
      x = sum;
    }
    if (x != 0) grown.push_back(x);
    lost_ = lost_ || !std::isfinite(x);
    terms_ = std::move(grown);
  }

  std::vector<double> terms_;
  bool lost_ = false;
};

/// A vector of exact numbers, with the usual operations.
using ExactVector = std::array<ExactSum, 3>;

inline ExactVector exact(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
inline ExactVector operator-(const ExactVector& a, const ExactVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline ExactVector operator-(const ExactVector& v) { return {-v[0], -v[1], -v[2]}; }
inline ExactVector operator+(const ExactVector& a, const ExactVector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline ExactVector operator*(const ExactSum& s, const ExactVector& v) { return {s * v[0], s * v[1], s * v[2]}; }
inline ExactSum dot(const ExactVector& a, const ExactVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline ExactVector cross(const ExactVector& a, const ExactVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline ExactSum square(const ExactVector& v) { return dot(v, v); }
inline bool zero(const ExactVector& v) { return v[0].zero() && v[1].zero() && v[2].zero(); }

}  // namespace collided::client
