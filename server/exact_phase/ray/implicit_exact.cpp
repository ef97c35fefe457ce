#include "server/exact_phase/ray/implicit_exact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "server/exact_phase/arithmetic/implicit_kernel.hpp"
#include "server/exact_phase/arithmetic/real_root.hpp"
#include "server/exact_phase/ray/implicit_hit.hpp"

namespace collided::engine::kernel {
namespace {

ExactRayPolynomial linear(const Dyadic& at_zero, const Dyadic& slope) {
  ExactRayPolynomial result(at_zero, slope);
  result.trim();
  return result;
}

/// Polynomials that are >= 0 where a hit may be, for parameters >= 0: the box's side of each of its planes, and
/// length^2 - |direction|^2 t^2. Linear ones come first.
std::vector<ExactRayPolynomial> limits_of(const Ray& ray, const ImplicitSurface& surface) {
  std::vector<ExactRayPolynomial> limits;
  for (int axis = 0; axis < 3; ++axis) {
    const Dyadic o(ray.origin[axis]);
    const Dyadic d(ray.direction[axis]);
    if (std::isfinite(surface.low[axis])) limits.push_back(linear(o - Dyadic(surface.low[axis]), d));
    if (std::isfinite(surface.high[axis])) limits.push_back(linear(Dyadic(surface.high[axis]) - o, -d));
  }
  if (std::isfinite(ray.length_m)) {
    const Dyadic length(ray.length_m);
    ExactRayPolynomial::Coefficients coefficient;
    coefficient[0] = length * length;
    coefficient[2] = -square(Vector<Dyadic>(ray.direction));
    limits.emplace_back(std::move(coefficient), 3);
  }
  return limits;
}

Decision is_within(RealRoot& root, const std::vector<ExactRayPolynomial>& limits) {
  AllOf all;
  for (const ExactRayPolynomial& limit : limits) {
    const Sign s = root.sign_of(limit);
    all.add(s == Sign::unsure ? Decision::undecided : s == Sign::negative ? Decision::no : Decision::yes);
  }
  return all.result();
}

/// The point at which a ray within the surface enters the box: its start, or the one plane that it crosses inward
/// inside all others.
Decision first_within(const std::vector<ExactRayPolynomial>& limits, std::vector<RealRoot>& entry) {
  entry.emplace_back(Dyadic());
  Decision within = is_within(entry.back(), limits);
  for (std::size_t i = 0; i < limits.size() && within == Decision::no; ++i) {
    if (limits[i].count() != 2 || limits[i][1].sign() <= 0 || limits[i][0].sign() >= 0) continue;
    RealRoots roots = roots_from_zero(limits[i]);
    entry.back() = std::move(roots.roots.front());
    within = is_within(entry.back(), limits);
  }
  return within;
}

/// Contains all values of a polynomial between the ends of the root's interval: the range of its Bernstein coefficients
/// there, times a constant.
struct Enclosure {
  Dyadic middle;
  Dyadic radius;
};

Enclosure enclosed(const ExactRayPolynomial& p, const RealRoot& root) {
  // A common multiple of the binomials in the coefficients, up to degree 8.
  constexpr double kMultiple = 840;
  constexpr auto kBinomial = binomials<ExactRayPolynomial::kCoefficients>();
  if (p.count() == 0) return {};
  const auto span = p.on_span(root.low(), root.high());
  Dyadic least;
  Dyadic most;
  for (int j = 0; j < p.count(); ++j) {
    const Dyadic value = span[j] * Dyadic(kMultiple / kBinomial[p.count() - 1][j]);
    if (j == 0 || sign(value - most) == Sign::positive) most = value;
    if (j == 0 || sign(value - least) == Sign::negative) least = value;
  }
  return {(least + most) * Dyadic(0.5), (most - least) * Dyadic(0.5)};
}

/// Scales the three by one power of two, so that the largest is near 1.
Vector<Bounded> scaled_alike(const std::array<Enclosure, 3>& e) {
  long power = std::numeric_limits<long>::min();
  for (const Enclosure& component : e) {
    if (component.middle.sign() != 0) power = std::max(power, component.middle.split().second);
    if (component.radius.sign() != 0) power = std::max(power, component.radius.split().second);
  }
  const auto down = [&](const Dyadic& x) {
    const auto [fraction, own] = x.split();
    return fraction == 0 ? 0.0 : std::ldexp(fraction, static_cast<int>(std::max(own - power, -4000L)));
  };
  std::array<Bounded, 3> result;
  for (int axis = 0; axis < 3; ++axis) {
    const double middle = down(e[axis].middle);
    const bool exact =
        e[axis].radius.sign() == 0 && (middle == 0 ? e[axis].middle.sign() == 0 : e[axis].middle.short_mantissa());
    const double rounding = 4 * kRoundoff * std::abs(middle) + kUnderflow;
    result[axis] = exact ? Bounded(middle) : Bounded(middle, down(e[axis].radius) * (1 + kBoundSlack) + rounding);
  }
  return {result[0], result[1], result[2]};
}

/// Narrows the root until the gradient's direction is known well enough, or proves it to be zero.
void find_normal(const Ray& ray, const ImplicitSurface& surface, RealRoot& root, ImplicitHit& hit) {
  using P = ExactRayPolynomial;
  constexpr double kSharp = 0x1p-40;
  constexpr int kMostRounds = 64;
  const Vector<Dyadic> o(ray.origin);
  const Vector<Dyadic> d(ray.direction);
  std::array<P, 3> slope = gradient(surface, P(o.x, d.x), P(o.y, d.y), P(o.z, d.z));
  bool singular = true;
  for (P& component : slope) {
    component.trim();
    singular = singular && root.sign_of(component) == Sign::zero;
  }
  if (singular) {
    hit.normal_state = ImplicitHit::Normal::singular;
    hit.normal_error = std::numeric_limits<double>::infinity();
    return;
  }
  for (int round = 0; round < kMostRounds; ++round) {
    const double error =
        set_normal(scaled_alike({enclosed(slope[0], root), enclosed(slope[1], root), enclosed(slope[2], root)}), hit);
    if (error <= kSharp) return;
    for (int i = 0; i < 16; ++i) root.halve();
  }
}

}  // namespace

Decision first_meeting_exactly(const Ray& ray, const ImplicitSurface& surface, double relative_width,
                               ImplicitHit& hit) {
  ExactRayPolynomial f = along(surface, Vector<Dyadic>(ray.origin), Vector<Dyadic>(ray.direction));
  f.trim();
  const std::vector<ExactRayPolynomial> limits = limits_of(ray, surface);
  const bool runs_along = f.count() == 0;
  RealRoots found;
  Decision within = Decision::no;
  std::size_t first = 0;
  if (runs_along) {
    within = first_within(limits, found.roots);
  } else {
    found = roots_from_zero(f);
    for (; first < found.roots.size(); ++first) {
      within = is_within(found.roots[first], limits);
      if (within != Decision::no) break;
    }
    if (within == Decision::no && !found.complete) within = Decision::undecided;
  }
  if (within != Decision::yes) return within;
  RealRoot& root = found.roots[first];
  root.narrow(relative_width);
  const auto [low, high] = root.bracket();
  set_place(ray, low, high, hit);
  hit.runs_along = runs_along;
  find_normal(ray, surface, root, hit);
  return Decision::yes;
}

}  // namespace collided::engine::kernel
