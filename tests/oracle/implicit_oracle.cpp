#include "tests/oracle/implicit_oracle.hpp"

#include <cmath>

namespace collided::oracle {
using namespace engine;
namespace {

using Univariate = std::vector<Rational>;

void trim(Univariate& p) {
  while (!p.empty() && p.back() == 0) p.pop_back();
}

Univariate product(const Univariate& a, const Univariate& b) {
  if (a.empty() || b.empty()) return {};
  Univariate result(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
  }
  return result;
}

Univariate derivative(const Univariate& p) {
  Univariate result;
  for (std::size_t i = 1; i < p.size(); ++i) result.push_back(p[i] * static_cast<int>(i));
  return result;
}

/// a modulo b; a becomes the rest, what comes back is the quotient.
Univariate divided(Univariate& a, const Univariate& b) {
  Univariate quotient(a.size() < b.size() ? 0 : a.size() - b.size() + 1);
  while (a.size() >= b.size() && !a.empty()) {
    const std::size_t shift = a.size() - b.size();
    const Rational factor = a.back() / b.back();
    quotient[shift] = factor;
    for (std::size_t i = 0; i < b.size(); ++i) a[i + shift] -= factor * b[i];
    a.pop_back();
    trim(a);
  }
  return quotient;
}

/// Divided by the size of its highest coefficient, which keeps every sign.
void make_monic(Univariate& p) {
  const Rational size = abs(p.back());
  for (Rational& c : p) c /= size;
}

}  // namespace

Trivariate Trivariate::variable(int axis) {
  Trivariate result;
  std::array<int, 3> exponents{};
  exponents[axis] = 1;
  result.add(exponents, 1);
  return result;
}

void Trivariate::add(const std::array<int, 3>& exponents, const Rational& coefficient) {
  Rational& sum = terms_[exponents];
  sum += coefficient;
  if (sum == 0) terms_.erase(exponents);
}

Trivariate operator+(const Trivariate& a, const Trivariate& b) {
  Trivariate sum = a;
  for (const auto& [exponents, coefficient] : b.terms_) sum.add(exponents, coefficient);
  return sum;
}

Trivariate operator-(const Trivariate& a, const Trivariate& b) { return a + b * Trivariate(-1); }

Trivariate operator*(const Trivariate& a, const Trivariate& b) {
  Trivariate result;
  for (const auto& [e, c] : a.terms_) {
    for (const auto& [g, d] : b.terms_) result.add({e[0] + g[0], e[1] + g[1], e[2] + g[2]}, c * d);
  }
  return result;
}

Rational Trivariate::at(const Point& point) const {
  Rational sum = 0;
  for (const auto& [exponents, coefficient] : terms_) {
    Rational term = coefficient;
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < exponents[axis]; ++i) term *= point[axis];
    }
    sum += term;
  }
  return sum;
}

Trivariate Trivariate::derivative(int axis) const {
  Trivariate result;
  for (const auto& [exponents, coefficient] : terms_) {
    if (exponents[axis] == 0) continue;
    std::array<int, 3> lower = exponents;
    --lower[axis];
    result.add(lower, coefficient * exponents[axis]);
  }
  return result;
}

std::vector<Rational> Trivariate::along(const Ray& ray) const {
  Univariate sum;
  for (const auto& [exponents, coefficient] : terms_) {
    Univariate term{coefficient};
    for (int axis = 0; axis < 3; ++axis) {
      const Univariate line{Rational(ray.origin[axis]), Rational(ray.direction[axis])};
      for (int i = 0; i < exponents[axis]; ++i) term = product(term, line);
    }
    if (sum.size() < term.size()) sum.resize(term.size());
    for (std::size_t i = 0; i < term.size(); ++i) sum[i] += term[i];
  }
  trim(sum);
  return sum;
}

Rational value_at(const std::vector<Rational>& polynomial, const Rational& t) {
  Rational value = 0;
  for (std::size_t i = polynomial.size(); i-- > 0;) value = value * t + polynomial[i];
  return value;
}

RootCount::RootCount(std::vector<Rational> polynomial) {
  trim(polynomial);
  // Euclid's last rest is the greatest common divisor with the derivative: without it, every root is simple.
  Univariate a = polynomial;
  Univariate b = derivative(polynomial);
  while (!b.empty()) {
    divided(a, b);
    std::swap(a, b);
    if (!b.empty()) make_monic(b);
  }
  Univariate simple = a.size() > 1 ? divided(polynomial, a) : polynomial;
  chain_ = {simple, derivative(simple)};
  while (!chain_.back().empty()) {
    Univariate rest = chain_[chain_.size() - 2];
    divided(rest, chain_.back());
    for (Rational& c : rest) c = -c;
    if (!rest.empty()) make_monic(rest);
    chain_.push_back(std::move(rest));
  }
  chain_.pop_back();
}

int RootCount::changes(const Rational& t) const {
  int count = 0;
  int last = 0;
  for (const Univariate& p : chain_) {
    const Rational value = value_at(p, t);
    const int s = value > 0 ? 1 : value < 0 ? -1 : 0;
    if (s != 0 && last != 0 && s != last) ++count;
    if (s != 0) last = s;
  }
  return count;
}

bool RootCount::is_root(const Rational& t) const { return value_at(chain_.front(), t) == 0; }

int RootCount::within(const Rational& low, const Rational& high) const {
  return changes(low) - changes(high) + (is_root(low) ? 1 : 0);
}

int RootCount::before(const Rational& low, const Rational& high) const {
  return within(low, high) - (is_root(high) ? 1 : 0);
}

std::optional<Stay> stay_in_box(const Ray& ray, const Vec3& low, const Vec3& high) {
  Stay stay;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis];
    const double d = ray.direction[axis];
    if (d == 0 && (o < low[axis] || o > high[axis])) return std::nullopt;
    if (d == 0) continue;
    const double entered = d > 0 ? low[axis] : high[axis];
    const double left = d > 0 ? high[axis] : low[axis];
    if (std::isfinite(entered))
      stay.first = std::max(stay.first, Rational((Rational(entered) - Rational(o)) / Rational(d)));
    if (!std::isfinite(left)) continue;
    const Rational last = (Rational(left) - Rational(o)) / Rational(d);
    stay.last = stay.last ? std::min(*stay.last, last) : last;
  }
  if (stay.last && *stay.last < stay.first) return std::nullopt;
  return stay;
}

}  // namespace collided::oracle
