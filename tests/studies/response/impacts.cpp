#include "client/cli/publish/response/collision.hpp"
#include "tests/studies/response/stepper.hpp"
#include "tests/studies/response/tolerance.hpp"

namespace collided::response {

std::uint64_t resolve_impacts(const Line& line, const std::vector<char>& touching, double restitution,
                              double resting_speed_m_s, std::vector<double>& velocity_m_s, ContactSolve& solve) {
  std::uint64_t bounces = 0;
  bool bounced = true;
  for (int round = 0; round < kMostRounds && bounced; ++round) {
    bounced = false;
    for (std::size_t contact = 0; contact <= line.size(); ++contact) {
      const double approach = touching[contact] ? -gap_rate(line, velocity_m_s, contact) : 0;
      if (!(approach > resting_speed_m_s)) continue;
      const InverseMasses masses{line.inverse_mass_below(contact), line.inverse_mass_above(contact)};
      const double impulse = impact_impulse(approach, masses, restitution);
      if (contact > 0) velocity_m_s[contact - 1] -= impulse * masses.a;
      if (contact < line.size()) velocity_m_s[contact] += impulse * masses.b;
      bounced = true;
      ++bounces;
    }
  }
  solve.stop(line, touching, velocity_m_s);
  return bounces;
}

}  // namespace collided::response
