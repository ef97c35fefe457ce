#include "tests/oracle/nearest_oracle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace collided::oracle {
namespace {

using Real = long double;
using Triple = std::array<Real, 3>;

/// Below this length of time nothing is told apart, nanoseconds.
constexpr Real kLeast_ns = 1e-4L;
/// Within so long after a change no change back is looked for, nanoseconds.
constexpr Real kAtOnce_ns = 20;

Triple centre(const MovingBody& body, Real time_ns) {
  const std::vector<Instant>& instants = body.instants;
  std::size_t to = 0;
  while (to + 1 < instants.size() && static_cast<Real>(instants[to].time_ns) < time_ns) ++to;
  Triple at;
  const Real end_ns = static_cast<Real>(instants[to].time_ns);
  const Real start_ns = to == 0 ? end_ns - 1 : static_cast<Real>(instants[to - 1].time_ns);
  const Real share = std::clamp<Real>((time_ns - start_ns) / (end_ns - start_ns), 0, 1);
  for (int k = 0; k < 3; ++k) {
    const Real first = instants[to == 0 ? 0 : to - 1].position[k];
    at[static_cast<std::size_t>(k)] = first + share * (static_cast<Real>(instants[to].position[k]) - first);
  }
  return at;
}

Real distance_between(const MovingBody& a, const MovingBody& b, Real time_ns) {
  const Triple from = centre(a, time_ns);
  const Triple to = centre(b, time_ns);
  const Real apart = std::hypot(from[0] - to[0], from[1] - to[1], from[2] - to[2]);
  return std::max<Real>(
      0, apart - static_cast<Real>(std::get<double>(a.form)) - static_cast<Real>(std::get<double>(b.form)));
}

class NearestSearch {
 public:
  NearestSearch(const MovingBody& about, const std::vector<MovingBody>& balls, const OracleNearest& asked)
      : about_(about), balls_(balls), asked_(asked) {}

  Real distance(int who, Real time_ns) const {
    return distance_between(about_, balls_[static_cast<std::size_t>(who)], time_ns);
  }
  /// By how much `next` is over what it takes to follow upon `now`, metres; -1: none of them.
  Real over(int now, int next, Real time_ns) const {
    if (next < 0)
      return distance(now, time_ns) - static_cast<Real>(asked_.within_m) - static_cast<Real>(asked_.hysteresis_m);
    if (now < 0) return static_cast<Real>(asked_.within_m) - distance(next, time_ns);
    return distance(now, time_ns) - static_cast<Real>(asked_.hysteresis_m) - distance(next, time_ns);
  }
  /// The first time in a stretch without an instant at which it follows.
  std::optional<Real> first_in(int now, int next, Real from_ns, Real to_ns, Real fastest) {
    nearly_.clear();
    const auto found = first(now, next, from_ns, to_ns, fastest);
    for (const auto& [time_ns, by_m] : nearly_) {
      if (!found || *found - time_ns > kAtOnce_ns) closest_m_ = std::min(closest_m_, by_m);
    }
    return found;
  }

  double closest_m_ = 1e300;

 private:
  std::optional<Real> first(int now, int next, Real from_ns, Real to_ns, Real fastest) {
    const Real middle_ns = (from_ns + to_ns) / 2;
    const Real by = over(now, next, middle_ns);
    if (by < -fastest * (to_ns - from_ns) / 2 * 1.000001L) return std::nullopt;
    if (to_ns - from_ns < kLeast_ns) {
      if (over(now, next, to_ns) >= 0) return to_ns;
      nearly_.push_back({to_ns, std::abs(static_cast<double>(by))});
      return std::nullopt;
    }
    if (const auto found = first(now, next, from_ns, middle_ns, fastest)) return found;
    return first(now, next, middle_ns, to_ns, fastest);
  }

