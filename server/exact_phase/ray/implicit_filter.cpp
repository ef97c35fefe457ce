#include "server/exact_phase/ray/implicit_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/geometry/lost_in_sum.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

using Along = RayPolynomial<Bounded>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double sum_down(double a, double b) {
  const double sum = a + b;
  return lost_in_sum(a, b, sum) < 0 ? std::nextafter(sum, -kInfinity) : sum;
}
double sum_up(double a, double b) { return -sum_down(-a, -b); }

/// The part of the ray in which a hit may be: it begins in [entry_low, entry_high] and ends in [exit_low, exit_high],
/// both infinite if nothing ends it. Written so that NaN makes nothing certain.
struct HitRange {
  double entry_low = 0;
  double entry_high = 0;
  double exit_low = kInfinity;
  double exit_high = kInfinity;

  void begin_after(const Bounded& t) {
    if (t.low() > entry_low) entry_low = t.low();
    if (!(t.high() <= entry_high)) entry_high = t.high();
  }
  void end_before(const Bounded& t) {
    if (!(t.low() >= exit_low)) exit_low = t.low();
    if (t.high() < exit_high) exit_high = t.high();
  }
  bool surely_empty() const { return entry_low > exit_high; }
};

HitRange range_of(const Ray& ray, const ImplicitSurface& surface) {
  HitRange range;
  if (std::isfinite(ray.length_m))
    range.end_before(Bounded(ray.length_m) / sqrt(square(Vector<Bounded>(ray.direction))));
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis];
    const double d = ray.direction[axis];
    if (d == 0 && (o < surface.low[axis] || o > surface.high[axis])) range.exit_high = -1;
    if (d == 0) continue;
    const double first = d > 0 ? surface.low[axis] : surface.high[axis];
    const double last = d > 0 ? surface.high[axis] : surface.low[axis];
    if (std::isfinite(first)) range.begin_after((Bounded(first) - Bounded(o)) / Bounded(d));
    if (std::isfinite(last)) range.end_before((Bounded(last) - Bounded(o)) / Bounded(d));
  }
  return range;
}

/// The ray restarted at another of its points, so that f is evaluated near the surface: the parameter is shift + s. Far
/// from the surface, powers of the parameter would cancel all deciding digits.
struct Shifted {
  double shift = 0;
  Vector<Bounded> origin;
  Vector<Bounded> direction;
};

/// origin + t * direction, rounded once, with a bound on the error.
Bounded moved(double origin, double t, double direction) {
  if (direction == 0) return origin;
  const double motion = t * direction;
  const double motion_rest = std::fma(t, direction, -motion);
  const double sum = origin + motion;
  const double rest = lost_in_sum(origin, motion, sum) + motion_rest;
  const double value = sum + rest;
  if (rest == 0 && std::abs(motion) > kSmallestPlain) return value;
  return {value, 2 * kRoundoff * (std::abs(value) + std::abs(rest)) + kUnderflow};
}

Shifted shifted(const Ray& ray, const ImplicitSurface& surface) {
  constexpr double kWorthIt = 8;
  const Vec3 middle = surface.low.allFinite() && surface.high.allFinite() ? Vec3(surface.low / 2 + surface.high / 2)
                                                                          : Vec3(Vec3::Zero());
  const Shifted as_it_is{0, Vector<Bounded>(ray.origin), Vector<Bounded>(ray.direction)};
  const Vec3 away = middle - ray.origin;
  const double t = away.dot(ray.direction) / ray.direction.squaredNorm();
  constexpr double kLargestToSquare = 0x1p500;
  if (!(std::abs(t) > 1 / kLargestToSquare && std::abs(t) < kLargestToSquare)) return as_it_is;
  Vector<Bounded> there;
  Bounded* const component[3] = {&there.x, &there.y, &there.z};
  double size_there = 0;
  for (int axis = 0; axis < 3; ++axis) {
    *component[axis] = moved(ray.origin[axis], t, ray.direction[axis]);
    size_there = std::max(size_there, std::abs(component[axis]->value));
  }
  // Nothing is gained if the surface is as far from the frame's origin as the ray.
  if (!(size_there * kWorthIt < ray.origin.cwiseAbs().maxCoeff())) return as_it_is;
  return {t, there, as_it_is.direction};
}

