#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "server/geometry/ray.hpp"
#include "tests/oracle/exact_oracle.hpp"

namespace collided::oracle {
using namespace engine;

// The slow and sure twin of implicit surfaces: polynomials expanded into monomials over rationals, put along a ray by the
// binomial theorem, their roots counted by Sturm's theorem. No interval, no Bernstein form, nothing of the product.

/// A polynomial in x, y, z: its coefficients by exponents.
class Trivariate {
 public:
  Trivariate() = default;
  Trivariate(const Rational& constant) { add({0, 0, 0}, constant); }  // NOLINT: a number is a polynomial
  Trivariate(double constant) : Trivariate(Rational(constant)) {}     // NOLINT
  Trivariate(int constant) : Trivariate(Rational(constant)) {}        // NOLINT
  static Trivariate variable(int axis);

  void add(const std::array<int, 3>& exponents, const Rational& coefficient);
  const std::map<std::array<int, 3>, Rational>& terms() const { return terms_; }

  friend Trivariate operator+(const Trivariate& a, const Trivariate& b);
  friend Trivariate operator-(const Trivariate& a, const Trivariate& b);
  friend Trivariate operator*(const Trivariate& a, const Trivariate& b);

  Rational at(const Point& point) const;
  Trivariate derivative(int axis) const;
  /// In the ray's parameter, the constant first; no zeros at the end.
  std::vector<Rational> along(const Ray& ray) const;

 private:
  std::map<std::array<int, 3>, Rational> terms_;
};

/// Distinct roots of a univariate polynomial that is not zero, by Sturm's theorem.
class RootCount {
 public:
  explicit RootCount(std::vector<Rational> polynomial);
  /// In the closed interval, low <= high.
  int within(const Rational& low, const Rational& high) const;
  /// In [low, high).
  int before(const Rational& low, const Rational& high) const;
  bool is_root(const Rational& t) const;

 private:
  int changes(const Rational& t) const;
  std::vector<std::vector<Rational>> chain_;
};

Rational value_at(const std::vector<Rational>& polynomial, const Rational& t);

/// Parameters at which a ray is in a box, the length not applied; nothing where it never is. The end may be missing.
struct Stay {
  Rational first = 0;
  std::optional<Rational> last;
};
std::optional<Stay> stay_in_box(const Ray& ray, const Vec3& low, const Vec3& high);

}  // namespace collided::oracle
