#pragma once

#include <limits>

namespace collided::response {

/// Relative, of the largest coordinate: gaps below it are touching. A gap is a difference of two rounded positions and of
/// the radii between them, each step of a flight rounds each position once more: 4 half ulps of the largest.
/// At zero, ResponseOnset.AHundredContactsInsideOneStep fails: onsets that an ulp keeps open are approached again and again.
inline constexpr double kTouching = 2 * std::numeric_limits<double>::epsilon();

/// Relative, of the largest coordinate: how far a pair must part before its contact ends, so that one which jitters by an
/// ulp to either side of touching begins once. It begins at half of this. Two positions that jitter by an ulp each move the
/// gap by two.
/// At zero, ResponseChatter.AnUlpToEitherSideBeginsOnce fails.
inline constexpr double kHysteresis = 4 * std::numeric_limits<double>::epsilon();

/// Times |gravity * step|: impacts slower than this stop without a bounce. A resting body gathers gravity * step between
/// two looks; with a bounce for that it would never lie still. Twice, since the impact before may have left as much.
/// At zero, ResponseResting.AStackUnderImpulsesLiesStill takes minutes: every step bounces until its rounds are out.
inline constexpr double kRestingSpeed = 2;

/// Relative local error a substep of the compliant method may make, in the energy norm of the contacts that hold.
/// A bounce takes about 2 / cbrt(kSubstepError) substeps; its speed comes out within 100 times this.
/// At 1e-2, ResponseStiffness.EveryBounceReturnsItsSpeed fails.
inline constexpr double kSubstepError = 1e-8;

/// Times the gap called touching: errors of a gap below it are its rounding. Each gap has 4 roundings and enters the estimate
/// in three states, with weights up to 2.
/// At zero, ResponseResting.AStackOfTheStiffestSpringsCostsFewSubsteps fails.
inline constexpr double kUnseenGap = 8;

/// Substeps a step may take; what is left of it then goes by one step of implicit Euler, which never gains energy, and
/// is counted.
/// Without it, ResponseStiffness.AStepOfADayEnds fails.
inline constexpr int kMostSubsteps = 200'000;

/// Rounds of impulses over the contacts that touch; what then still approaches stops without a bounce, together.
/// Without it, ResponseSimultaneous.AHeavyBallOnAStackEndsItsRounds fails.
inline constexpr int kMostRounds = 1'000;

}  // namespace collided::response
