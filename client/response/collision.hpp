#pragma once

#include <Eigen/Core>

namespace collided::response {

using Vec3 = Eigen::Vector3d;

/// The homework's answer to two objects that touch: each turns round. Energies stay to the last bit, momentum does not.
void flip(Vec3& velocity_a, Vec3& velocity_b);

/// Masses as their inverses, so that a wall is a body of inverse mass 0. Not both 0.
struct InverseMasses {
  double a = 0;
  double b = 0;
  double sum() const { return a + b; }
};

/// Impulse (N s) along the line of impact that takes an approach to restitution times its speed the other way.
/// approach_m_s   how fast the gap closes; 0 or less: they part, and the impulse is 0
/// restitution    0 (they go on together) to 1 (no energy is lost)
/// source         Newton, Principia, 1687, corollary 6 to the laws; Kane, Levinson, "Dynamics", 1985, 5.8
double impact_impulse(double approach_m_s, InverseMasses masses, double restitution);

/// The same between two bodies without friction; `normal` is a unit vector from a to b.
/// Always: momentum as before but for rounding, and so energy where restitution is 1. True if they approached.
bool restitute(Vec3& velocity_a, Vec3& velocity_b, InverseMasses masses, const Vec3& normal, double restitution);

/// A point between two walls at -most and most, after a step that may have crossed the interval many times.
/// position_m     after a step without walls; comes back within the walls
/// velocity_m_s   comes back turned once for each wall met, restitution times as fast each time
/// returns        whether a wall was met
/// cost           two turns where restitution is 1, since whole periods go at once; else a turn for each crossing, of
///                which a loss leaves few, and at most kMostBounces
bool mirror_between_walls(double& position_m, double& velocity_m_s, double most_m, double restitution);

}  // namespace collided::response
