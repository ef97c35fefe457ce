#include "tests/oracle/margin_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace collided::oracle {
namespace {

constexpr mp_bitcnt_t kBits = 400;

using Triple = std::array<mpq_class, 3>;

/// The two between two instants: the difference of their centres goes from start to end while s goes from 0 to 1.
struct Stretch {
  Triple start;
  Triple end;
  Triple half;  // of boxes: both half sizes together
  bool are_boxes = false;
  mpq_class limit;  // squared distance counts up to its square; of balls the radii are in it

  mpq_class difference(std::size_t k, const mpq_class& s) const { return start[k] + s * (end[k] - start[k]); }
  /// What of the difference lies between the surfaces, along k.
  mpq_class gap(std::size_t k, const mpq_class& s) const {
    const mpq_class whole = difference(k, s);
    if (!are_boxes) return whole;
    if (whole > half[k]) return whole - half[k];
    if (whole < -half[k]) return whole + half[k];
    return 0;
  }
  mpq_class square(const mpq_class& s) const {
    mpq_class sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += gap(k, s) * gap(k, s);
    return sum;
  }
  double off_m(const mpq_class& s) const {
    // Boxes within each other are not near to parting.
    if (limit == 0 && square(s) == 0) return std::numeric_limits<double>::infinity();
    return std::abs(mpf_class(sqrt(mpf_class(square(s), kBits)) - mpf_class(limit, kBits)).get_d());
  }
  /// Where the nearest features change.
  std::set<mpq_class> joints() const {
    std::set<mpq_class> all{0, 1};
    for (std::size_t k = 0; are_boxes && k < 3; ++k) {
      const mpq_class slope = end[k] - start[k];
      if (slope == 0) continue;
      for (const mpq_class& side : {half[k], mpq_class(-half[k])}) {
        const mpq_class s = (side - start[k]) / slope;
        if (s > 0 && s < 1) all.insert(s);
      }
    }
    return all;
  }
};

using Part = std::pair<mpf_class, mpf_class>;

/// Where the quadratic through the squares at from, middle and to is at most the limit's square.
std::optional<Part> part_within(const Stretch& way, const mpq_class& from, const mpq_class& to, double& closest_m) {
  const mpq_class length = to - from;
  const mpq_class c = way.square(from) - way.limit * way.limit;
  const mpq_class at_end = way.square(to) - way.limit * way.limit;
  const mpq_class at_middle = way.square((from + to) / 2) - way.limit * way.limit;
  const mpq_class a = 2 * (at_end + c - 2 * at_middle);
  const mpq_class b = at_end - c - a;
  const auto in_stretch = [&](const mpf_class& u) {
    return mpf_class(mpf_class(from, kBits) + u * mpf_class(length, kBits));
  };
  const mpf_class zero(0, kBits), one(1, kBits);
  if (a == 0) {  // then b is 0, too: both rest along what counts
    if (c > 0) return std::nullopt;
    return Part(in_stretch(zero), in_stretch(one));
  }
  const mpq_class least = -b / (2 * a);
  if (least > 0 && least < 1) closest_m = std::min(closest_m, way.off_m(from + least * length));
  const mpq_class under = b * b - 4 * a * c;
  if (under < 0) return std::nullopt;
  const mpf_class root = sqrt(mpf_class(under, kBits));
  mpf_class low = (mpf_class(-b, kBits) - root) / mpf_class(2 * a, kBits);
  mpf_class high = (mpf_class(-b, kBits) + root) / mpf_class(2 * a, kBits);
  if (high < 0 || low > 1) return std::nullopt;
  if (low < 0) low = zero;
  if (high > 1) high = one;
  return Part(in_stretch(low), in_stretch(high));
}

Stretch stretch_of(const MovingBody& a, const MovingBody& b, std::int64_t from_ns, std::int64_t to_ns,
                   const mpq_class& within_m) {
  const Triple a0 = position_at(a, from_ns), a1 = position_at(a, to_ns), b0 = position_at(b, from_ns),
               b1 = position_at(b, to_ns);
  Stretch way{.start = {}, .end = {}, .half = {}, .are_boxes = std::holds_alternative<Vec3>(a.form), .limit = within_m};
  for (std::size_t k = 0; k < 3; ++k) {
    way.start[k] = b0[k] - a0[k];
    way.end[k] = b1[k] - a1[k];
    if (way.are_boxes) {
      const int axis = static_cast<int>(k);
      way.half[k] = mpq_class(std::get<Vec3>(a.form)[axis]) + mpq_class(std::get<Vec3>(b.form)[axis]);
    }
  }
  if (!way.are_boxes) way.limit += mpq_class(std::get<double>(a.form)) + mpq_class(std::get<double>(b.form));
  return way;
}

/// A change from out to in or back, before dwells are looked at.
struct Change {
  mpf_class at_ns;
  bool comes_in = false;
};

std::vector<Change> changes_of(const std::vector<Meeting>& within, const std::vector<Meeting>& stay,
                               const mpf_class& last_ns) {
  std::vector<Change> changes;
  for (const Meeting& around : stay) {
    const auto first = std::find_if(within.begin(), within.end(), [&](const Meeting& one) {
      return one.begin_ns >= around.begin_ns && one.begin_ns <= around.end_ns;
    });
    if (first == within.end()) continue;
    changes.push_back({first->begin_ns, true});
    // One that goes on at the end of the poses ends there up to the last of the bits.
    if (last_ns - around.end_ns > 1e-30) changes.push_back({around.end_ns, false});
  }
  return changes;
}

}  // namespace

