#include "tests/studies/response/stepper.hpp"

#include <algorithm>
#include <cmath>

#include "tests/studies/response/tolerance.hpp"

namespace collided::response {

std::string_view name(Method method) {
  switch (method) {
    case Method::explicit_euler: return "explicit_euler";
    case Method::semi_implicit_euler: return "semi_implicit_euler";
    case Method::implicit_euler: return "implicit_euler";
    case Method::compliant: return "compliant";
    case Method::impulse: break;
  }
  return "impulse";
}

void Stepper::use(const Line& line, const StepperOptions& options) {
  line_ = line;
  options_ = options;
  counts_ = {};
  episodes_.restart();
  next_substep_s_ = 0;
  highest_frequency_ = 0;
  if (options_.substep_error == 0) options_.substep_error = kSubstepError;
  for (std::size_t contact = 0; contact <= line_.size(); ++contact) {
    highest_frequency_ = std::max(highest_frequency_, options_.spring.frequency(line_.reduced_mass(contact)));
  }
}

double Stepper::energy(const Motion& motion) const {
  double sum = kinetic_energy(line_, motion) + gravity_energy(line_, motion);
  if (options_.method == Method::impulse) return sum;
  for (std::size_t contact = 0; contact <= line_.size(); ++contact) {
    const double depth_m = std::max(-gap(line_, motion.position_m, contact), 0.0);
    sum += 0.5 * options_.spring.stiffness_n_m * depth_m * depth_m;
  }
  return sum;
}

void Stepper::step(Motion& motion, double seconds) {
  if (!(seconds > 0)) return;
  switch (options_.method) {
    case Method::explicit_euler: step_explicitly(motion, seconds, false); break;
    case Method::semi_implicit_euler: step_explicitly(motion, seconds, true); break;
    case Method::implicit_euler: step_implicitly(motion, seconds); break;
    case Method::compliant: step_compliantly(motion, seconds); break;
    case Method::impulse: step_by_impulses(motion, seconds); break;
  }
  note(motion);
}

void Stepper::note(const Motion& motion) {
  counts_.deepest_m = std::max(counts_.deepest_m, deepest_penetration(line_, motion));
  episodes_.observe(line_, motion);
}

void Stepper::gather_accelerations(const std::vector<double>& force, std::vector<double>& acceleration) const {
  acceleration.resize(line_.size());
  for (std::size_t body = 0; body < line_.size(); ++body) {
    acceleration[body] = line_.gravity_m_s2 + (force[body] - force[body + 1]) / line_.mass_kg[body];
  }
}

void Stepper::step_explicitly(Motion& motion, double seconds, bool positions_last) {
  ++counts_.substeps;
  contact_forces(line_, options_.spring, motion, 0, force_);
  gather_accelerations(force_, start_acceleration_);
  for (std::size_t body = 0; body < line_.size(); ++body) {
    const double before = motion.velocity_m_s[body];
    motion.velocity_m_s[body] += seconds * start_acceleration_[body];
    motion.position_m[body] += seconds * (positions_last ? motion.velocity_m_s[body] : before);
  }
}

void Stepper::step_implicitly(Motion& motion, double seconds) {
  ++counts_.substeps;
  for (double& velocity : motion.velocity_m_s) velocity += seconds * line_.gravity_m_s2;
  solve_.stage(line_, options_.spring, seconds, motion);
}

void Stepper::step_by_impulses(Motion& motion, double seconds) {
  ++counts_.substeps;
  const double touching_m = touching_gap(line_, motion);
  touching_.resize(line_.size() + 1);
  for (std::size_t contact = 0; contact <= line_.size(); ++contact)
    touching_[contact] = gap(line_, motion.position_m, contact) <= touching_m;
  const double resting_speed = kRestingSpeed * std::abs(line_.gravity_m_s2) * seconds;
  for (double& velocity : motion.velocity_m_s) velocity += seconds * line_.gravity_m_s2;
  resolve_impacts(line_, touching_, options_.restitution, resting_speed, motion.velocity_m_s, solve_);
  for (std::size_t body = 0; body < line_.size(); ++body)
    motion.position_m[body] += seconds * motion.velocity_m_s[body];
}

}  // namespace collided::response
