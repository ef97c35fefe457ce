#include "server/exact_phase/arithmetic/real_root.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/root_isolation.hpp"
#include "server/exact_phase/arithmetic/rounded_outward.hpp"
#include "server/exact_phase/arithmetic/time_between.hpp"

namespace collided::engine::kernel {
namespace {

Dyadic two_to(long power) { return Dyadic(mpz_class(1), power); }

/// The exponent e with |x| < 2^e <= 2 |x|.
long power_above(const Dyadic& x) { return x.split().second; }

/// Strictly between, for 0 <= low < high: the middle if the two are close, by exponent if they are far apart.
Dyadic between(const Dyadic& low, const Dyadic& high) {
  const long above_low = power_above(low);
  const long above_high = power_above(high);
  if (low.sign() == 0 || above_high - above_low < 3) return (low + high) * Dyadic(0.5);
  return two_to(above_low + (above_high - above_low) / 2);
}

/// n / d rounded up, for d > 0.
long ceiling(long n, long d) { return n > 0 ? (n + d - 1) / d : -(-n / d); }

/// Powers of two strictly below and above all positive roots. Fujiwara's bound: 2 max |c_k / c_n|^(1 / (n - k)),
/// applied also to the reversed polynomial; c_0 and c_n must not be zero.
std::pair<long, long> powers_around_roots(const ExactRayPolynomial& p) {
  const int n = p.count() - 1;
  long high = std::numeric_limits<long>::min();
  long low = std::numeric_limits<long>::min();
  // |a / b| < 2^(power_above(a) - power_above(b) + 1)
  for (int k = 0; k < n; ++k) {
    if (p[k].sign() != 0) high = std::max(high, ceiling(power_above(p[k]) - power_above(p[n]) + 1, n - k));
  }
  for (int k = 1; k <= n; ++k) {
    if (p[k].sign() != 0) low = std::max(low, ceiling(power_above(p[k]) - power_above(p[0]) + 1, k));
  }
  return {-(low + 1) - 1, high + 1 + 1};
}

/// The coefficients in double, scaled by one common power of two.
std::array<double, ExactRayPolynomial::kCoefficients> approximated(const ExactRayPolynomial& polynomial) {
  long power = std::numeric_limits<long>::min();
  for (int i = 0; i < polynomial.count(); ++i) {
    if (polynomial[i].sign() != 0) power = std::max(power, power_above(polynomial[i]));
  }
  std::array<double, ExactRayPolynomial::kCoefficients> result{};
  for (int i = 0; i < polynomial.count(); ++i) {
    const auto [fraction, own] = polynomial[i].split();
    if (fraction != 0) result[i] = std::ldexp(fraction, static_cast<int>(std::max(own - power, -4000L)));
  }
  return result;
}

/// Steps of one search. Roots of polynomials with coefficients near 1 are separated within some thousand; coefficients
/// with exponents hundreds apart may exhaust it, and give undecided.
constexpr int kMostHalvings = 20'000;

}  // namespace

void RealRoot::split_at(const Dyadic& t) {
  if (known_ || sign(t - low_) != Sign::positive || sign(high_ - t) != Sign::positive) return;
  const Sign there = sign(polynomial_.at(t));
  if (there == Sign::zero) {
    low_ = high_ = t;
    known_ = true;
  } else {
    (there == before_high_ ? high_ : low_) = t;
  }
}

void RealRoot::halve() {
  if (!known_) split_at(between(low_, high_));
}

// Brackets the root in double arithmetic, then splits exactly beside that guess: a few exact steps instead of many.
void RealRoot::split_beside_guess() {
  const auto coefficient = approximated(polynomial_);
  const auto value = [&](double t) {
    double sum = 0;
    for (int i = polynomial_.count() - 1; i >= 0; --i) sum = sum * t + coefficient[i];
    return sum;
  };
  double low = rounded_down(low_);
  double high = std::min(rounded_up(high_), std::numeric_limits<double>::max());
  for (int step = 0; step < 128; ++step) {
    const double t = time_between(low, high);
    if (!(t > low && t < high)) break;
    ((value(t) > 0) == (before_high_ == Sign::positive) ? high : low) = t;
  }
  // Roots that are doubles, such as whole numbers, are hit exactly.
  split_at(Dyadic(high));
  split_at(Dyadic(low));
  double reach = kRoundoff * high;
  for (int step = 0; step < 4; ++step, reach *= 32) {
    split_at(Dyadic(high - reach));
    split_at(Dyadic(high + reach));
  }
}

void RealRoot::narrow(double relative_width) {
  const auto wide = [&] {
    const auto [low, high] = bracket();
    const double next = std::nextafter(low, std::numeric_limits<double>::infinity());
    // Written so that an infinite end counts as wide, unless its neighbour is the other end.
    return !known_ && next < high && !(high - low <= relative_width * high && std::isfinite(high));
  };
  if (wide()) split_beside_guess();
  for (int step = 0; step < kMostHalvings && wide(); ++step) {
    const auto [low, high] = bracket();
    const bool beyond = !std::isfinite(high);
    beyond ? halve() : split_at(Dyadic(time_between(low, high)));
  }
}

std::pair<double, double> RealRoot::bracket() const { return {rounded_down(low_), rounded_up(high_)}; }

Sign RealRoot::sign_of(const ExactRayPolynomial& other) {
  if (other.count() == 0) return Sign::zero;
  if (known_) return sign(other.at(high_));
  Sign s = other.sign_on(low_, high_);
  if (s != Sign::unsure) return s;
  const ExactRayPolynomial shared = common_divisor(polynomial_, other);
  // The interval holds one root of this polynomial, so at most one of a divisor.
  if (shared.count() > 1 && sign_changes(shared, low_, high_).count % 2 == 1) return Sign::zero;
  for (int step = 0; step < kMostHalvings && s == Sign::unsure; ++step) {
    halve();
    s = known_ ? sign(other.at(high_)) : other.sign_on(low_, high_);
  }
  return s;
}

RealRoots roots_from_zero(const ExactRayPolynomial& polynomial) {
  RealRoots result;
  std::vector<RealRoot>& roots = result.roots;
  ExactRayPolynomial simple = square_free(polynomial);
  if (simple.count() > 0 && simple[0].sign() == 0) {
    roots.emplace_back(Dyadic());
    simple = simple.without_root_at_zero();
  }
  if (simple.count() < 2) return result;
  const auto [low, high] = powers_around_roots(simple);
  result.complete = isolate_roots(
      simple, two_to(low), two_to(high), kMostHalvings, between, [&](const Dyadic& at) { roots.emplace_back(at); },
      [&](const Dyadic& from, const Dyadic& to, Sign before_to) { roots.emplace_back(simple, from, to, before_to); });
  return result;
}

}  // namespace collided::engine::kernel
