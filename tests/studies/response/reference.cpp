#include "tests/studies/response/reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collided::response {
namespace {

// Far beyond any double: e^n is 0 for e up to 0.999 before.
constexpr double kMostImpacts = 1e6;

}  // namespace

double RigidBall::first_impact_s() const { return std::sqrt(2 * height_m / gravity_m_s2); }

double RigidBall::impact_s(std::uint64_t n) const {
  const double flights = static_cast<double>(n - 1);
  if (restitution == 1) return first_impact_s() * (1 + 2 * flights);
  // 1 + 2 (e + e^2 + ... + e^(n - 1))
  return first_impact_s() * (1 + 2 * restitution * (1 - std::pow(restitution, flights)) / (1 - restitution));
}

double RigidBall::rest_s() const {
  if (restitution == 1) return std::numeric_limits<double>::infinity();
  return first_impact_s() * (1 + restitution) / (1 - restitution);
}

std::uint64_t RigidBall::impacts_until(double seconds) const {
  if (seconds < first_impact_s()) return 0;
  double count = kMostImpacts;
  if (restitution == 1) count = std::floor((seconds / first_impact_s() - 1) / 2) + 1;
  else if (const double share = (rest_s() - seconds) / (rest_s() - first_impact_s()); share > 0 && restitution > 0) {
    count = std::floor(std::log(share) / std::log(restitution)) + 1;
  }
  auto n = static_cast<std::uint64_t>(std::min(count, kMostImpacts));
  // Logarithm and floor may be one off where a time is that of an impact.
  while (impact_s(n + 1) <= seconds && static_cast<double>(n) < kMostImpacts) ++n;
  while (n > 1 && impact_s(n) > seconds) --n;
  return n;
}

double RigidBall::height(double seconds) const {
  if (seconds >= rest_s()) return 0;
  const std::uint64_t n = impacts_until(seconds);
  if (n == 0) return height_m - 0.5 * gravity_m_s2 * seconds * seconds;
  const double since = seconds - impact_s(n);
  const double speed = gravity_m_s2 * first_impact_s() * std::pow(restitution, static_cast<double>(n));
  return std::max(0.0, since * (speed - 0.5 * gravity_m_s2 * since));
}

ReferenceState compliant_ball(const Spring& spring, double mass_kg, double gravity_m_s2, double height_m,
                              double velocity_m_s, double seconds) {
  ReferenceState state{.position_m = height_m, .velocity_m_s = velocity_m_s};
  double left = seconds;
  while (left > 0) {
    const double flight = std::min(left, time_to_touch(state.position_m, state.velocity_m_s, -gravity_m_s2));
    state.position_m += (state.velocity_m_s - 0.5 * gravity_m_s2 * flight) * flight;
    state.velocity_m_s -= gravity_m_s2 * flight;
    left -= flight;
    if (left <= 0) return state;
    const ContactPhase phase(spring, mass_kg, -state.velocity_m_s, mass_kg * gravity_m_s2);
    const double held = std::min(left, phase.duration());
    // A contact that ends ends at its depth: a damper lets go before the spring is at its length again.
    state.position_m = -phase.depth(held);
    state.velocity_m_s = -phase.depth_rate(held);
    state.deepest_m = std::max(state.deepest_m, phase.deepest());
    ++state.contacts;
    left -= held;
    if (left > 0 && state.position_m < 0) {
      // Up to the surface the spring, let go, follows without a force.
      const double out =
          (std::sqrt(std::max(0.0, state.velocity_m_s * state.velocity_m_s + 2 * gravity_m_s2 * state.position_m)) -
           state.velocity_m_s) /
          -gravity_m_s2;
      const double risen = std::min(left, out);
      state.position_m += (state.velocity_m_s - 0.5 * gravity_m_s2 * risen) * risen;
      state.velocity_m_s -= gravity_m_s2 * risen;
      left -= risen;
    }
  }
  return state;
}

Motion compliant_pair(const Spring& spring, const Line& line, const Motion& start, double seconds) {
  const double total = line.mass_kg[0] + line.mass_kg[1];
  const double centre = (line.mass_kg[0] * start.position_m[0] + line.mass_kg[1] * start.position_m[1]) / total;
  const double drift = momentum(line, start) / total;
  const double reduced = line.reduced_mass(1);
  double open_m = gap(line, start.position_m, 1);
  double rate = gap_rate(line, start.velocity_m_s, 1);
  const double onset = time_to_touch(open_m, rate, 0);
  if (onset >= seconds) {
    open_m += rate * seconds;
  } else {
    const ContactPhase phase(spring, reduced, -rate, 0);
    const double held = std::min(seconds - onset, phase.duration());
    rate = -phase.depth_rate(held);
    open_m = -phase.depth(held) + rate * (seconds - onset - held);
  }
  const double distance = open_m + line.radius_m[0] + line.radius_m[1];
  const double middle = centre + drift * seconds;
  return {{middle - line.mass_kg[1] / total * distance, middle + line.mass_kg[0] / total * distance},
          {drift - line.mass_kg[1] / total * rate, drift + line.mass_kg[0] / total * rate}};
}

}  // namespace collided::response
