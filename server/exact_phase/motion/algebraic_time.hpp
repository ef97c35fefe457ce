#pragma once

#include <array>
#include <vector>

#include "server/exact_phase/arithmetic/polynomial.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"

namespace collided::engine::kernel {

using TimePolynomial = Polynomial<Dyadic>;

/// One real root of a polynomial without multiple roots, held by an interval around it that contains no other root.
/// Signs of other polynomials at it are exact: zero is proved by a common divisor, other signs by narrowing until one
/// sign is left.
class AlgebraicTime {
 public:
  /// The root in the open interval; `before_high` is the polynomial's sign between it and high.
  AlgebraicTime(TimePolynomial polynomial, Dyadic low, Dyadic high, Sign before_high)
      : polynomial_(std::move(polynomial)), low_(std::move(low)), high_(std::move(high)), before_high_(before_high) {}
  explicit AlgebraicTime(const Dyadic& known) : low_(known), high_(known), known_(true) {}

  /// Narrows the interval to `width`, or to neighbouring doubles.
  void narrow(double width);
  /// The sign of another polynomial at the root; unsure if out of steps.
  Sign sign_of(TimePolynomial other);
  /// A bracket of doubles: the root is in (low, high], or both and the root are 0.
  TimeBracket bracket() const;

  const Dyadic& low() const { return low_; }

 private:
  void split_at(const Dyadic& t);
  bool shared_with(const TimePolynomial& divisor) const;

  TimePolynomial polynomial_;
  Dyadic low_;
  Dyadic high_;
  Sign before_high_ = Sign::zero;
  bool known_ = false;  // low_ and high_ are both the root
};

/// An approximation of the root of a polynomial that changes sign once in [low, high], ending with before_high. No
/// decision depends on it.
double guessed_root(const std::array<double, 4>& coefficient, double low, double high, Sign before_high);

/// Every root in [low, high], multiple ones once, ascending. The zero polynomial gives none.
/// source  Descartes' rule of signs with bisection (Collins, Akritas, 1976)
std::vector<AlgebraicTime> roots_between(TimePolynomial polynomial, const Dyadic& low, const Dyadic& high);

}  // namespace collided::engine::kernel
