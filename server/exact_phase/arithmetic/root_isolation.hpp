#pragma once

#include <utility>
#include <vector>

#include "server/exact_phase/arithmetic/polynomial.hpp"

namespace collided::engine::kernel {

/// From a polynomial's Bernstein coefficients on a span: the number of roots within is at most `count`, and differs
/// from it by an even number.
struct SignChanges {
  int count = 0;
  Sign last = Sign::zero;
};
template <class AnyPolynomial>
SignChanges sign_changes(const AnyPolynomial& polynomial, const Dyadic& low, const Dyadic& high) {
  const auto span = polynomial.on_span(low, high);
  SignChanges changes;
  for (int i = 0; i < polynomial.count(); ++i) {
    const Sign s = sign(span[i]);
    if (s == Sign::zero) continue;
    if (changes.last != Sign::zero && s != changes.last) ++changes.count;
    changes.last = s;
  }
  return changes;
}

/// Splits (low, high) until each piece holds one root of a polynomial without multiple roots, and reports them in
/// order: known(t) if the root is t itself, alone(from, to, before_to) if it lies within, `before_to` being the sign
/// between it and `to`. middle(from, to) chooses the split. The ends themselves are not tested.
///
/// returns  false if out of steps: there may be more roots beyond the last one reported
/// source   Descartes' rule of signs with bisection (Collins, Akritas, 1976)
template <class AnyPolynomial, class Middle, class Known, class Alone>
bool isolate_roots(const AnyPolynomial& polynomial, const Dyadic& low, const Dyadic& high, int most_steps,
                   const Middle& middle, const Known& known, const Alone& alone) {
  // Spans still to search, the next one last; a span of no width is a point to test.
  std::vector<std::pair<Dyadic, Dyadic>> spans{{low, high}};
  for (int step = 0; step < most_steps && !spans.empty(); ++step) {
    const auto [from, to] = std::move(spans.back());
    spans.pop_back();
    if (sign(to - from) == Sign::zero) {
      if (sign(polynomial.at(from)) == Sign::zero) known(from);
      continue;
    }
    const SignChanges changes = sign_changes(polynomial, from, to);
    if (changes.count == 0) continue;
    if (changes.count == 1) {
      alone(from, to, changes.last);
      continue;
    }
    const Dyadic at = middle(from, to);
    spans.emplace_back(at, to);
    spans.emplace_back(at, at);
    spans.emplace_back(from, at);
  }
  return spans.empty();
}

}  // namespace collided::engine::kernel
