#pragma once

namespace collided::response {

/// How often a body turns at walls in one step; what then is left of the step is not moved.
/// Without it, ResponseSpringContact.AStepOfAMillionMillionBouncesEnds does not.
inline constexpr int kMostBounces = 1'000;

/// How far, in radians, the line of centres of two bodies may turn, and in shares of itself their distance may change, while what
/// the turning adds to the spring's load counts as constant. The error of the way goes with the square.
/// At 1, ResponseSpringContact.AnObliqueContactKeepsItsEnergy fails.
inline constexpr double kMostTurn = 1.0 / 128;

/// How often that load is found anew from the distance that it leads to. Each time what is missing shrinks by the share of the
/// load's change in what the spring does, at most kMostTurn.
/// At zero, ResponseSpringContact.AnObliqueContactKeepsItsEnergy fails.
inline constexpr int kLoadRounds = 4;

/// Times a spring's length: nearer to each other than this two centres turn no faster. A spring that lets centres come so near
/// is too soft for its bodies.
/// At zero, ResponseSpringContact.CentresThatMeetComeToAnEnd does not end.
inline constexpr double kLeastDistance = 1e-3;

/// Least restitution that a damper can give: it takes damping_ratio 16, and goes to 0 only as 1 / (4 damping_ratio^2).
/// Without it, ResponseDamper.ARestitutionThatNoDamperGivesIsRefused fails.
inline constexpr double kLeastDampedRestitution = 1e-3;

}  // namespace collided::response
