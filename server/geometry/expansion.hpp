#pragma once

#include <array>
#include <cmath>

#include "server/geometry/lost_in_sum.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

/// An exact sum of doubles that do not overlap, smallest first, without zeros. A sum that would need more than
/// kCapacity doubles, or leave the range in which a product's low half is exact, is `lost` and has no sign.
///
/// cost    about 0.1 us per product of short ones; no allocation
/// source  Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997
class Expansion {
 public:
  /// orient3d of doubles needs at most 192. With 231 the size is an odd number of cache lines, so that a kernel's many
  /// temporaries spread over the cache instead of sharing a few sets.
  static constexpr int kCapacity = 231;

  Expansion() = default;
  Expansion(double exact) {  // NOLINT: a double is an exact number
    if (!std::isfinite(exact)) lost_ = true;
    append(exact);
  }
  Expansion(const Expansion& other) { *this = other; }
  Expansion& operator=(const Expansion& other) {
    for (int i = 0; i < other.count_; ++i) part_[i] = other.part_[i];
    count_ = other.count_;
    lost_ = other.lost_;
    return *this;
  }

  bool lost() const { return lost_; }
  /// The largest part: its sign is that of the sum.
  double leading() const { return count_ == 0 ? 0.0 : part_[count_ - 1]; }
  /// True if the sum is at most one double: rounded() loses nothing.
  bool single() const { return count_ <= 1; }
  /// The sum in double; relative error at most 2^-51.
  double rounded() const {
    double sum = 0;
    for (int i = 0; i < count_; ++i) sum += part_[i];
    return sum;
  }

  friend Expansion operator-(const Expansion& a) {
    Expansion result(a);
    for (int i = 0; i < result.count_; ++i) result.part_[i] = -result.part_[i];
    return result;
  }
  friend Expansion operator+(const Expansion& a, const Expansion& b) { return sum(a, b, 1.0); }
  friend Expansion operator-(const Expansion& a, const Expansion& b) { return sum(a, b, -1.0); }
  friend Expansion operator*(const Expansion& a, const Expansion& b) {
    const Expansion& longer = a.count_ < b.count_ ? b : a;
    const Expansion& shorter = a.count_ < b.count_ ? a : b;
    Expansion result;
    result.lost_ = a.lost_ || b.lost_;
    for (int i = 0; i < shorter.count_ && !result.lost_; ++i) result = result + scaled(longer, shorter.part_[i]);
    return result;
  }

 private:
  void append(double part) {
    if (part == 0) return;
    if (count_ == kCapacity) {
      lost_ = true;
      return;
    }
    part_[count_++] = part;
  }

  static void two_sum(double a, double b, double& high, double& low) {
    high = a + b;
    low = lost_in_sum(a, b, high);
  }

  /// FAST-EXPANSION-SUM of a and factor * b (factor +-1): merge by size, then add upward.
  static Expansion sum(const Expansion& a, const Expansion& b, double factor) {
    Expansion result;
    result.lost_ = a.lost_ || b.lost_;
    int next_a = 0;
    int next_b = 0;
    double carry = 0;
    while (!result.lost_ && (next_a < a.count_ || next_b < b.count_)) {
      const bool take_a =
          next_b == b.count_ || (next_a < a.count_ && std::abs(a.part_[next_a]) < std::abs(b.part_[next_b]));
      const double part = take_a ? a.part_[next_a++] : factor * b.part_[next_b++];
      double low;
      two_sum(carry, part, carry, low);
      result.append(low);
    }
    result.append(carry);
    if (!std::isfinite(carry)) result.lost_ = true;
    return result;
  }

  /// SCALE-EXPANSION of a by one double.
  static Expansion scaled(const Expansion& a, double factor) {
    Expansion result;
    double carry = 0;
    for (int i = 0; i < a.count_ && !result.lost_; ++i) {
      const double product = a.part_[i] * factor;
      // Outside these bounds the low half of the product is not a double.
      if (!(std::abs(product) >= kSmallestExactProduct && std::abs(product) <= kLargestExactProduct))
        result.lost_ = true;
      const double product_low = std::fma(a.part_[i], factor, -product);
      double middle;
      double low;
      two_sum(carry, product_low, middle, low);
      result.append(low);
      two_sum(product, middle, carry, low);
      result.append(low);
    }
    result.append(carry);
    return result;
  }

  std::array<double, kCapacity> part_;
  int count_ = 0;
  bool lost_ = false;
};

}  // namespace collided::engine
