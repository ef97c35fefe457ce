#include "tests/studies/response/contact_solve.hpp"

#include <algorithm>
#include <cmath>

namespace collided::response {

void contact_forces(const Line& line, const Spring& spring, const Motion& motion, double touching_m,
                    std::vector<double>& force_n) {
  force_n.assign(line.size() + 1, 0);
  for (std::size_t contact = 0; contact <= line.size(); ++contact) {
    const double open_m = gap(line, motion.position_m, contact);
    if (!(open_m <= touching_m)) continue;
    const double damping = spring.damping_ratio > 0 ? spring.damping(line.reduced_mass(contact)) : 0;
    force_n[contact] = std::max(
        0.0, spring.stiffness_n_m * std::max(-open_m, 0.0) - damping * gap_rate(line, motion.velocity_m_s, contact));
  }
}

void ContactSolve::stage(const Line& line, const Spring& spring, double h, Motion& from) {
  const std::size_t contacts = line.size() + 1;
  need_.assign(contacts, 0);
  slack_.assign(contacts, 0);
  may_push_.assign(contacts, 0);
  for (std::size_t contact = 0; contact < contacts; ++contact) {
    const double open_m = gap(line, from.position_m, contact);
    if (!std::isfinite(open_m)) continue;
    const double damping = spring.damping_ratio > 0 ? spring.damping(line.reduced_mass(contact)) / h : 0;
    const double stiffness = spring.stiffness_n_m + damping;
    // The damper remembers the depth at the start: f = s max(0, -gap - depth(from) damping / s).
    const double remembered = std::max(-open_m, 0.0) * (damping / stiffness);
    may_push_[contact] = 1;
    slack_[contact] = 1 / stiffness;
    need_[contact] = -(open_m + h * gap_rate(line, from.velocity_m_s, contact)) - remembered;
  }
  solve(line, h * h);
  for (std::size_t body = 0; body < line.size(); ++body) {
    from.velocity_m_s[body] += h / line.mass_kg[body] * (force_[body] - force_[body + 1]);
    from.position_m[body] += h * from.velocity_m_s[body];
  }
}

void ContactSolve::stop(const Line& line, const std::vector<char>& touching, std::vector<double>& velocity_m_s) {
  const std::size_t contacts = line.size() + 1;
  may_push_ = touching;
  slack_.assign(contacts, 0);
  need_.resize(contacts);
  for (std::size_t contact = 0; contact < contacts; ++contact) need_[contact] = -gap_rate(line, velocity_m_s, contact);
  solve(line, 1);
  for (std::size_t body = 0; body < line.size(); ++body) {
    velocity_m_s[body] += (force_[body] - force_[body + 1]) / line.mass_kg[body];
  }
}

void ContactSolve::solve(const Line& line, double h2) {
  const std::size_t contacts = line.size() + 1;
  pushing_.assign(contacts, 0);
  force_.assign(contacts, 0);
  pivot_.resize(contacts);
  right_.resize(contacts);
  for (std::size_t round = 0; round <= contacts && admit(line, h2); ++round) {
    for (std::size_t first = 0; first < contacts; ++first) {
      if (!pushing_[first]) continue;
      std::size_t last = first;
      while (last + 1 < contacts && pushing_[last + 1]) ++last;
      solve_run(line, h2, first, last);
      first = last;
    }
  }
}

bool ContactSolve::admit(const Line& line, double h2) {
  bool joined = false;
  const std::size_t contacts = line.size() + 1;
  for (std::size_t contact = 0; contact < contacts; ++contact) {
    if (pushing_[contact] || !may_push_[contact]) continue;
    double over = need_[contact];
    if (contact > 0) over += h2 * line.inverse_mass_below(contact) * force_[contact - 1];
    if (contact + 1 < contacts) over += h2 * line.inverse_mass_above(contact) * force_[contact + 1];
    if (!(over > 0)) continue;
    pushing_[contact] = 1;
    joined = true;
  }
  return joined;
}

void ContactSolve::solve_run(const Line& line, double h2, std::size_t first, std::size_t last) {
  // A row is (-below, slack + below + above, -above); kept is its sum, which elimination changes by products alone.
  double kept = slack_[first] + h2 * line.inverse_mass_below(first);
  double right = need_[first];
  for (std::size_t contact = first; contact <= last; ++contact) {
    const double above = h2 * line.inverse_mass_above(contact);
    const double coupling = contact < last ? above : 0;
    const double sum = kept + (contact < last ? 0 : above);
    pivot_[contact] = sum + coupling;
    right_[contact] = right;
    if (contact == last) break;
    kept = slack_[contact + 1] + coupling * (sum / pivot_[contact]);
    right = need_[contact + 1] + coupling / pivot_[contact] * right;
  }
  for (std::size_t contact = last + 1; contact-- > first;) {
    const double above = contact < last ? h2 * line.inverse_mass_above(contact) * force_[contact + 1] : 0;
    // A contact that joined for another's push needs none without it: rounding may leave its force below 0 by an ulp.
    force_[contact] = std::max(0.0, (right_[contact] + above) / pivot_[contact]);
  }
}

}  // namespace collided::response
