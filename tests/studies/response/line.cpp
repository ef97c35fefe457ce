#include "tests/studies/response/line.hpp"

#include <algorithm>
#include <cmath>

#include "tests/studies/response/tolerance.hpp"

namespace collided::response {

double gap(const Line& line, const std::vector<double>& position_m, std::size_t contact) {
  if (contact == 0) return (position_m[0] - line.low_wall_m) - line.radius_m[0];
  if (contact == line.size()) return (line.high_wall_m - position_m[contact - 1]) - line.radius_m[contact - 1];
  return (position_m[contact] - position_m[contact - 1]) - (line.radius_m[contact - 1] + line.radius_m[contact]);
}

double gap_rate(const Line& line, const std::vector<double>& velocity_m_s, std::size_t contact) {
  const double above = contact == line.size() ? 0 : velocity_m_s[contact];
  const double below = contact == 0 ? 0 : velocity_m_s[contact - 1];
  return above - below;
}

double free_gap_acceleration(const Line& line, std::size_t contact) {
  if (contact == 0) return line.gravity_m_s2;
  return contact == line.size() ? -line.gravity_m_s2 : 0;
}

double largest_coordinate(const Line& line, const Motion& motion) {
  double largest = 0;
  for (std::size_t body = 0; body < line.size(); ++body) {
    largest = std::max({largest, std::abs(motion.position_m[body]), line.radius_m[body]});
  }
  return largest;
}

double touching_gap(const Line& line, const Motion& motion) { return kTouching * largest_coordinate(line, motion); }

double kinetic_energy(const Line& line, const Motion& motion) {
  double sum = 0;
  for (std::size_t body = 0; body < line.size(); ++body)
    sum += 0.5 * line.mass_kg[body] * motion.velocity_m_s[body] * motion.velocity_m_s[body];
  return sum;
}

double gravity_energy(const Line& line, const Motion& motion) {
  double sum = 0;
  for (std::size_t body = 0; body < line.size(); ++body)
    sum -= line.mass_kg[body] * line.gravity_m_s2 * motion.position_m[body];
  return sum;
}

double momentum(const Line& line, const Motion& motion) {
  double sum = 0;
  for (std::size_t body = 0; body < line.size(); ++body) sum += line.mass_kg[body] * motion.velocity_m_s[body];
  return sum;
}

double deepest_penetration(const Line& line, const Motion& motion) {
  double deepest = 0;
  for (std::size_t contact = 0; contact <= line.size(); ++contact)
    deepest = std::max(deepest, -gap(line, motion.position_m, contact));
  return deepest;
}

void fly(const Line& line, Motion& motion, double seconds) {
  for (std::size_t body = 0; body < line.size(); ++body) {
    motion.position_m[body] += (motion.velocity_m_s[body] + 0.5 * line.gravity_m_s2 * seconds) * seconds;
    motion.velocity_m_s[body] += line.gravity_m_s2 * seconds;
  }
}

double time_to_touch(double gap_m, double rate_m_s, double acceleration_m_s2) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (!std::isfinite(gap_m)) return kNever;
  const double open = std::max(gap_m, 0.0);
  const double discriminant = rate_m_s * rate_m_s - 2 * acceleration_m_s2 * open;
  if (discriminant < 0) return kNever;
  const double root = std::sqrt(discriminant);
  if (rate_m_s < 0) return 2 * open / (root - rate_m_s);
  if (acceleration_m_s2 < 0) return (rate_m_s + root) / -acceleration_m_s2;
  return kNever;
}

}  // namespace collided::response
