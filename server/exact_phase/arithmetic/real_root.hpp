#pragma once

#include <utility>
#include <vector>

#include "server/exact_phase/arithmetic/square_free.hpp"

namespace collided::engine::kernel {

/// One root >= 0 of a polynomial without multiple roots, held by an interval around it that contains no other. What
/// AlgebraicTime is for time in [0, 1], for the parameter of a ray, which has no end, and to degree 8.
class RealRoot {
 public:
  /// The root in the open interval; `before_high` is the polynomial's sign between it and high.
  RealRoot(ExactRayPolynomial polynomial, Dyadic low, Dyadic high, Sign before_high)
      : polynomial_(std::move(polynomial)), low_(std::move(low)), high_(std::move(high)), before_high_(before_high) {}
  explicit RealRoot(const Dyadic& known) : low_(known), high_(known), known_(true) {}

  /// Exact; zero by a common divisor, else by closing in until the sign is one; unsure when out of steps. The other one is
  /// trimmed.
  Sign sign_of(const ExactRayPolynomial& other);

  /// Until the doubles around it are no farther apart than this share of the upper one, or neighbours.
  void narrow(double relative_width);
  void halve();

  /// The doubles around it; equal where it is one. The upper may be infinite.
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
};

struct RealRoots {
  std::vector<RealRoot> roots;  // in order
  bool complete = true;         // else there may be more behind the last one: out of steps
};

/// Every root >= 0, multiple ones once. Trimmed and not zero.
/// source  Descartes' rule of signs with bisection (Collins, Akritas, 1976)
RealRoots roots_from_zero(const ExactRayPolynomial& polynomial);

}  // namespace collided::engine::kernel
