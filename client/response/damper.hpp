#pragma once

#include <limits>

namespace collided::response {

/// A linear spring with a damper beside it that pushes and never pulls. The damping ratio is of each contact's own
/// oscillator, d / (2 sqrt(k m)) with the reduced mass m, so that restitution does not depend on the masses.
struct Spring {
  double stiffness_n_m = 1e6;
  double damping_ratio = 0;  // 0: nothing lost

  double damping(double reduced_mass_kg) const;    // N s/m
  double frequency(double reduced_mass_kg) const;  // rad/s, undamped
};

/// How fast two bodies part after such a contact, over how fast they met; without a load.
/// error      1e-15
/// source     Schwager, Poeschel, "Coefficient of restitution and linear-dashpot model revisited", Granular Matter 9, 2007
double restitution_of_damping(double damping_ratio);

/// The damping ratio that gives a restitution, kLeastDampedRestitution to 1: by bisection, the function falls throughout.
/// Throws std::invalid_argument outside.
double damping_of_restitution(double restitution);

/// One contact of the linear spring, solved: m y" + d y' + k y = load, y the depth, until the force would pull.
/// source     any text on the damped oscillator; Magnus, Popp, "Schwingungen", 2.1
class ContactPhase {
 public:
  /// approach_m_s  at the start: at least 0 where that is the onset
  /// load_n        pushes the two together (weight), or apart where negative
  /// depth_m       at the start: 0 at the onset; else the two have been in contact, and the spring pushes
  ContactPhase(const Spring& spring, double reduced_mass_kg, double approach_m_s, double load_n, double depth_m = 0);

  double depth(double seconds) const;
  double depth_rate(double seconds) const;
  /// Until the spring lets go; infinite where the load keeps them together. Undamped in closed form, else by bisection
  /// between the force's largest and least value, which are in closed form.
  double duration() const { return duration_s_; }
  /// Deepest from the start on; of an endless contact, too.
  double deepest() const;

 private:
  double force_over_mass(double seconds) const;
  double find_end() const;

  double decay_ = 0;  // 1/s
  double turn_ = 0;   // rad/s, damped; of an overdamped contact the rate of its hyperbolic functions
  bool oscillates_ = true;
  double start_m_ = 0;
  double approach_m_s_ = 0;
  double rest_ = 0;    // depth at which the spring bears the load
  double cosine_ = 0;  // y = rest + e^(-decay t) (cosine cos turn t + sine sin turn t); cosh and sinh where overdamped
  double sine_ = 0;
  double frequency_ = 0;
  double duration_s_ = std::numeric_limits<double>::infinity();
};

}  // namespace collided::response
