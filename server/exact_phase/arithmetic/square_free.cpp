#include "server/exact_phase/arithmetic/square_free.hpp"

#include <algorithm>
#include <limits>
#include <vector>

namespace collided::engine::kernel {
namespace {

/// Whole coefficients, the constant first; the highest is not zero. Empty: the zero polynomial.
using Whole = std::vector<mpz_class>;

void trim(Whole& p) {
  while (!p.empty() && sgn(p.back()) == 0) p.pop_back();
}

/// Divides by the greatest common divisor of the coefficients.
void take_content_out(Whole& p) {
  trim(p);
  mpz_class content = 0;
  for (const mpz_class& c : p) content = gcd(content, c);
  if (content <= 1) return;
  for (mpz_class& c : p) mpz_divexact(c.get_mpz_t(), c.get_mpz_t(), content.get_mpz_t());
}

/// The polynomial times a constant that makes its coefficients whole and as small as possible.
Whole whole(const ExactRayPolynomial& polynomial) {
  long lowest = std::numeric_limits<long>::max();
  for (int i = 0; i < polynomial.count(); ++i) {
    if (polynomial[i].sign() != 0) lowest = std::min(lowest, polynomial[i].exponent());
  }
  Whole result(static_cast<std::size_t>(polynomial.count()));
  for (int i = 0; i < polynomial.count(); ++i) {
    if (polynomial[i].sign() != 0)
      result[static_cast<std::size_t>(i)] = polynomial[i].mantissa()
                                            << static_cast<mp_bitcnt_t>(polynomial[i].exponent() - lowest);
  }
  take_content_out(result);
  return result;
}

ExactRayPolynomial with_exponents(const Whole& p) {
  ExactRayPolynomial::Coefficients coefficient;
  for (std::size_t i = 0; i < p.size(); ++i) coefficient[i] = Dyadic(p[i], 0);
  return ExactRayPolynomial(std::move(coefficient), static_cast<int>(p.size()));
}

/// Replaces a by its remainder modulo b, up to a constant factor; the quotient, unless null, gets the same factor.
void divide(Whole& a, const Whole& b, Whole* quotient) {
  while (a.size() >= b.size()) {
    const std::size_t shift = a.size() - b.size();
    const mpz_class lead = a.back();
    for (mpz_class& c : a) c *= b.back();
    if (quotient != nullptr) {
      for (mpz_class& c : *quotient) c *= b.back();
      if (quotient->empty()) quotient->resize(shift + 1);
      (*quotient)[shift] += lead;
    }
    for (std::size_t i = 0; i < b.size(); ++i) a[i + shift] -= lead * b[i];
    trim(a);
  }
}

Whole common_divisor(Whole a, Whole b) {
  while (!b.empty()) {
    divide(a, b, nullptr);
    take_content_out(a);
    std::swap(a, b);
  }
  return a;
}

}  // namespace

ExactRayPolynomial common_divisor(const ExactRayPolynomial& a, const ExactRayPolynomial& b) {
  return with_exponents(common_divisor(whole(a), whole(b)));
}

ExactRayPolynomial square_free(const ExactRayPolynomial& polynomial) {
  if (polynomial.count() < 3) return polynomial;
  Whole rest = whole(polynomial);
  Whole slope(rest.size() - 1);
  for (std::size_t i = 1; i < rest.size(); ++i) slope[i - 1] = rest[i] * static_cast<unsigned long>(i);
  const Whole shared = common_divisor(rest, slope);
  if (shared.size() < 2) return polynomial;
  Whole quotient;
  divide(rest, shared, &quotient);
  take_content_out(quotient);
  return with_exponents(quotient);
}

}  // namespace collided::engine::kernel
