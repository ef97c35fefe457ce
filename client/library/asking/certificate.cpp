#include "collided/certificate.hpp"

#include <stdexcept>

#include "client/library/asking/exact_sum.hpp"

// Checks a certificate in sixty lines that share no code with the server. Only this file and exact_sum.hpp need to be
// trusted.
namespace collided {
namespace {

using namespace client;
using Kind = CertifiedPart::Summand;

/// True if n . (x - p) <= 0 (strictly: < 0) for every x of the part. For each of its points this means r + sqrt(q / d)
/// <= 0, where r is the point's value and sqrt(q / d) is the most that the summand adds.
bool lies_behind(const CertifiedPart& s, const ExactVector& n, const ExactVector& p, bool strictly) {
  const bool is_disc = s.summand == Kind::disc;
  const ExactVector axis = is_disc ? exact(s.points.at(1)) - exact(s.points.at(0)) : exact(s.axes[0]);
  if (s.points.empty() || zero(n) || (is_disc && (zero(axis) || s.points.size() > 2))) return false;
  if (s.summand == Kind::half_space && !(zero(cross(n, axis)) && dot(n, axis).above_zero())) return false;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    ExactSum r = dot(n, exact(s.points[i]) - p), q = 0, d = is_disc ? square(axis) : 1;
    for (int k = 0; k < 3 && (s.summand == Kind::box || s.summand == Kind::ellipsoid); ++k) {
      const ExactSum reach = s.half_m[k] * dot(n, exact(s.axes[k]));
      if (s.summand == Kind::box) r = reach.below_zero() ? r - reach : r + reach;
      else q = q + reach * reach;
    }
    if (s.summand == Kind::ball || (is_disc && (i == 1 || !s.tapers)))
      q = square(s.radius_m * (is_disc ? cross(n, axis) : n));
    const ExactSum rest = q - r * r * d;
    if (!(strictly ? r.below_zero() && rest.below_zero() : r.at_most_zero() && rest.at_most_zero())) return false;
  }
  return true;
}

/// True if the point x / w is in the part: its difference from a mixture of the part's points is in the summand.
bool holds(const CertifiedPart& s, const ExactVector& x, const ExactSum& w, const Certificate::Mix& mix) {
  if (s.summand == Kind::half_space)
    return w.above_zero() && dot(exact(s.axes[0]), x - w * exact(s.points.at(0))).at_most_zero();
  ExactSum total, of_discs, squares;
  ExactVector sum;
  for (const auto& [i, terms] : mix) {
    const ExactSum weight(terms);
    if (!weight.at_least_zero()) return false;
    total = total + weight;
    if (i > 0 || !s.tapers) of_discs = of_discs + weight;
    sum = sum + weight * exact(s.points.at(i));
  }
  if (!total.above_zero() || !w.above_zero()) return false;
  const ExactVector v = total * x - w * sum;  // total * w times the vector from the mixture to the point
  const auto within = [](const ExactSum& square_of, const ExactSum& root) {
    return (square_of - root * root).at_most_zero();
  };
  if (s.summand == Kind::nothing || s.summand == Kind::ball)
    return within(square(v), (s.summand == Kind::ball ? s.radius_m : 0) * total * w);
  if (s.summand == Kind::disc)
    return s.points.size() == 2 && dot(v, exact(s.points[1]) - exact(s.points[0])).zero() &&
           within(square(v), s.radius_m * of_discs * w);
  const ExactVector axes[3] = {exact(s.axes[0]), exact(s.axes[1]), exact(s.axes[2])};
  const ExactSum volume = dot(axes[0], cross(axes[1], axes[2])) * total * w;
  for (int k = 0; k < 3; ++k) {
    const ExactSum along = dot(v, cross(axes[(k + 1) % 3], axes[(k + 2) % 3]));
    if (s.summand == Kind::box && !within(along * along, s.half_m[k] * volume)) return false;
    squares = squares + square(s.half_m[(k + 1) % 3] * ExactVector{s.half_m[(k + 2) % 3] * along});
  }
  return (volume.above_zero() || volume.below_zero()) &&
         (s.summand == Kind::box || within(squares, s.half_m[0] * volume * s.half_m[1] * s.half_m[2]));
}

/// True if the steps from number `at` on prove that the parts a0 to a1 are apart from b0 to b1 (ends excluded).
/// Advances `at` past these steps.
bool apart(const Certificate& c, std::size_t a0, std::size_t a1, std::size_t b0, std::size_t b1, std::size_t& at) {
  const Certificate::Step& step = c.steps.at(at++);
  if (step.kind == Certificate::Step::Kind::split_a)
    return a0 < step.at && step.at < a1 && apart(c, a0, step.at, b0, b1, at) && apart(c, step.at, a1, b0, b1, at);
  if (step.kind == Certificate::Step::Kind::split_b)
    return b0 < step.at && step.at < b1 && apart(c, a0, a1, b0, step.at, at) && apart(c, a0, a1, step.at, b1, at);
  const ExactVector n = exact(step.normal), p = exact(step.point);
  while (a0 < a1 && lies_behind(c.a[a0], n, p, false)) ++a0;
  while (b0 < b1 && lies_behind(c.b[b0], -n, p, true)) ++b0;
  return a0 == a1 && b0 == b1;
}

}  // namespace

bool proves(const Certificate& c) try {
  std::size_t at = 0;
  if (!c.touches) return !c.a.empty() && !c.b.empty() && apart(c, 0, c.a.size(), 0, c.b.size(), at);
  const ExactVector x{ExactSum(c.point[0]), ExactSum(c.point[1]), ExactSum(c.point[2])};
  return holds(c.a.at(0), x, ExactSum(c.divisor), c.mix_a) && holds(c.b.at(0), x, ExactSum(c.divisor), c.mix_b);
} catch (const std::out_of_range&) {  // an index out of range
  return false;
}

}  // namespace collided