std::vector<Meeting> times_within(const MovingBody& a, const MovingBody& b, const mpq_class& within_m,
                                  double& closest_m) {
  const std::set<std::int64_t> times = common_instants(a, b);
  std::vector<Meeting> found;
  for (auto to = std::next(times.begin()); to != times.end(); ++to) {
    const std::int64_t from = *std::prev(to);
    const Stretch way = stretch_of(a, b, from, *to, within_m);
    closest_m = std::min(closest_m, std::min(way.off_m(0), way.off_m(1)));
    const std::set<mpq_class> joints = way.joints();
    for (auto end = std::next(joints.begin()); end != joints.end(); ++end) {
      const std::optional<Part> part = part_within(way, *std::prev(end), *end, closest_m);
      if (!part) continue;
      const mpf_class start(static_cast<double>(from), kBits), length(static_cast<double>(*to - from), kBits);
      const mpf_class begin_ns = start + length * part->first, end_ns = start + length * part->second;
      // Parts that follow each other meet up to the last of the 400 bits.
      if (!found.empty() && begin_ns - found.back().end_ns < 1e-30) found.back().end_ns = end_ns;
      else found.push_back({begin_ns, end_ns});
    }
  }
  return found;
}

std::vector<BandStay> band_stays(const MovingBody& a, const MovingBody& b, const OracleBand& band, double& closest_m,
                                 double& closest_ns) {
  const std::vector<Meeting> within = times_within(a, b, band.within_m, closest_m);
  const std::vector<Meeting> stay =
      times_within(a, b, mpq_class(band.within_m) + mpq_class(band.hysteresis_m), closest_m);
  const mpf_class last_ns(static_cast<double>(std::min(a.instants.back().time_ns, b.instants.back().time_ns)), kBits);
  const std::vector<Change> changes = changes_of(within, stay, last_ns);
  std::vector<BandStay> told;
  std::optional<Change> pending;
  const auto dwell_of = [&](const Change& change) {
    return static_cast<double>(change.comes_in ? band.dwell_in_ns : band.dwell_out_ns);
  };
  const auto tell = [&](const Change& change) {
    if (change.comes_in) told.push_back({change.at_ns, std::nullopt});
    else told.back().ended_ns = change.at_ns;
  };
  const auto lasts_until = [&](const mpf_class& time_ns) {
    const mpf_class over_ns = time_ns - pending->at_ns - dwell_of(*pending);
    if (dwell_of(*pending) > 0) closest_ns = std::min(closest_ns, std::abs(over_ns.get_d()));
    return over_ns >= 0;
  };
  for (const Change& change : changes) {
    if (pending) {
      const bool lasted = lasts_until(change.at_ns);
      if (lasted) tell(*pending);
      pending.reset();
      if (!lasted) continue;
    }
    pending = change;
  }
  if (pending && lasts_until(last_ns)) tell(*pending);
  return told;
}

}  // namespace collided::oracle
