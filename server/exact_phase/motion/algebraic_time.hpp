#pragma once

#include <array>
#include <vector>

#include "server/exact_phase/arithmetic/polynomial.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"

namespace collided::engine::kernel {

using TimePolynomial = Polynomial<Dyadic>;

/// One real root of a polynomial without multiple roots, held by an interval around it that contains no other. Signs of
/// other polynomials at it are exact: zero by a common divisor, else by closing in until the sign is one.
class AlgebraicTime {
 public:
  /// The root in the open interval; `before_high` is the polynomial's sign between it and high.
  AlgebraicTime(TimePolynomial polynomial, Dyadic low, Dyadic high, Sign before_high)
      : polynomial_(std::move(polynomial)), low_(std::move(low)), high_(std::move(high)), before_high_(before_high) {}
  explicit AlgebraicTime(const Dyadic& known) : low_(known), high_(known), known_(true) {}

  /// Sharpens the interval to `width`, or to neighbouring doubles.
  void narrow(double width);
  Sign sign_of(TimePolynomial other);
  /// The root is in (low, high], or it is 0 and so are both.
  TimeBracket bracket() const;

  const Dyadic& low() const { return low_; }

 private:
  void split_at(const Dyadic& t);
  bool shared_with(const TimePolynomial& divisor) const;

  TimePolynomial polynomial_;
  Dyadic low_;
  Dyadic high_;
  Sign before_high_ = Sign::zero;
  bool known_ = false;  // both ends are the root
};

/// About the root of a polynomial that changes its sign once in [low, high], to the one given. Nothing is decided here.
double guessed_root(const std::array<double, 4>& coefficient, double low, double high, Sign before_high);

/// Every root in [low, high], multiple ones once, in order. A polynomial that is zero everywhere has none here.
/// source  Descartes' rule of signs with bisection (Collins, Akritas, 1976)
std::vector<AlgebraicTime> roots_between(TimePolynomial polynomial, const Dyadic& low, const Dyadic& high);

}  // namespace collided::engine::kernel
