#pragma once

#include "client/response/collision.hpp"
#include "client/response/damper.hpp"

namespace collided::response {

/// Where one body's centre is from another's, and how fast that changes.
struct RelativeMotion {
  Vec3 place_m;
  Vec3 velocity_m_s;
};

/// What a spring did in a time.
struct SpringRun {
  bool began = false;   // a contact began in it
  bool pushed = false;  // it pushed at some time
  double depth_m = 0;   // at the end, where it still pushes
  double deepest_m = 0;
  double free_s = 0;  // at the end: for how long it has not pushed
};

/// Moves two bodies on that a spring along their line of centres keeps `length_m` apart: flight to the touch, the contact, and
/// flight away from where the spring lets go.
///
/// A contact is not stepped through: along the line of centres it is the closed form of the damped spring, under a load that is
/// what the turning of that line adds (centrifugal), constant for as long as the line takes to turn by kMostTurn, and with the work
/// of the true one. So the cost does not depend on the stiffness, nor the depth on how `seconds` are cut. Momentum, angular
/// momentum and, undamped, energy stay but for rounding.
/// source   the constant load is Gonzalez' discrete gradient, "Time integration and discrete Hamiltonian systems", J. Nonlinear
///          Sci. 6, 1996; the stiff part exactly: Hochbruck, Ostermann, "Exponential integrators", Acta Numerica 19, 2010
SpringRun move_on_spring(const Spring& spring, double reduced_mass_kg, double length_m, RelativeMotion& motion,
                         double seconds);

/// Moves a body on between springs that begin at -most and most: flights and contacts in closed form, in turn.
/// cost     a closed form a contact, at most kMostBounces of them; what then is left of the time is not moved
SpringRun move_between_springs(const Spring& spring, double mass_kg, double most_m, double& position_m,
                               double& velocity_m_s, double seconds);

}  // namespace collided::response
