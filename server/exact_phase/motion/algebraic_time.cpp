#include "server/exact_phase/motion/algebraic_time.hpp"

#include <algorithm>
#include <limits>

#include "server/exact_phase/arithmetic/root_isolation.hpp"
#include "server/exact_phase/arithmetic/rounded_outward.hpp"
#include "server/exact_phase/arithmetic/time_between.hpp"

namespace collided::engine::kernel {
namespace {

TimePolynomial common_divisor(TimePolynomial a, TimePolynomial b) {
  while (b.count() > 0) {
    TimePolynomial rest = TimePolynomial::divided(std::move(a), b).second;
    a = std::move(b);
    b = std::move(rest);
  }
  return a;
}

/// A polynomial with the same roots, each once.
TimePolynomial without_multiple_roots(TimePolynomial polynomial) {
  if (polynomial.count() < 3) return polynomial;
  const TimePolynomial shared = common_divisor(polynomial, polynomial.derivative());
  return shared.count() < 2 ? polynomial : TimePolynomial::divided(std::move(polynomial), shared).first;
}

Dyadic middle(const Dyadic& a, const Dyadic& b) { return (a + b) * Dyadic(0.5); }

/// The coefficients in double, scaled by one common power of two.
std::array<double, 4> approximated(const TimePolynomial& polynomial) {
  long power = std::numeric_limits<long>::min();
  for (int i = 0; i < polynomial.count(); ++i) {
    if (polynomial[i].sign() != 0) power = std::max(power, polynomial[i].split().second);
  }
  std::array<double, 4> result{};
  for (int i = 0; i < polynomial.count(); ++i) {
    const auto [fraction, own] = polynomial[i].split();
    if (fraction != 0) result[i] = std::ldexp(fraction, static_cast<int>(std::max(own - power, -4000L)));
  }
  return result;
}

/// Distinct roots of polynomials of these degrees with double coefficients are much farther apart than 2^-20000.
constexpr int kMostHalvings = 20000;

}  // namespace

double guessed_root(const std::array<double, 4>& coefficient, double low, double high, Sign before_high) {
  const auto value = [&](double t) {
    return ((coefficient[3] * t + coefficient[2]) * t + coefficient[1]) * t + coefficient[0];
  };
  for (int step = 0; step < 64; ++step) {
    const double t = low + (high - low) / 2;
    if (!(t > low && t < high)) break;
    ((value(t) > 0) == (before_high == Sign::positive) ? high : low) = t;
  }
  return high;
}

void AlgebraicTime::split_at(const Dyadic& t) {
  if (known_ || sign(t - low_) != Sign::positive || sign(high_ - t) != Sign::positive) return;
  const Sign there = sign(polynomial_.at(t));
  if (there == Sign::zero) {
    low_ = high_ = t;
    known_ = true;
  } else {
    (there == before_high_ ? high_ : low_) = t;
  }
}

void AlgebraicTime::narrow(double width) {
  const auto wide = [&] {
    const double low = rounded_down(low_);
    const double high = rounded_up(high_);
    return !known_ && high - low > width && std::nextafter(low, 1.0) < high;
  };
  if (!wide()) return;
  const double guess = guessed_root(approximated(polynomial_), rounded_down(low_), rounded_up(high_), before_high_);
  double reach = std::max(width * 0.4375, kRoundoff * guess);
  for (int step = 0; step < 8 && wide(); ++step, reach *= 32) {
    split_at(guess);
    split_at(guess - reach);
    split_at(guess + reach);
  }
  for (int step = 0; step < 128 && wide(); ++step) split_at(time_between(rounded_down(low_), rounded_up(high_)));
}

bool AlgebraicTime::shared_with(const TimePolynomial& divisor) const {
  return divisor.count() > 1 && sign_changes(divisor, low_, high_).count % 2 == 1;
}

Sign AlgebraicTime::sign_of(TimePolynomial other) {
  other.trim();
  if (other.count() == 0) return Sign::zero;
  if (known_) return sign(other.at(high_));
  Sign s = other.sign_on(low_, high_);
  if (s != Sign::unsure) return s;
  if (shared_with(common_divisor(polynomial_, other))) return Sign::zero;
  for (int step = 0; step < kMostHalvings && s == Sign::unsure; ++step) {
    split_at(middle(low_, high_));
    s = known_ ? sign(other.at(high_)) : other.sign_on(low_, high_);
  }
  return s;
}

TimeBracket AlgebraicTime::bracket() const {
  const double high = rounded_up(high_);
  const double low = rounded_down(low_);
  return {low < high || high == 0 ? low : std::nextafter(high, 0.0), high};
}

std::vector<AlgebraicTime> roots_between(TimePolynomial polynomial, const Dyadic& low, const Dyadic& high) {
  std::vector<AlgebraicTime> roots;
  polynomial.trim();
  if (polynomial.count() < 2) return roots;
  polynomial = without_multiple_roots(std::move(polynomial));
  if (sign(polynomial.at(low)) == Sign::zero) roots.emplace_back(low);
  isolate_roots(
      polynomial, low, high, kMostHalvings, middle, [&](const Dyadic& at) { roots.emplace_back(at); },
      [&](const Dyadic& from, const Dyadic& to, Sign before_to) {
        roots.emplace_back(polynomial, from, to, before_to);
      });
  if (sign(polynomial.at(high)) == Sign::zero) roots.emplace_back(high);
  return roots;
}

}  // namespace collided::engine::kernel
