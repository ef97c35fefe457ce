#include "tests/oracle/meeting_oracle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

namespace collided::oracle {
namespace {

constexpr mp_bitcnt_t kBits = 400;

using Point = std::array<mpq_class, 3>;

Point position_at(const MovingBody& body, const mpq_class& time_ns) {
  const auto& instants = body.instants;
  std::size_t i = 1;
  while (i + 1 < instants.size() && mpq_class(static_cast<long>(instants[i].time_ns)) < time_ns) ++i;
  const Instant& from = instants[i - 1];
  const Instant& to = instants[i];
  const mpq_class start(static_cast<long>(from.time_ns));
  const mpq_class share = (time_ns - start) / mpq_class(static_cast<long>(to.time_ns - from.time_ns));
  Point at;
  for (int k = 0; k < 3; ++k) {
    const std::size_t axis = static_cast<std::size_t>(k);
    at[axis] = mpq_class(from.position[k]) + share * (mpq_class(to.position[k]) - mpq_class(from.position[k]));
  }
  return at;
}

/// In shares of the piece; nothing: they do not touch in it.
using Span = std::optional<std::pair<mpf_class, mpf_class>>;

Span balls_touch(const Point& start, const Point& way, const mpq_class& reach, double& closest_m) {
  mpq_class a = 0, b = 0, c = -reach * reach;
  for (std::size_t k = 0; k < 3; ++k) {
    a += way[k] * way[k];
    b += start[k] * way[k];
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

Span boxes_touch(const Point& start, const Point& way, const Point& reach, double& closest_m) {
  mpq_class low = 0, high = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    if (way[k] == 0) {
      if (abs(start[k]) <= reach[k]) continue;
      closest_m = std::min(closest_m, mpq_class(abs(start[k]) - reach[k]).get_d());
      return std::nullopt;
    }
    mpq_class in = (-reach[k] - start[k]) / way[k];
    mpq_class out = (reach[k] - start[k]) / way[k];
    if (in > out) std::swap(in, out);
    low = std::max(low, in);
    high = std::min(high, out);
  }
  mpq_class longest = 0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, mpq_class(abs(way[k])));
  closest_m = std::min(closest_m, std::abs(mpq_class((high - low) * longest).get_d()));
  if (low > high) return std::nullopt;
  return std::pair(mpf_class(low, kBits), mpf_class(high, kBits));
}

Span touch(const MovingBody& a, const MovingBody& b, const Point& start, const Point& way, double& closest_m) {
  if (const double* radius = std::get_if<double>(&a.form)) {
    return balls_touch(start, way, mpq_class(*radius) + mpq_class(std::get<double>(b.form)), closest_m);
  }
  Point reach;
  for (int k = 0; k < 3; ++k) {
    reach[static_cast<std::size_t>(k)] = mpq_class(std::get<Vec3>(a.form)[k]) + mpq_class(std::get<Vec3>(b.form)[k]);
  }
  return boxes_touch(start, way, reach, closest_m);
}

}  // namespace

std::vector<Meeting> meetings(const MovingBody& a, const MovingBody& b, double& closest_m) {
  closest_m = std::numeric_limits<double>::infinity();
  std::set<std::int64_t> times;
  const std::int64_t first = std::max(a.instants.front().time_ns, b.instants.front().time_ns);
  const std::int64_t last = std::min(a.instants.back().time_ns, b.instants.back().time_ns);
  for (const MovingBody* body : {&a, &b}) {
    for (const Instant& instant : body->instants) times.insert(std::clamp(instant.time_ns, first, last));
  }
  std::vector<Meeting> found;
  for (auto to = std::next(times.begin()); to != times.end(); ++to) {
    const std::int64_t from = *std::prev(to);
    const mpq_class t0(static_cast<long>(from));
    const mpq_class t1(static_cast<long>(*to));
    const Point a0 = position_at(a, t0), a1 = position_at(a, t1), b0 = position_at(b, t0), b1 = position_at(b, t1);
    Point start, way;
    for (std::size_t k = 0; k < 3; ++k) {
      start[k] = b0[k] - a0[k];
      way[k] = (b1[k] - a1[k]) - start[k];
    }
    const Span span = touch(a, b, start, way, closest_m);
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

}  // namespace collided::oracle
