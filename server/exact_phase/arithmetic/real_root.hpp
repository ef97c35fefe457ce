#pragma once

#include <utility>
#include <vector>

#include "server/exact_phase/arithmetic/square_free.hpp"

namespace collided::engine::kernel {

/// One root >= 0 of a polynomial without multiple roots, held by an interval around it that contains no other root. The
/// counterpart of AlgebraicTime, whose times end at 1, for the unbounded parameter of a ray and up to degree 8.
class RealRoot {
 public:
  /// The root in the open interval; `before_high` is the polynomial's sign between the root and high.
  RealRoot(ExactRayPolynomial polynomial, Dyadic low, Dyadic high, Sign before_high)
      : polynomial_(std::move(polynomial)), low_(std::move(low)), high_(std::move(high)), before_high_(before_high) {}
  /// A root that is known exactly.
  explicit RealRoot(const Dyadic& known) : low_(known), high_(known), known_(true) {}

  /// The sign of another polynomial at the root. Exact: zero is proved by a common divisor, other signs by narrowing
  /// until one sign is left; unsure if out of steps. `other` must be trimmed.
  Sign sign_of(const ExactRayPolynomial& other);

  /// Narrows until the doubles around the root are no farther apart than this share of the upper one, or are
  /// neighbours.
  void narrow(double relative_width);
  /// Narrows by one step.
  void halve();

  /// The doubles around the root; equal if the root is a double. The upper may be infinite.
  std::pair<double, double> bracket() const;
  const Dyadic& low() const { return low_; }
  const Dyadic& high() const { return high_; }

 private:
  void split_at(const Dyadic& t);
  void split_beside_guess();

  ExactRayPolynomial polynomial_;
  Dyadic low_;
  Dyadic high_;
  Sign before_high_ = Sign::zero;
  bool known_ = false;  // both ends are the root
};                      // low_ and high_ are both the root

/// The roots found, and whether they are all.
struct RealRoots {
  std::vector<RealRoot> roots;  // ascending
  bool complete = true;         // false: the search ran out of steps, and there may be more beyond the last one
};

/// Every root >= 0, multiple ones once. The polynomial must be trimmed and not zero.
/// source  Descartes' rule of signs with bisection (Collins, Akritas, 1976)
RealRoots roots_from_zero(const ExactRayPolynomial& polynomial);

}  // namespace collided::engine::kernel