/// A power of two above every |root|, infinite if that is uncertain. Fujiwara's bound: 2 max |c_k / c_n|^(1 / (n - k)).
double root_bound(const Along& p) {
  const int n = p.count() - 1;
  const double lead = std::abs(p[n].value) - p[n].bound() * (1 + kBoundSlack);
  if (!(lead > 0)) return kInfinity;
  int lead_power = 0;
  std::frexp(lead, &lead_power);
  int power = -1100;
  for (int k = 0; k < n; ++k) {
    const double size = (std::abs(p[k].value) + p[k].bound()) * (1 + kBoundSlack);
    if (!std::isfinite(size)) return kInfinity;
    if (size == 0) continue;
    int size_power = 0;
    std::frexp(size, &size_power);
    // |c_k / c_n| < 2^ratio; its root is rounded up.
    const int ratio = size_power - lead_power + 1;
    const int degree = n - k;
    power = std::max(power, ratio > 0 ? (ratio + degree - 1) / degree : -(-ratio / degree));
  }
  // At least the smallest doubles: a bound of zero would leave no room for a root of 1e-600.
  return std::ldexp(1.0, std::max(power + 2, -1000));
}

/// The largest number of sign changes that the coefficients may have, whatever the unsure signs are.
int most_sign_changes(const Along::Coefficients& coefficient, int count) {
  constexpr int kNever = -100;
  int up = kNever;    // the most changes if the last sign other than zero is positive
  int down = kNever;  // if it is negative
  for (int j = 0; j < count; ++j) {
    const Sign s = sign(coefficient[j]);
    const int next_up = std::max({up, down + 1, 0});
    const int next_down = std::max({down, up + 1, 0});
    if (s == Sign::positive || s == Sign::unsure) up = std::max(up, next_up);
    if (s == Sign::negative || s == Sign::unsure) down = std::max(down, next_down);
    if (s == Sign::positive) down = kNever;
    if (s == Sign::negative) up = kNever;
  }
  return std::max({up, down, 0});
}

struct ValueSpan {
  double low = 0;
  double high = 0;
};

/// Isolates the roots of a polynomial in a span, one after the other.
class RootSearch {
 public:
  RootSearch(const Along& polynomial, const ValueSpan& whole) : polynomial_(polynomial) { left_[count_++] = whole; }

  /// no: there is none left. yes: the span holds one simple root, with certain signs at its ends.
  Decision next(ValueSpan& isolated) {
    for (; steps_ < kMostSteps && count_ > 0; ++steps_) {
      const ValueSpan span = left_[--count_];
      const auto coefficient = polynomial_.on_span(Bounded(span.low), Bounded(span.high));
      const int changes = most_sign_changes(coefficient, polynomial_.count());
      const Sign first = sign(coefficient[0]);
      const Sign last = sign(coefficient[polynomial_.count() - 1]);
      const bool sure_ends = is_sure(first) && is_sure(last);
      if (changes == 0 && sure_ends) continue;
      if (changes == 1 && sure_ends) {
        isolated = span;
        return Decision::yes;
      }
      if (!split(span)) return Decision::undecided;
    }
    return count_ == 0 ? Decision::no : Decision::undecided;
  }

 private:
  static bool is_sure(Sign s) { return s == Sign::positive || s == Sign::negative; }

  /// Avoids the middle, where symmetrical scenes have their roots. False if neither of two places has a certain sign.
  bool split(const ValueSpan& span) {
    if (count_ + 2 > static_cast<int>(left_.size())) return false;
    for (const double share : {0.46875, 0.5390625}) {
      const double at = span.low + share * (span.high - span.low);
      if (!(at > span.low && at < span.high)) return false;
      if (!is_sure(sign(polynomial_.at(Bounded(at))))) continue;
      left_[count_++] = {at, span.high};
      left_[count_++] = {span.low, at};
      return true;
    }
    return false;
  }

  static constexpr int kMostSteps = 200;
  const Along& polynomial_;
  std::array<ValueSpan, 64> left_{};
  int count_ = 0;
  int steps_ = 0;
};

