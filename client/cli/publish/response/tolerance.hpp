#pragma once

namespace collided::response {

/// How often a body bounces off walls in one step; for the rest of the step it stays where it is.
/// Without it, ResponseSpringContact.AStepOfAMillionMillionBouncesEnds does not end.
inline constexpr int kMostBounces = 1'000;

/// How far the line of centres of two bodies may turn (in radians), and their distance change (as a fraction of it),
/// while the centrifugal load on the spring counts as constant. The error of the path grows with the square of this.
/// At 1, ResponseSpringContact.AnObliqueContactKeepsItsEnergy fails.
inline constexpr double kMostTurn = 1.0 / 128;

/// How often that load is corrected from the distance that it leads to. Each round multiplies the error by the ratio of
/// the load's change to the spring's force, which is at most kMostTurn.
/// At zero, ResponseSpringContact.AnObliqueContactKeepsItsEnergy fails.
inline constexpr int kLoadRounds = 4;

/// As a fraction of a spring's length: at distances below this the line of centres turns no faster. A spring that lets
/// centres come so near is too soft for its bodies.
/// At zero, ResponseSpringContact.CentresThatMeetComeToAnEnd does not end.
inline constexpr double kLeastDistance = 1e-3;

/// The least restitution that a damper is used for. It takes a damping ratio of 16; restitution falls only as
/// 1 / (4 damping_ratio^2).
/// Without it, ResponseDamper.ARestitutionThatNoDamperGivesIsRefused fails.
inline constexpr double kLeastDampedRestitution = 1e-3;

}  // namespace collided::response
