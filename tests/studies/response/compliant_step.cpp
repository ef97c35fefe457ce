#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/studies/response/stepper.hpp"
#include "tests/studies/response/tolerance.hpp"

namespace collided::response {
namespace {

// TR-BDF2 with the share of the trapezoidal part that gives both stages one matrix and the method L-stability.
constexpr double kPart = 2 - std::numbers::sqrt2;
constexpr double kStage = kPart / 2;
constexpr double kOvershoot = 1 / (kPart * (2 - kPart));  // of the half state in the second stage; the start has 1 less
constexpr double kErrorConstant = (-3 * kPart * kPart + 4 * kPart - 2) / (12 * (2 - kPart));
// A substep that begins a contact, in units of 1 / frequency: the estimate takes over from there.
constexpr double kFirstSubstep = 1e-2;

bool holds(double gap_m, double rate_m_s, double acceleration_m_s2, double touching_m) {
  if (gap_m < -touching_m) return true;
  return gap_m <= touching_m && (rate_m_s < 0 || (rate_m_s == 0 && acceleration_m_s2 <= 0));
}

/// Hosea and Shampine's third-order estimate from the three slopes of a substep.
double local_error(double h, double start, double half, double end) {
  return 2 * kErrorConstant * h * (start / kPart - half / (kPart * (1 - kPart)) + end / (1 - kPart));
}

}  // namespace

bool Stepper::any_holds(const Motion& motion, double touching_m) const {
  for (std::size_t contact = 0; contact <= line_.size(); ++contact) {
    const double rate = gap_rate(line_, motion.velocity_m_s, contact);
    if (holds(gap(line_, motion.position_m, contact), rate, free_gap_acceleration(line_, contact), touching_m))
      return true;
  }
  return false;
}

/// Of the contacts that do not hold, with the accelerations of now: exact in free flight.
double Stepper::time_to_onset(const Motion& motion, double touching_m) const {
  double earliest = std::numeric_limits<double>::infinity();
  for (std::size_t contact = 0; contact <= line_.size(); ++contact) {
    const double open_m = gap(line_, motion.position_m, contact);
    const double rate = gap_rate(line_, motion.velocity_m_s, contact);
    if (holds(open_m, rate, free_gap_acceleration(line_, contact), touching_m)) continue;
    const double acceleration = gap_rate(line_, start_acceleration_, contact);
    earliest = std::min(earliest, time_to_touch(open_m, rate, acceleration));
  }
  return earliest;
}

void Stepper::step_compliantly(Motion& motion, double seconds) {
  step_s_ = seconds;
  double left = seconds;
  const double touching_m = touching_gap(line_, motion);
  for (int count = 0; left > 0; ++count) {
    if (count == kMostSubsteps) {
      step_implicitly(motion, left);
      ++counts_.surrendered;
      return;
    }
    if (any_holds(motion, touching_m)) {
      left -= advance_in_contact(motion, left, touching_m);
      continue;
    }
    force_.assign(line_.size() + 1, 0);
    gather_accelerations(force_, start_acceleration_);
    const double flight = std::min(left, time_to_onset(motion, touching_m));
    fly(line_, motion, flight);
    left -= flight;
    next_substep_s_ = kFirstSubstep / highest_frequency_;
    note(motion);
    ++counts_.substeps;
  }
}

double Stepper::advance_in_contact(Motion& motion, double most_s, double touching_m) {
  contact_forces(line_, options_.spring, motion, touching_m, force_);
  gather_accelerations(force_, start_acceleration_);
  if (next_substep_s_ == 0) next_substep_s_ = kFirstSubstep / highest_frequency_;
  const double onset = time_to_onset(motion, touching_m);
  double h = std::min(most_s, next_substep_s_);
  if (onset > 0) h = std::min(h, onset);
  // Ends: a substep that fails is at least a tenth shorter, and one without length has no error.
  for (;;) {
    const double error = substep(motion, h, touching_m);
    // Third order; a cube root so small that the next try almost surely passes.
    const double factor = std::clamp(0.9 * std::cbrt(1 / std::max(error, 1e-30)), 0.1, 4.0);
    // Not a number passes: of a state that has overflowed no shorter substep would make more.
    const bool accepted = !(error > 1);
    // What the step's end or an onset cut short says little about how long the next may be.
    const bool was_cut = h < next_substep_s_;
    if (accepted && was_cut) next_substep_s_ = std::max(next_substep_s_, h * factor);
    if (!(accepted && was_cut)) next_substep_s_ = h * factor;
    if (accepted) break;
    h = std::min(h, next_substep_s_);
    ++counts_.repeated;
  }
  ++counts_.substeps;
  std::swap(motion, end_);
  note(motion);
  return h;
}

double Stepper::substep(const Motion& from, double h, double touching_m) {
  const double stage = kStage * h;
  half_ = from;
  for (std::size_t body = 0; body < line_.size(); ++body) {
    half_.position_m[body] += stage * from.velocity_m_s[body];
    half_.velocity_m_s[body] += stage * (start_acceleration_[body] + line_.gravity_m_s2);
  }
  solve_.stage(line_, options_.spring, stage, half_);
  gather_accelerations(solve_.force(), half_acceleration_);
  end_ = from;
  for (std::size_t body = 0; body < line_.size(); ++body) {
    end_.position_m[body] += kOvershoot * (half_.position_m[body] - from.position_m[body]);
    end_.velocity_m_s[body] +=
        kOvershoot * (half_.velocity_m_s[body] - from.velocity_m_s[body]) + stage * line_.gravity_m_s2;
  }
  solve_.stage(line_, options_.spring, stage, end_);
  gather_accelerations(solve_.force(), end_acceleration_);
  return error_of_substep(from, h, touching_m);
}

/// In the energy norm of each contact that holds, over the largest motion of any of them: at most 1 passes. Filtered by each
/// contact's own share of the stage's matrix, as Hosea and Shampine advise: what the method damps is no error of it. Nor
/// is what the rounding of a gap does to its spring.
double Stepper::error_of_substep(const Motion& from, double h, double touching_m) const {
  const double stiffness_root = std::sqrt(options_.spring.stiffness_n_m);
  const double stage = kStage * h;
  double scale = 0;
  double error = 0;
  for (std::size_t contact = 0; contact <= line_.size(); ++contact) {
    const double open_m = gap(line_, from.position_m, contact);
    const double after_m = gap(line_, end_.position_m, contact);
    if (!(std::min(open_m, after_m) <= touching_m)) continue;
    const double mass_root = std::sqrt(line_.reduced_mass(contact));
    const double rate = gap_rate(line_, from.velocity_m_s, contact);
    const double rate_error =
        local_error(h, gap_rate(line_, start_acceleration_, contact), gap_rate(line_, half_acceleration_, contact),
                    gap_rate(line_, end_acceleration_, contact));
    const double depth_error =
        local_error(h, rate, gap_rate(line_, half_.velocity_m_s, contact), gap_rate(line_, end_.velocity_m_s, contact));
    const double frequency = stiffness_root / mass_root;
    const double stiffness = stage * frequency * frequency;
    const double kept_rate = (rate_error - stiffness * depth_error) /
                             (1 + stage * (stiffness + 2 * options_.spring.damping_ratio * frequency));
    const double kept_depth = depth_error + stage * kept_rate;
    error = std::max(error, std::hypot(mass_root * kept_rate, stiffness_root * kept_depth));
    scale = std::max(scale, std::hypot(mass_root * rate, stiffness_root * std::max({-open_m, -after_m, 0.0})));
    // What falls in a step is the least that a resting contact could be asked to resolve.
    scale = std::max(scale, mass_root * std::abs(line_.gravity_m_s2) * step_s_);
  }
  const double allowed = options_.substep_error * scale + kUnseenGap * touching_m * stiffness_root;
  return allowed > 0 ? error / allowed : 0;
}

}  // namespace collided::response
