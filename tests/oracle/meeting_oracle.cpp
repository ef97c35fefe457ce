#include "tests/oracle/meeting_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace collided::oracle {
using namespace engine;
namespace {

constexpr mp_bitcnt_t kBits = 400;

using Point = std::array<mpq_class, 3>;

std::pair<const Instant&, const Instant&> piece_at(const MovingBody& body, std::int64_t time_ns) {
  const auto& instants = body.instants;
  const auto is_before = [](const Instant& instant, std::int64_t time) { return instant.time_ns < time; };
  const auto to = std::lower_bound(instants.begin() + 1, instants.end() - 1, time_ns, is_before);
  return {*std::prev(to), *to};
}

Vec3 roughly_at(const MovingBody& body, std::int64_t time_ns) {
  const auto [from, to] = piece_at(body, time_ns);
  const double share = static_cast<double>(time_ns - from.time_ns) / static_cast<double>(to.time_ns - from.time_ns);
  return from.position + share * (to.position - from.position);
}

double size_m(const MovingBody& body) {
  const double* radius = std::get_if<double>(&body.form);
  return radius != nullptr ? *radius : std::get<Vec3>(body.form).norm();
}

/// So far from each other for so short a time that no rounding of doubles matters: rationals would find nothing either.
bool are_far(const MovingBody& a, const MovingBody& b, std::int64_t from_ns, std::int64_t to_ns) {
  constexpr double kFar_m = 0.01;
  const Vec3 start = roughly_at(b, from_ns) - roughly_at(a, from_ns);
  const Vec3 displacement = roughly_at(b, to_ns) - roughly_at(a, to_ns) - start;
  return start.norm() - displacement.norm() > size_m(a) + size_m(b) + kFar_m;
}

/// In shares of the piece; nothing: they do not touch in it.
using Span = std::optional<std::pair<mpf_class, mpf_class>>;

Span balls_touch(const Point& start, const Point& displacement, const mpq_class& reach, double& closest_m) {
  mpq_class a = 0, b = 0, c = -reach * reach;
  for (std::size_t k = 0; k < 3; ++k) {
    a += displacement[k] * displacement[k];
    b += start[k] * displacement[k];
    c += start[k] * start[k];
  }
  const auto gap_at = [&](const mpq_class& s) {
    const mpf_class square(a * s * s + 2 * b * s + c + reach * reach, kBits);
    return std::abs(mpf_class(sqrt(square) - mpf_class(reach, kBits)).get_d());
  };
  if (a == 0) {
    closest_m = std::min(closest_m, gap_at(0));
    if (c > 0) return std::nullopt;
    return std::pair(mpf_class(0, kBits), mpf_class(1, kBits));
  }
  const mpq_class nearest = std::clamp<mpq_class>(-b / a, 0, 1);
  closest_m = std::min(closest_m, gap_at(nearest));
  const mpq_class under = b * b - a * c;
  if (under < 0) return std::nullopt;
  const mpf_class root = sqrt(mpf_class(under, kBits));
  const mpf_class low = (mpf_class(-b, kBits) - root) / mpf_class(a, kBits);
  const mpf_class high = (mpf_class(-b, kBits) + root) / mpf_class(a, kBits);
  if (high < 0 || low > 1) return std::nullopt;
  return std::pair(mpf_class(low < 0 ? mpf_class(0, kBits) : low), mpf_class(high > 1 ? mpf_class(1, kBits) : high));
}

Span boxes_touch(const Point& start, const Point& displacement, const Point& reach, double& closest_m) {
  mpq_class low = 0, high = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    if (displacement[k] == 0) {
      const mpq_class gap = abs(start[k]) - reach[k];
      closest_m = std::min(closest_m, std::abs(gap.get_d()));
      if (gap > 0) return std::nullopt;
      continue;
    }
    mpq_class in = (-reach[k] - start[k]) / displacement[k];
    mpq_class out = (reach[k] - start[k]) / displacement[k];
    if (in > out) std::swap(in, out);
    low = std::max(low, in);
    high = std::min(high, out);
  }
  mpq_class longest = 0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, mpq_class(abs(displacement[k])));
  if (longest > 0) closest_m = std::min(closest_m, std::abs(mpq_class((high - low) * longest).get_d()));
  if (low > high) return std::nullopt;
  return std::pair(mpf_class(low, kBits), mpf_class(high, kBits));
}

