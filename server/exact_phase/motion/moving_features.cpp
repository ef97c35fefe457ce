#include "server/exact_phase/motion/moving_features.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/motion/algebraic_time.hpp"
#include "server/exact_phase/motion/moving_exactly.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

using Times = Polynomial<Bounded>;

/// Spans of time that the filter tests before it hands over to rationals.
constexpr int kMostSpans = 48;

struct TimeRange {
  double low;
  double high;
};

bool finite(const Quartet& q) {
  return std::all_of(q.point.begin(), q.point.end(),
                     [](const MovingPoint& p) { return p.start.allFinite() && p.end.allFinite(); });
}

/// True if on some axis the first point stays strictly on one side of the other three (point and face), or one
/// segment's ends on one side of the other's. Exact, by comparing doubles: two points in linear motion keep their order
/// if both ends have it.
bool parted_by_axis(const Quartet& q) {
  const auto range = [&](int first, int last, int axis, Vec3 MovingPoint::*when) {
    TimeRange r{(q.point[first].*when)[axis], (q.point[first].*when)[axis]};
    for (int i = first + 1; i < last; ++i) {
      r.low = std::min(r.low, (q.point[i].*when)[axis]);
      r.high = std::max(r.high, (q.point[i].*when)[axis]);
    }
    return r;
  };
  const int first_count = q.kind == Quartet::Kind::point_face ? 1 : 2;
  for (int axis = 0; axis < 3; ++axis) {
    const TimeRange start_a = range(0, first_count, axis, &MovingPoint::start);
    const TimeRange start_b = range(first_count, 4, axis, &MovingPoint::start);
    const TimeRange end_a = range(0, first_count, axis, &MovingPoint::end);
    const TimeRange end_b = range(first_count, 4, axis, &MovingPoint::end);
    if (start_a.high < start_b.low && end_a.high < end_b.low) return true;
    if (start_b.high < start_a.low && end_b.high < end_a.low) return true;
  }
  return false;
}

/// How a cubic crosses zero on a span of time, from the signs of its Bernstein coefficients.
enum class ZeroCrossing { none, always, once, unsure };

ZeroCrossing crossing(const Times& cubic, const Bounded& low, const Bounded& high, Sign& before_high) {
  const auto span = cubic.on_span(low, high);
  const int last = cubic.count() - 1;
  std::array<Sign, 4> s{};
  bool same = true;
  for (int i = 0; i <= last; ++i) {
    s[i] = sign(span[i]);
    same = same && s[i] == s[0];
  }
  before_high = s[last];
  if (same && s[0] != Sign::unsure) return s[0] == Sign::zero ? ZeroCrossing::always : ZeroCrossing::none;
  const bool strict_ends =
      (s[0] == Sign::negative && s[last] == Sign::positive) || (s[0] == Sign::positive && s[last] == Sign::negative);
  if (!strict_ends) return ZeroCrossing::unsure;
  // The signs change exactly once, however the unsure ones turn out, unless those could alternate.
  return last < 3 || s[1] == s[0] || s[2] == s[3] ? ZeroCrossing::once : ZeroCrossing::unsure;
}

/// Decides what double with a running bound can decide about one pair of features.
class FeatureFilter {
 public:
  FeatureFilter(const Quartet& q, double width) : moving_(q), cubic_(moving_.coplanarity()), width_(width) {}

  Decision run(TimeBracket& bracket);
  /// There certainly is no contact before this time; 0 if even the start is undecided.
  double clear_until() const { return clear_until_; }

 private:
  Decision search(TimeBracket& bracket);
  Decision sides_on(double low, double high) const;
  bool narrow(TimeRange& span, Sign before_high) const;
  Decision cross(TimeRange span, Sign before_high, Decision inside, TimeBracket& bracket);

  MovingQuartet<Bounded> moving_;
  Times cubic_;
  double width_;
  Sides<Bounded> sides_{moving_};
  Gaps<Bounded> gaps_{moving_};
  double clear_until_ = 0;
};

Decision FeatureFilter::sides_on(double low, double high) const {
  return meets_in_plane(sides_, gaps_, [&](const Times& p) { return p.sign_on(low, high); });
}

