#pragma once

#include "client/cli/publish/response/collision.hpp"
#include "client/cli/publish/response/damper.hpp"

namespace collided::response {

/// The position and velocity of one body's centre relative to another's.
struct RelativeMotion {
  Vec3 place_m;
  Vec3 velocity_m_s;
};

/// The effect of a spring during a time.
struct SpringRun {
  bool began = false;   // a contact began
  bool pushed = false;  // it pushed at some time
  double depth_m = 0;   // at the end, if it still pushes
  double deepest_m = 0;
  double free_s = 0;  // at the end: how long it has not pushed
};

/// Moves two bodies on for a time, with a spring of `length_m` along their line of centres: free flight until they
/// touch, the contact, and free flight after the spring lets go.
///
/// A contact takes no small time steps. Along the line of centres it is the closed form of the damped spring. Its load
/// is the centrifugal force from the turning of that line; it is constant while the line turns by kMostTurn, and does
/// the same work as the true one. So the cost does not depend on the stiffness, and the depth not on how a time is
/// divided. Momentum, angular momentum and, without damping, energy stay the same except for rounding.
/// source   the constant load is Gonzalez' discrete gradient, "Time integration and discrete Hamiltonian systems", J.
///          Nonlinear Sci. 6, 1996; the stiff part exactly: Hochbruck, Ostermann, "Exponential integrators", Acta
///          Numerica 19, 2010
SpringRun move_on_spring(const Spring& spring, double reduced_mass_kg, double length_m, RelativeMotion& motion,
                         double seconds);

/// Moves a body on between two springs that begin at -most and most: free flights and contacts in turn, in closed form.
/// cost     a closed form for each contact, at most kMostBounces; the body stays where it is for the rest of the time
SpringRun move_between_springs(const Spring& spring, double mass_kg, double most_m, double& position_m,
                               double& velocity_m_s, double seconds);

}  // namespace collided::response
