#pragma once

#include <array>
#include <bit>
#include <compare>
#include <cstdint>

namespace collided::census {

__extension__ typedef __int128 Int128;
__extension__ typedef unsigned __int128 Unsigned128;

/// A whole number of 64 * kLimbs bits, two's complement, that wraps around like the built-in ones: the census keeps
/// its inputs so small that nothing wraps.
///
/// cost  a product of 4 limbs about 6 ns, of 8 about 25; no allocation
template <int kLimbs>
class WideInt {
 public:
  constexpr WideInt() = default;
  constexpr WideInt(std::int64_t value) {  // NOLINT: a whole number is a whole number
    limb_.fill(value < 0 ? ~std::uint64_t{0} : 0);
    limb_[0] = static_cast<std::uint64_t>(value);
  }

  constexpr bool negative() const { return limb_[kLimbs - 1] >> 63 != 0; }
  constexpr std::uint64_t limb(int i) const { return limb_[static_cast<std::size_t>(i)]; }
  constexpr bool zero() const {
    std::uint64_t any = 0;
    for (const std::uint64_t limb : limb_) any |= limb;
    return any == 0;
  }

  friend constexpr WideInt operator+(const WideInt& a, const WideInt& b) {
    WideInt sum;
    unsigned char carry = 0;
#pragma GCC unroll 8
    for (int i = 0; i < kLimbs; ++i) {
      const Unsigned128 part = static_cast<Unsigned128>(a.limb_[i]) + b.limb_[i] + carry;
      sum.limb_[i] = static_cast<std::uint64_t>(part);
      carry = static_cast<unsigned char>(part >> 64);
    }
    return sum;
  }
  friend constexpr WideInt operator-(const WideInt& a) {
    WideInt flipped;
    for (int i = 0; i < kLimbs; ++i) flipped.limb_[i] = ~a.limb_[i];
    return flipped + WideInt(1);
  }
  friend constexpr WideInt operator-(const WideInt& a, const WideInt& b) {
    WideInt rest;
    unsigned char borrow = 0;
#pragma GCC unroll 8
    for (int i = 0; i < kLimbs; ++i) {
      const Unsigned128 part = static_cast<Unsigned128>(a.limb_[i]) - b.limb_[i] - borrow;
      rest.limb_[i] = static_cast<std::uint64_t>(part);
      borrow = static_cast<unsigned char>((part >> 64) & 1);
    }
    return rest;
  }
  friend constexpr WideInt operator*(const WideInt& a, const WideInt& b) {
    WideInt product;
#pragma GCC unroll 8
    for (int i = 0; i < kLimbs; ++i) {
      std::uint64_t carry = 0;
#pragma GCC unroll 8
      for (int j = 0; j < kLimbs - i; ++j) {
        const Unsigned128 part = static_cast<Unsigned128>(a.limb_[i]) * b.limb_[j] + product.limb_[i + j] + carry;
        product.limb_[i + j] = static_cast<std::uint64_t>(part);
        carry = static_cast<std::uint64_t>(part >> 64);
      }
    }
    return product;
  }

  friend constexpr bool operator==(const WideInt& a, const WideInt& b) { return a.limb_ == b.limb_; }
  friend constexpr std::strong_ordering operator<=>(const WideInt& a, const WideInt& b) {
    const WideInt rest = a - b;
    if (rest.zero()) return std::strong_ordering::equal;
    return rest.negative() ? std::strong_ordering::less : std::strong_ordering::greater;
  }

  /// The nearest double or a neighbour of it.
  double approximate() const {
    if (negative()) return -(-*this).approximate();
    double value = 0;
    for (int i = kLimbs - 1; i >= 0; --i) value = value * 0x1p64 + static_cast<double>(limb_[i]);
    return value;
  }

 private:
  std::array<std::uint64_t, kLimbs> limb_{};
};

template <int kLimbs>
double approximate(const WideInt<kLimbs>& x) {
  return x.approximate();
}
inline double approximate(Int128 x) { return static_cast<double>(x); }

}  // namespace collided::census
