#pragma once

#include <string_view>

#include "client/cli/publish/response/spring_contact.hpp"

namespace collided::response {

/// Two bodies with an undamped spring of `length_m` between them that only pushes.
struct SpringPair {
  double stiffness_n_m = 1e6;
  double reduced_mass_kg = 1;
  double length_m = 1;

  Vec3 acceleration(const Vec3& place_m) const;
  /// Kinetic and in the spring, of the relative motion.
  double energy(const RelativeMotion& motion) const;
};

/// One step of the whole motion, contact or not.
using Integrator = void (*)(const SpringPair& pair, RelativeMotion& motion, double seconds);

/// Gains energy at any step; a touch inside a step is felt from its end, as by the next two.
void explicit_euler(const SpringPair& pair, RelativeMotion& motion, double seconds);
/// Of second order, and stable below k dt^2 / m = 4.
/// source   Verlet, "Computer experiments on classical fluids", Phys. Rev. 159, 1967
void velocity_verlet(const SpringPair& pair, RelativeMotion& motion, double seconds);
/// By Newton's method on the place at the end. Stable at any stiffness, and loses what it does not resolve.
void implicit_euler(const SpringPair& pair, RelativeMotion& motion, double seconds);
/// The publisher's: client/cli/publish/response/spring_contact.hpp.
void closed_form(const SpringPair& pair, RelativeMotion& motion, double seconds);

struct NamedIntegrator {
  std::string_view name;
  Integrator step;
};
inline constexpr NamedIntegrator kIntegrators[]{{"explicit_euler", explicit_euler},
                                                {"velocity_verlet", velocity_verlet},
                                                {"implicit_euler", implicit_euler},
                                                {"closed_form", closed_form}};

/// Where the motion really is after that time, in long double: flights exactly, the contact by the classical Runge-Kutta
/// method of fourth order in twenty thousand steps, its end by bisection of the step.
RelativeMotion true_motion(const SpringPair& pair, const RelativeMotion& start, double seconds);

}  // namespace collided::response