  const MovingBody& about_;
  const std::vector<MovingBody>& balls_;
  const OracleNearest& asked_;
  std::vector<std::pair<Real, double>> nearly_;  // where it nearly followed, and by how much it did not
};

Real speed(const MovingBody& body, Real from_ns, Real to_ns) {
  const Triple from = centre(body, from_ns);
  const Triple to = centre(body, to_ns);
  return std::hypot(from[0] - to[0], from[1] - to[1], from[2] - to[2]) / (to_ns - from_ns);
}

std::vector<Real> all_instants(const MovingBody& about, const std::vector<MovingBody>& balls) {
  std::int64_t last_ns = about.instants.back().time_ns;
  std::int64_t first_ns = about.instants.front().time_ns;
  for (const MovingBody& ball : balls) {
    last_ns = std::min(last_ns, ball.instants.back().time_ns);
    first_ns = std::min(first_ns, ball.instants.front().time_ns);
  }
  std::vector<Real> times{static_cast<Real>(first_ns), static_cast<Real>(last_ns)};
  const auto add = [&](const MovingBody& body) {
    for (const Instant& instant : body.instants) {
      if (instant.time_ns > first_ns && instant.time_ns < last_ns) times.push_back(static_cast<Real>(instant.time_ns));
    }
  };
  add(about);
  std::for_each(balls.begin(), balls.end(), add);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace

std::vector<NearestStay> nearest_stays(const MovingBody& about, const std::vector<MovingBody>& balls,
                                       const OracleNearest& asked, double& closest_m, double& closest_ns) {
  NearestSearch search(about, balls, asked);
  const std::vector<Real> times = all_instants(about, balls);
  const int count = static_cast<int>(balls.size());
  // At first: the nearest within reach.
  NearestStay now{-1, times.front()};
  for (int who = 0; who < count; ++who) {
    const Real by = search.over(-1, who, times.front());
    closest_m = std::min(closest_m, std::abs(static_cast<double>(by)));
    if (by < 0) continue;
    if (now.who >= 0)
      closest_m = std::min(closest_m, static_cast<double>(std::abs(search.distance(who, times.front()) -
                                                                   search.distance(now.who, times.front()))));
    if (now.who < 0 || search.distance(who, times.front()) < search.distance(now.who, times.front())) now.who = who;
  }
  int before = now.who;
  std::vector<NearestStay> stays;
  if (now.who >= 0) stays.push_back(now);
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    Real from_ns = times[i];
    while (from_ns < times[i + 1]) {
      std::optional<NearestStay> next;
      for (int who = -1; who < count; ++who) {
        if (who == now.who) continue;
        Real fastest = 2 * speed(about, times[i], times[i + 1]);
        for (const int one : {who, now.who})
          fastest += one < 0 ? 0 : speed(balls[static_cast<std::size_t>(one)], times[i], times[i + 1]);
        // Where one follows another both are as near.
        const Real start_ns = who == before && from_ns == now.began_ns ? from_ns + kAtOnce_ns : from_ns;
        const Real end_ns = next ? next->began_ns : times[i + 1];
        if (start_ns >= end_ns) continue;
        const auto found = search.first_in(now.who, who, start_ns, end_ns, fastest);
        if (!found) continue;
        if (next) closest_ns = std::min(closest_ns, static_cast<double>(next->began_ns - *found));
        next = NearestStay{who, *found};
      }
      if (!next) break;
      if (next->who < 0) {
        // Another one may be near enough, which was not nearer by the hysteresis.
        for (int who = 0; who < count; ++who) {
          const Real by = search.over(-1, who, next->began_ns);
          if (who != now.who) closest_m = std::min(closest_m, std::abs(static_cast<double>(by)));
          const bool is_nearer =
              next->who < 0 || search.distance(who, next->began_ns) < search.distance(next->who, next->began_ns);
          if (who != now.who && by >= 0 && is_nearer) next->who = who;
        }
      }
      if (!stays.empty())
        closest_ns = std::min(closest_ns, static_cast<double>(next->began_ns - stays.back().began_ns));
      before = now.who;
      now = *next;
      stays.push_back(now);
      from_ns = now.began_ns;
    }
  }
  closest_m = std::min(closest_m, search.closest_m_);
  return stays;
}

long double distance_at(const MovingBody& a, const MovingBody& b, std::int64_t time_ns) {
  return distance_between(a, b, static_cast<Real>(time_ns));
}

}  // namespace collided::oracle