/// Narrows the span around its only root to the given width; false if that cannot be certain.
bool FeatureFilter::narrow(TimeRange& span, Sign before_high) const {
  if (span.high - span.low <= width_) return true;
  std::array<double, 4> coefficient{};
  for (int i = 0; i < cubic_.count(); ++i) coefficient[i] = cubic_[i].value;
  const double guess = guessed_root(coefficient, span.low, span.high, before_high);
  for (const double t : {guess - width_ * 0.4375, guess + width_ * 0.4375}) {
    if (!(t > span.low && t < span.high)) continue;
    const Sign there = sign(cubic_.at(t));
    if (there != Sign::positive && there != Sign::negative) return false;
    (there == before_high ? span.high : span.low) = t;
  }
  return span.high - span.low <= width_;
}

/// Whether there is contact at the only time in the span at which the four points lie in one plane.
Decision FeatureFilter::cross(TimeRange span, Sign before_high, Decision inside, TimeBracket& bracket) {
  if (!narrow(span, before_high)) return Decision::undecided;
  if (inside == Decision::undecided) inside = sides_on(span.low, span.high);
  if (inside == Decision::yes) bracket = {span.low, span.high};
  return inside;
}

Decision FeatureFilter::search(TimeBracket& bracket) {
  // The earliest span is last, so that the first contact found is the first of all.
  std::array<TimeRange, kMostSpans> open;
  int open_count = 0;
  open[open_count++] = {0, 1};
  double unsure_since = 2;
  for (int looked = 0; looked < kMostSpans && open_count > 0; ++looked) {
    const TimeRange span = open[--open_count];
    Sign before_high = Sign::unsure;
    const Decision inside = sides_on(span.low, span.high);
    const ZeroCrossing crosses =
        inside == Decision::no ? ZeroCrossing::none : crossing(cubic_, span.low, span.high, before_high);
    Decision here = crosses == ZeroCrossing::none ? Decision::no : Decision::undecided;
    if (crosses == ZeroCrossing::once) here = cross(span, before_high, inside, bracket);
    if (crosses == ZeroCrossing::always) here = inside;
    if (here == Decision::yes && crosses == ZeroCrossing::always) {
      bracket = {std::min(unsure_since, span.low), span.low};
      // If the start itself is undecided, contact at 0 is a different answer from contact soon after.
      return span.low > 0 && bracket.low == 0 ? Decision::undecided : here;
    }
    // An undecided span can be settled only by contact throughout the next one.
    if (unsure_since < 2 && here != Decision::undecided) return Decision::undecided;
    if (here == Decision::yes) return here;
    if (here == Decision::no) {
      clear_until_ = span.high;
      continue;
    }
    if (crosses == ZeroCrossing::once) return Decision::undecided;
    if (crosses == ZeroCrossing::always && span.high - span.low <= width_) {
      if (unsure_since < 2) return Decision::undecided;
      unsure_since = span.low;
      continue;
    }
    const double half = span.low + (span.high - span.low) / 2;
    if (open_count + 2 > kMostSpans) return Decision::undecided;
    open[open_count++] = {half, span.high};
    open[open_count++] = {span.low, half};
  }
  return open_count == 0 && unsure_since == 2 ? Decision::no : Decision::undecided;
}

Decision FeatureFilter::run(TimeBracket& bracket) {
  if (cubic_.sign_on(0.0, 1.0) == Sign::positive || cubic_.sign_on(0.0, 1.0) == Sign::negative) return Decision::no;
  return search(bracket);
}

ExactResult first_contact(const Quartet& q, double width, TimeBracket& bracket) {
  if (!finite(q)) return {Decision::undecided, Level::filter};
  if (parted_by_axis(q)) return {Decision::no, Level::filter};
  FeatureFilter filter(q, width);
  const Decision quick = filter.run(bracket);
  if (quick != Decision::undecided) return {quick, Level::filter};
  ++rungs.uncertain;
  if (precision.highest != Level::rational) return {Decision::undecided, precision.highest};
  ++rungs.rational;
  return {first_contact_exactly(q, filter.clear_until(), width, bracket), Level::rational};
}

}  // namespace

ExactResult first_contact(const MovingPoint& point, const MovingTriangle& face, double width, TimeBracket& bracket) {
  return first_contact({{point, face.a, face.b, face.c}, Quartet::Kind::point_face}, width, bracket);
}

ExactResult first_contact(const MovingSegment& a, const MovingSegment& b, double width, TimeBracket& bracket) {
  return first_contact({{a.a, a.b, b.a, b.b}, Quartet::Kind::edge_edge}, width, bracket);
}

}  // namespace collided::engine