Span touch(const MovingBody& a, const MovingBody& b, const Point& start, const Point& displacement, double& closest_m) {
  if (const double* radius = std::get_if<double>(&a.form)) {
    return balls_touch(start, displacement, mpq_class(*radius) + mpq_class(std::get<double>(b.form)), closest_m);
  }
  Point reach;
  for (int k = 0; k < 3; ++k) {
    reach[static_cast<std::size_t>(k)] = mpq_class(std::get<Vec3>(a.form)[k]) + mpq_class(std::get<Vec3>(b.form)[k]);
  }
  return boxes_touch(start, displacement, reach, closest_m);
}

}  // namespace

std::array<mpq_class, 3> position_at(const MovingBody& body, std::int64_t time_ns) {
  const auto [from, to] = piece_at(body, time_ns);
  mpq_class share(static_cast<long>(time_ns - from.time_ns), static_cast<long>(to.time_ns - from.time_ns));
  share.canonicalize();
  Point at;
  for (int k = 0; k < 3; ++k) {
    const std::size_t axis = static_cast<std::size_t>(k);
    at[axis] = mpq_class(from.position[k]) + share * (mpq_class(to.position[k]) - mpq_class(from.position[k]));
  }
  return at;
}

std::set<std::int64_t> common_instants(const MovingBody& a, const MovingBody& b) {
  std::set<std::int64_t> times;
  const std::int64_t first = std::max(a.instants.front().time_ns, b.instants.front().time_ns);
  const std::int64_t last = std::min(a.instants.back().time_ns, b.instants.back().time_ns);
  for (const MovingBody* body : {&a, &b}) {
    for (const Instant& instant : body->instants) times.insert(std::clamp(instant.time_ns, first, last));
  }
  return times;
}

std::vector<Meeting> meetings(const MovingBody& a, const MovingBody& b, double& closest_m) {
  closest_m = std::numeric_limits<double>::infinity();
  const std::set<std::int64_t> times = common_instants(a, b);
  std::vector<Meeting> found;
  for (auto to = std::next(times.begin()); to != times.end(); ++to) {
    const std::int64_t from = *std::prev(to);
    if (are_far(a, b, from, *to)) continue;
    const mpq_class t0(static_cast<long>(from));
    const mpq_class t1(static_cast<long>(*to));
    const Point a0 = position_at(a, from), a1 = position_at(a, *to), b0 = position_at(b, from),
                b1 = position_at(b, *to);
    Point start, displacement;
    for (std::size_t k = 0; k < 3; ++k) {
      start[k] = b0[k] - a0[k];
      displacement[k] = (b1[k] - a1[k]) - start[k];
    }
    const Span span = touch(a, b, start, displacement, closest_m);
    if (!span) continue;
    const mpf_class length(t1 - t0, kBits);
    const mpf_class begin(mpf_class(t0, kBits) + span->first * length, kBits);
    const mpf_class end(mpf_class(t0, kBits) + span->second * length, kBits);
    const bool goes_on = !found.empty() && span->first == 0 && found.back().end_ns == mpf_class(t0, kBits);
    if (goes_on) found.back().end_ns = end;
    else found.push_back({begin, end});
  }
  return found;
}

void compare(const MovingBody& a, const MovingBody& b, std::span<const ToldMeeting> told, MeetingTally& tally) {
  double closest_m = 0;
  const std::vector<Meeting> truth = meetings(a, b, closest_m);
  if (closest_m < 1e-9) {
    ++tally.too_near;
    return;
  }
  ++tally.pairs;
  tally.meetings += static_cast<int>(truth.size());
  tally.missed += std::max(0, static_cast<int>(truth.size()) - static_cast<int>(told.size()));
  tally.invented += std::max(0, static_cast<int>(told.size()) - static_cast<int>(truth.size()));
  if (truth.size() != told.size()) return;
  const std::int64_t first_ns = std::max(a.instants.front().time_ns, b.instants.front().time_ns);
  const std::int64_t last_ns = std::min(a.instants.back().time_ns, b.instants.back().time_ns);
  const auto holds = [](const Bracket& bracket, const mpf_class& time_ns) {
    return time_ns >= static_cast<double>(bracket.low_ns) && time_ns <= static_cast<double>(bracket.high_ns);
  };
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool from_start = truth[i].begin_ns == static_cast<double>(first_ns) && told[i].began.high_ns <= first_ns;
    const bool begins = from_start || holds(told[i].began, truth[i].begin_ns);
    const bool ends =
        told[i].ended ? holds(*told[i].ended, truth[i].end_ns) : truth[i].end_ns == static_cast<double>(last_ns);
    tally.wrong_brackets += begins && ends ? 0 : 1;
  }
}

}  // namespace collided::oracle
