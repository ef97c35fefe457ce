#pragma once

#include <cstdint>
#include <string_view>

#include "client/cli/publish/response/damper.hpp"
#include "tests/studies/response/contact_solve.hpp"
#include "tests/studies/response/episodes.hpp"
#include "tests/studies/response/line.hpp"

namespace collided::response {

/// How a step of a line is made. All but `impulse` have springs in their contacts.
enum class Method {
  explicit_euler,       // blows up at any k dt^2 / m in the end: each step multiplies the energy by 1 + k dt^2 / m
  semi_implicit_euler,  // blows up from k dt^2 / m = 4 on, and gains or loses energy in a contact below
  implicit_euler,       // never gains energy; loses a bounce that it does not resolve
  compliant,  // of those that step the one to use: onset found, contact resolved by an L-stable method that checks its own error
  impulse,  // rigid: restitution for what touches at the start of a step
};

std::string_view name(Method method);

struct StepCounts {
  std::uint64_t substeps = 0;
  std::uint64_t repeated = 0;     // substeps made again, smaller
  std::uint64_t surrendered = 0;  // steps whose rest went by implicit Euler: out of substeps
  double deepest_m = 0;           // largest overlap at the end of any substep
};

struct StepperOptions {
  Method method = Method::compliant;
  Spring spring = {};
  double restitution = 1;    // of impulses; springs have theirs from their damper
  double substep_error = 0;  // of the compliant method; 0 means kSubstepError
};

/// Moves a line on, step by step.
/// One thread. No allocation after the first step of a line.
///
/// The compliant method flies in closed form to the onset of a contact, wherever in the step that is, and then makes
/// substeps of TR-BDF2, whose stages ContactSolve answers for any stiffness. Each substep's own error estimate says how long the
/// next may be: a bounce is resolved, however short; a body at rest takes whole steps, since there the L-stable method
/// damps what it does not resolve. Without that control TR-BDF2 is not safe here: its first half is explicit in the old
/// force, and a body deep in a stiff spring that leaves within the substep would keep a speed of h k depth / m where it has
/// earned sqrt(k / m) depth.
/// source   Bank et al., "Transient simulation of silicon devices and circuits", IEEE Trans. CAD 4, 1985; Hosea, Shampine,
///          "Analysis and implementation of TR-BDF2", Appl. Numer. Math. 20, 1996 (error estimate)
class Stepper {
 public:
  Stepper() = default;
  Stepper(const Line& line, const StepperOptions& options) { use(line, options); }
  /// Another line from here on, and counts from 0; no allocation where it has no more bodies.
  void use(const Line& line, const StepperOptions& options);

  const Line& line() const { return line_; }
  /// seconds at least 0; 0 changes nothing, to the last bit.
  void step(Motion& motion, double seconds);
  const StepCounts& counts() const { return counts_; }
  /// Contacts seen at the end of any substep: the compliant method sees those that begin and end inside a step.
  const Episodes& episodes() const { return episodes_; }
  /// Kinetic, of gravity, and in the springs.
  double energy(const Motion& motion) const;

 private:
  void step_explicitly(Motion& motion, double seconds, bool positions_last);
  void step_implicitly(Motion& motion, double seconds);
  void step_by_impulses(Motion& motion, double seconds);
  void step_compliantly(Motion& motion, double seconds);

  bool any_holds(const Motion& motion, double touching_m) const;
  double time_to_onset(const Motion& motion, double touching_m) const;
  double advance_in_contact(Motion& motion, double most_s, double touching_m);
  double substep(const Motion& from, double h, double touching_m);
  double error_of_substep(const Motion& from, double h, double touching_m) const;
  void note(const Motion& motion);
  void gather_accelerations(const std::vector<double>& force, std::vector<double>& acceleration) const;

  Line line_;
  StepperOptions options_;
  ContactSolve solve_;
  StepCounts counts_;
  Episodes episodes_;
  double highest_frequency_ = 0;  // of any contact, rad/s
  double next_substep_s_ = 0;
  double step_s_ = 0;
  Motion half_, end_;  // of the substep being tried
  std::vector<double> force_, start_acceleration_, half_acceleration_, end_acceleration_;
  std::vector<char> touching_;
};

/// Impulses for the contacts marked in `touching` until none approaches: pair by pair in order, each with restitution;
/// impacts slower than resting_speed, and what kMostRounds leave, stop together. Returns how many pairs bounced.
/// Always: momentum between walls stays but for rounding, and energy never grows.
std::uint64_t resolve_impacts(const Line& line, const std::vector<char>& touching, double restitution,
                              double resting_speed_m_s, std::vector<double>& velocity_m_s, ContactSolve& solve);

}  // namespace collided::response