/// An approximation of the root: Newton's steps while they stay between the signs, otherwise halving. No decision
/// depends on it.
double guessed_root(const Along& p, ValueSpan span, bool rises) {
  double t = span.low + (span.high - span.low) / 2;
  for (int step = 0; step < 64; ++step) {
    double value = 0;
    double slope = 0;
    for (int i = p.count() - 1; i >= 0; --i) {
      slope = slope * t + value;
      value = value * t + p[i].value;
    }
    ((value > 0) == rises ? span.high : span.low) = t;
    double next = t - value / slope;
    if (!(next > span.low && next < span.high)) next = span.low + (span.high - span.low) / 2;
    if (std::abs(next - t) <= 2 * kRoundoff * std::abs(t) || !(next > span.low && next < span.high)) return next;
    t = next;
  }
  return t;
}

/// Narrows to the points nearest to the root, on both sides, at which double has a certain sign.
ValueSpan narrowed(const Along& p, const ValueSpan& span) {
  const bool rises = sign(p.at(Bounded(span.high))) == Sign::positive;
  const Sign before = rises ? Sign::negative : Sign::positive;
  const Sign after = rises ? Sign::positive : Sign::negative;
  const double guess = guessed_root(p, span, rises);
  const Bounded there = p.at(Bounded(guess));
  const double slope = std::abs(p.derivative().at(Bounded(guess)).value);
  double reach = std::max(1.25 * (std::abs(there.value) + there.bound()) / slope, kRoundoff * std::abs(guess));
  ValueSpan close = span;
  for (int step = 0; step < 5; ++step, reach *= 6) {
    const double low = guess - reach;
    const double high = guess + reach;
    if (low > close.low && low < close.high && sign(p.at(Bounded(low))) == before) close.low = low;
    if (high > close.low && high < close.high && sign(p.at(Bounded(high))) == after) close.high = high;
    if (close.high - close.low <= 2.5 * reach) break;
  }
  return close;
}

Bounded between(double low, double high) {
  const double middle = low + (high - low) / 2;
  return {middle, std::max(high - middle, middle - low) * (1 + kBoundSlack)};
}

}  // namespace

FilteredMeeting first_meeting(const Ray& ray, const ImplicitSurface& surface) {
  FilteredMeeting result;
  const HitRange range = range_of(ray, surface);
  if (range.surely_empty()) return {.meets = Decision::no, .low = 0, .high = 0, .point = {}};
  const Shifted from = shifted(ray, surface);
  Along p = along(surface, from.origin, from.direction);
  p.trim();
  if (p.count() == 0) return result;
  const double bound = p.count() > 1 ? root_bound(p) : 0;
  const ValueSpan whole{std::max(sum_down(range.entry_low, -from.shift), -bound),
                        std::min(sum_up(range.exit_high, -from.shift), bound)};
  if (!std::isfinite(whole.low) || !std::isfinite(whole.high)) return result;
  if (p.count() == 1 || whole.low > whole.high) {
    const bool sure = p.count() > 1 || sign(p[0]) == Sign::positive || sign(p[0]) == Sign::negative;
    if (sure) result.meets = Decision::no;
    return result;
  }
  RootSearch search(p, whole);
  for (int root = 0; root < p.count(); ++root) {
    ValueSpan isolated;
    const Decision found = search.next(isolated);
    if (found != Decision::yes) return {.meets = found, .low = 0, .high = 0, .point = {}};
    const ValueSpan close = narrowed(p, isolated);
    const double low = std::max(sum_down(from.shift, close.low), range.entry_low);
    const double high = std::min(sum_up(from.shift, close.high), range.exit_high);
    if (high < range.entry_low) continue;
    if (low > range.exit_high) return {.meets = Decision::no, .low = 0, .high = 0, .point = {}};
    if (!(low >= range.entry_high && high <= range.exit_low)) return result;
    const Bounded s = between(close.low, close.high);
    return {Decision::yes,
            low,
            high,
            {from.origin.x + s * from.direction.x, from.origin.y + s * from.direction.y,
             from.origin.z + s * from.direction.z}};
  }
  return result;
}

}  // namespace collided::engine::kernel
