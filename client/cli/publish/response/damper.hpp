#pragma once

#include <limits>

namespace collided::response {

/// A contact force: a linear spring with a parallel damper that pushes and never pulls. The damping ratio is
/// d / (2 sqrt(k m)) with the reduced mass m of each contact, so that the restitution does not depend on the masses.
struct Spring {
  double stiffness_n_m = 1e6;
  double damping_ratio = 0;  // 0: no energy is lost

  double damping(double reduced_mass_kg) const;    // N s/m
  double frequency(double reduced_mass_kg) const;  // rad/s, undamped
};

/// The restitution of such a contact without a load: the speed at which the bodies part divided by that of approach.
///
/// error      1e-15
/// source     Schwager, Poeschel, "Coefficient of restitution and linear-dashpot model revisited", Granular Matter 9,
///            2007
double restitution_of_damping(double damping_ratio);

/// The inverse: the damping ratio for a restitution from kLeastDampedRestitution to 1, by bisection. Throws
/// std::invalid_argument for other values.
double damping_of_restitution(double restitution);

/// One contact of the spring in closed form: the solution of m y" + d y' + k y = load for the depth y, until the force
/// would pull. Immutable.
/// source     any text on the damped oscillator; Magnus, Popp, "Schwingungen", 2.1
class ContactPhase {
 public:
  /// approach_m_s  at the start; 0 or more if the contact begins there
  /// load_n        pushes the two together (a weight); negative: apart
  /// depth_m       at the start; 0 if the contact begins there, else the spring already pushes
  ContactPhase(const Spring& spring, double reduced_mass_kg, double approach_m_s, double load_n, double depth_m = 0);

  double depth(double seconds) const;
  double depth_rate(double seconds) const;
  /// Time until the spring releases; infinite if the load keeps the two together. In closed form without damping, else
  /// by bisection between the times of the largest and the least force, which are in closed form.
  double duration() const { return duration_s_; }
  /// The largest depth from the start on, also of an endless contact.
  double deepest() const;

 private:
  double force_over_mass(double seconds) const;
  double find_end() const;

  double decay_ = 0;  // 1/s
  double turn_ = 0;   // rad/s, with damping; for an overdamped contact the rate of the hyperbolic functions
  bool oscillates_ = true;
  double start_m_ = 0;
  double approach_m_s_ = 0;
  double rest_ = 0;    // depth at which the spring balances the load
  double cosine_ = 0;  // y = rest + e^(-decay t) (cosine cos turn t + sine sin turn t); cosh and sinh if overdamped
  double sine_ = 0;
  double frequency_ = 0;
  double duration_s_ = std::numeric_limits<double>::infinity();
};

}  // namespace collided::response
