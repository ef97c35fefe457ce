#pragma once

#include <cmath>
#include <concepts>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/arithmetic/dyadic.hpp"
#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/arithmetic/range_watch.hpp"
#include "server/exact_phase/arithmetic/scaled.hpp"
#include "server/geometry/bounded.hpp"
#include "server/geometry/expansion.hpp"
#include "server/geometry/vector.hpp"

namespace collided::engine::kernel {

// The number types under one set of predicates. A kernel is written once, as a template over the number type N, and
// uses only N(double), + - * and the predicates below. "Undecided" may come from Bounded and Traced (too close), from
// Expansion (out of room) and from Scaled (too close, for numbers out of a double's range); Dyadic decides everything
// finite.

// A sign, or unsure if the number's bound contains zero.
enum class Sign : signed char { negative = -1, zero = 0, positive = 1, unsure = 2 };

template <class N>
concept Rounding = std::same_as<N, Bounded> || std::same_as<N, Traced>;
/// Number types that are known only up to a bound.
template <class N>
concept Inexact = Rounding<N> || std::same_as<N, Scaled>;

template <Rounding N>
Sign sign(const N& x) {
  if (x.value > x.bound()) return Sign::positive;
  if (x.value < -x.bound()) return Sign::negative;
  return x.exactly_zero() ? Sign::zero : Sign::unsure;
}

inline Sign sign(const Scaled& x) { return sign(x.value); }

inline Sign sign(const Expansion& x) {
  if (x.lost()) return Sign::unsure;
  const double leading = x.leading();
  return leading > 0 ? Sign::positive : leading < 0 ? Sign::negative : Sign::zero;
}

inline Sign sign(const Dyadic& x) { return x.finite() ? static_cast<Sign>(x.sign()) : Sign::unsure; }

template <class N>
Decision is_positive(const N& x) {
  const Sign s = sign(x);
  if (s == Sign::unsure) return Decision::undecided;
  return s == Sign::positive ? Decision::yes : Decision::no;
}

inline Decision opposite(Decision d) {
  if (d == Decision::undecided) return d;
  return d == Decision::yes ? Decision::no : Decision::yes;
}

template <class N>
Decision less(const N& a, const N& b) {
  return is_positive(b - a);
}

template <class N>
Decision at_most(const N& a, const N& b) {
  return opposite(is_positive(a - b));
}

template <class N>
Decision is_zero(const N& x) {
  const Sign s = sign(x);
  if (s == Sign::unsure) return Decision::undecided;
  return s == Sign::zero ? Decision::yes : Decision::no;
}

/// Yes as soon as one is yes; undecided if none is and one is undecided.
class AnyOf {
 public:
  /// True: the answer is yes, regardless of the rest.
  bool add(Decision d) {
    if (d != Decision::no && result_ != Decision::yes) result_ = d;
    return result_ == Decision::yes;
  }
  Decision result() const { return result_; }

 private:
  Decision result_ = Decision::no;
};

/// No as soon as one is no; undecided if none is and one is undecided.
class AllOf {
 public:
  /// True: the answer is no, regardless of the rest.
  bool add(Decision d) {
    if (d != Decision::yes && result_ != Decision::no) result_ = d;
    return result_ == Decision::no;
  }
  Decision result() const { return result_; }

 private:
  Decision result_ = Decision::yes;
};

inline Decision both(Decision a, Decision b) {
  AllOf all;
  all.add(a);
  all.add(b);
  return all.result();
}

inline Decision either(Decision a, Decision b) {
  AnyOf any;
  any.add(a);
  any.add(b);
  return any.result();
}

inline Expansion abs(const Expansion& x) { return x.leading() < 0 ? -x : x; }
inline Dyadic abs(Dyadic x) { return x.sign() < 0 ? -std::move(x) : std::move(x); }
using engine::abs;

/// The larger of two; without a sign if either has none.
inline Expansion max(const Expansion& a, const Expansion& b) {
  const Expansion rest = a - b;
  if (rest.lost()) return rest;
  return rest.leading() < 0 ? b : a;
}
inline Dyadic max(const Dyadic& a, const Dyadic& b) {
  const Dyadic rest = a - b;
  if (!rest.finite()) return rest;
  return rest.sign() < 0 ? b : a;
}
template <class N>
N min(const N& a, const N& b) {
  return -max(-a, -b);
}

/// Kernels take raw coordinates and first form differences of them, so that errors scale with the size of the
/// configuration instead of its distance from the origin, and equal points differ by exactly zero.
template <class N>
struct Vector {
  N x;
  N y;
  N z;

  Vector() = default;
  Vector(N x_in, N y_in, N z_in) : x(std::move(x_in)), y(std::move(y_in)), z(std::move(z_in)) {}
  explicit Vector(const Vec3& v) : x(v[0]), y(v[1]), z(v[2]) {}
};

template <class N>
Vector<N> operator-(const Vector<N>& a, const Vector<N>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class N>
Vector<N> operator+(const Vector<N>& a, const Vector<N>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class N>
Vector<N> operator-(const Vector<N>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class N>
Vector<N> operator*(const N& s, const Vector<N>& v) {
  return {s * v.x, s * v.y, s * v.z};
}
template <class N>
N dot(const Vector<N>& a, const Vector<N>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <class N>
N square(const Vector<N>& a) {
  return dot(a, a);
}
template <class N>
Vector<N> cross(const Vector<N>& a, const Vector<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Runs `kernel.operator()<N>()` on one number type after the other, until one decides or the thread's precision allows
/// no more.
template <class Kernel>
ExactResult climb(const Kernel& kernel) {
  Decision decision = kernel.template operator()<Bounded>();
  if (decision != Decision::undecided) return {decision, Level::filter};
  ++rungs.uncertain;
  const RangeWatch range;
  decision = kernel.template operator()<Traced>();
  if (decision != Decision::undecided || precision.highest == Level::filter) return {decision, Level::filter};
  ++rungs.expansion;
  // Out of range, expansions lose digits; such cases are seldom close, so Scaled decides most of them.
  if (!range.was_left()) decision = kernel.template operator()<Expansion>();
  if (decision == Decision::undecided) decision = kernel.template operator()<Scaled>();
  if (decision != Decision::undecided || precision.highest == Level::expansion) return {decision, Level::expansion};
  ++rungs.rational;
  return {kernel.template operator()<Dyadic>(), Level::rational};
}

}  // namespace collided::engine::kernel
