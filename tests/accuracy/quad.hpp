#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "tests/accuracy/census/grid_truth.hpp"

namespace collided::census {

/// 113 bits: the truth of a root or quotient of whole numbers, 2^-60 of a rounding in double.
__extension__ typedef __float128 Quad;

inline Quad quad(const Int128& x) { return static_cast<Quad>(x); }
template <int kLimbs>
Quad quad(const WideInt<kLimbs>& x) {
  if (x.negative()) return -quad(-x);
  Quad value = 0;
  for (int i = kLimbs - 1; i >= 0; --i) value = value * static_cast<Quad>(0x1p64) + static_cast<Quad>(x.limb(i));
  return value;
}

/// By Newton's method from the root in double, which is twelve digits more than two steps need.
inline Quad root(Quad x) {
  if (x <= 0) return 0;
  Quad y = static_cast<Quad>(std::sqrt(static_cast<double>(x)));
  for (int step = 0; step < 3; ++step) y = (y + x / y) / 2;
  return y;
}

template <class T>
Quad quad(const Fraction<T>& f) {
  return quad(f.numerator) / quad(f.denominator);
}

}  // namespace collided::census
