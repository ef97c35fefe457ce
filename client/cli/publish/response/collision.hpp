#pragma once

#include <Eigen/Core>

namespace collided::response {

using Vec3 = Eigen::Vector3d;

/// The homework's response to a contact: both velocities are reversed. Energies stay the same to the last bit; momentum
/// does not. Pure, like everything in this file.
void flip(Vec3& velocity_a, Vec3& velocity_b);

/// The inverse masses of two bodies, in 1/kg; that of a wall is 0. Not both may be 0.
struct InverseMasses {
  double a = 0;
  double b = 0;
  double sum() const { return a + b; }
};

/// The impulse, in N s along the line of impact, after which two bodies part at `restitution` times the speed of
/// approach.
///
/// approach_m_s   how fast the gap closes; 0 or less means that they part, and the impulse is 0
/// restitution    from 0 (they stay together) to 1 (no energy is lost)
/// source         Newton, Principia, 1687, corollary 6 to the laws; Kane, Levinson, "Dynamics", 1985, 5.8
double impact_impulse(double approach_m_s, InverseMasses masses, double restitution);

/// Applies that impulse to two bodies without friction. Momentum stays the same except for rounding, and with
/// restitution 1 so does energy.
///
/// normal   unit vector from a to b
/// returns  whether they approached each other
bool restitute(Vec3& velocity_a, Vec3& velocity_b, InverseMasses masses, const Vec3& normal, double restitution);

/// Reflects a point between two walls at -most and most, after a step that may have crossed the interval many times.
///
/// position_m     in: after a step without walls; out: within the walls
/// velocity_m_s   reversed once for each wall met, and each time multiplied by the restitution
/// returns        whether a wall was met
/// cost           with restitution 1 two reflections, since whole periods are dropped at once; else one for each
///                crossing, which are few since speed is lost, and at most kMostBounces
bool mirror_between_walls(double& position_m, double& velocity_m_s, double most_m, double restitution);

}  // namespace collided::response
