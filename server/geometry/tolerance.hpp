#pragma once

namespace collided::engine {

// Every tolerance of the engine, with its unit, what it absorbs, its derivation, and the test that fails without it.

/// Half the distance from 1 to the next double: the relative error of one rounding. No unit.
inline constexpr double kRoundoff = 0x1p-53;

/// Relative slack on a running error bound: the bound itself is computed in double, and each of its operations may
/// round down by kRoundoff. 2^-40 covers 2^13 roundings in a row; the longest chain here has fewer than 2^10.
/// At zero, ExactBounded.TheBoundHoldsForLongChains fails.
inline constexpr double kBoundSlack = 0x1p-40;

/// For a bound that passes few operations: 2^-48 covers 31 roundings in a row, 2^-50 seven. No unit.
inline constexpr double kChainSlack = 0x1p-48;
inline constexpr double kFewSlack = 0x1p-50;

/// Magnitudes between these may be multiplied by one more magnitude of a usual scene without leaving the range of
/// double; beyond them the exact test takes over. Any unit. It chooses the test and affects no decision.
inline constexpr double kSmallestPlain = 0x1p-900;
inline constexpr double kLargestPlain = 0x1p900;

/// A product of a magnitude between these has an error term that is a double: fma(a, b, -ab) is exact. Any unit.
inline constexpr double kSmallestExactProduct = 0x1p-960;
inline constexpr double kLargestExactProduct = 0x1p990;

/// Absolute error of one product whose result or error underflows (at most 2^-1074 each); a normal number, because
/// denormal operands are slow. Unit: that of the product.
/// At zero, ExactBounded.UnderflowIsNeverSure fails.
inline constexpr double kUnderflow = 0x1p-1000;

/// Error of the triple product e . (p x d) in double, relative to |e| |p| |d|: seven roundings on each of six products
/// (two differences, two products, three sums), and the six sum to at most sqrt(2) |e| |p| |d| (Cauchy-Schwarz twice).
/// Proved by machine in tests/proofs, as are kBoundSlack, kPointOnRay, kPointSum, kSeparationError and kTurnError.
/// 7 sqrt(2) = 9.9; the rest up to 11 absorbs the roundings of the norms. No unit.
/// At 1, ExactRayTriangle.EveryOrderOfCornersAgreesAtTheFilterBoundary fails.
inline constexpr double kTripleProductError = 11 * kRoundoff;

/// From this squared length on, nothing underflows in the triple-product filter: the square of its bound, a product of
/// six lengths and 2^-99, stays above 2^-1000. Below, the bound would round to zero and any sign would seem certain.
/// Square metres. At zero, ExactRayTriangle.HardCasesKeepTheirAnswersAtEveryScale fails.
inline constexpr double kFilterLowest2 = 0x1p-300;

/// Relative error above which a distance is computed again exactly. A smaller value buys digits with microseconds.
/// Without it ExactClosest.RelativeErrorStaysSmallAtTheSurface fails.
inline constexpr double kRefineDistance = 0x1p-42;

/// As above for the distance along a ray, where grazing hits are common: 1.2e-10, 0.12 micrometre at one kilometre.
/// Without it ExtremeRayGrazing.DistanceStaysSharp fails.
inline constexpr double kRefineRay = 0x1p-33;

/// Error of a nearest direction, relative to its length, above which it is computed again exactly: moving by the depth
/// d along a normal that is off by e leaves an overlap of d e^2 / 2, far below the depth's own bound. No unit.
/// Without it ExactContactOracle.SphereCapsule fails (a centre a rounding away from the axis).
inline constexpr double kRefineDirection = 0x1p-36;

/// Error of a point reported on a ray, relative to its distance, beyond that of the distance itself: the unit direction
/// is off by 3.5 u in each coordinate (three roundings of the squared norm halve under the root to 1.5, the root and
/// the quotient one each), its product with the distance by 1 u, and 1.5 u is left for the second-order terms and the
/// roundings of the bound. No unit. At zero, AccuracyBounds.RaySphere fails.
inline constexpr double kPointOnRay = 6 * kRoundoff;

/// Error of the last sum of a reported point, relative to its largest coordinate: u a coordinate, so sqrt(3) u as a
/// length; 2 covers the roundings of the bound. No unit. At zero, AccuracyBounds.RayTriangle fails.
inline constexpr double kPointSum = 2 * kRoundoff;

/// Error of a unit vector made from a correctly rounded vector: as in kPointOnRay without the product, 3.5 u per
/// coordinate, with four more for a rounded exact number; as a length. No unit.
/// At zero, AccuracyBounds.ClosestSphere fails.
inline constexpr double kUnitVector = 14 * kRoundoff;

/// Error of a witness point, relative to the largest coordinate of the sets: a + u d with u in [0, 1] on an edge whose
/// ends took four roundings each, or the foot on a face (two quotients and two sums on each coordinate). No unit.
/// At zero, ExactContactOracle.CapsuleCapsule fails.
inline constexpr double kWitnessError = 32 * kRoundoff;

/// Error of a support point of the difference of two convex sets: an upper bound on its distance from that set,
/// relative to the sum of their reaches and of the distance between their first carriers. A box's corner takes three
/// products and sums (6 u of its reach); the direction of an ellipsoid or a disc is a unit vector to 4 u and is then
/// used like a box's (10 u); a disc's plane is off by the axis' own unit vector (4 u of the radius); three sums join
/// the two sets (3 u). 32 covers all of it, and convex combinations of such points. No unit.
/// At zero, ExactConvex.BracketsHoldTheTruth fails.
inline constexpr double kSupportError = 32 * kRoundoff;

/// How much farther along n than its computed support point a convex set may reach, relative to |n| and to the sum of
/// its reach, its distance from the other set and its largest coordinate: the point itself is off by kSupportError, the
/// product with n takes three roundings, and a hull's vertex is chosen in the hull's own frame, where rotating n and
/// rounding the placed vertices make up to 12 u of difference. No unit. At zero, ExactConvex.AgreesWithClosedForms
/// fails.
inline constexpr double kSupportValueError = 64 * kRoundoff;

/// A disc seen almost along its axis is replaced by its centre: the resulting error, relative to its radius. No unit.
/// At zero, where rounding chooses the direction across, ExactGeneralNearest.BallsOfTheTwoBoundsMissAndMeet fails.
inline constexpr double kDiscSeenFlat = 0x1p-23;

/// As above in 256 bits, for the square of the share of the direction across the axis. At zero, where the rest of the
/// direction is rounding, ExtremeGivenRound.APairIsDecidedForTheShapesAndPosesGiven fails.
inline constexpr double kDiscSeenFlatInLong = 0x1p-240;

/// Two sets with round sides that overlap, or leave a gap, by less than this share of their size are left undecided if
/// no algebra decides: 1e-30 m for sets of a metre.
inline constexpr double kFinestGap = 1e-30;

/// How far a point found in 256 bits is moved towards the middle of a set on whose border it may lie, as a share of the
/// distance. At zero, ExtremeGivenRound.APairIsDecidedForTheShapesAndPosesGiven fails.
inline constexpr double kInward = 0x1p-180;

/// A point counts as in front of a face of the polytope that grows inside a difference set only if it is farther than
/// this, relative to the sets' size: a flat side of several faces is then visible as a whole or not at all. Shapes the
/// search only; the depth found has its own bound. No unit. At zero,
/// ExactGeneral.PairsAgreeWithPolytopesAndDepthsPartThem fails.
inline constexpr double kSeenFrom = 0x1p-34;

/// Slack of the half-spaces that clip for a point of both sets, relative to their extent: 64 roundings, so that the
/// only common point of two touching sets is not lost. It places a contact point and affects no decision. No unit.
/// At zero, ExactContact.ThePointOfTouchingBoxesIsOnBoth fails.
inline constexpr double kClipSlack = 0x1p-46;

/// Error of one gap of the separating-axis test in plain double, relative to A B (D + A H): axes of at most A, the axis
/// or edge they are crossed with of at most B, corners and centres at most D apart, half sizes with sum H, all by
/// largest coordinate. A cross product of two rounded differences is off by 8 u A B per coordinate, its dot product
/// with a third vector X by 40 u A B X, and the reach (each of at most six terms 46 u A^2 B h, their sums 30 u A^2 B H
/// more) by 76 u A^2 B H; the last subtraction adds 12 u. 96 covers all with the roundings of the bound. No unit.
/// At a half, ExtremeSeparationFilter.AgreesWithRationalsAtTheFilterBoundary fails.
inline constexpr double kSeparationError = 96 * kRoundoff;

/// Error of a squared distance to a triangle, and of a corner's product with the vector v to its nearest point,
/// relative to the sum W^2 of the squared distances to the corners. v = a + s ab + t ac rounds each of a, ab, ac once
/// (u W, s 2 u W, t 2 u W), two products (s + t <= 1: 2 u W) and two sums (6 u W); s + t <= 1 + 4 u leaves the triangle
/// by 8 u W: 21 u W in all, so 42 u W^2 in the square, and 4 u W^2 for rounding the square. A product with v
/// (difference, product, two sums) is off by 4 u W^2. 48 covers all with the roundings of the bound. No unit.
/// At zero, ExtremeNearestFilter.TheBracketHoldsTheTruth fails.
inline constexpr double kNearestError = 48 * kRoundoff;

/// Error of the triple product a . (b x c) of three differences, relative to the product of their largest coordinates:
/// each of six products passes eight roundings (three differences, two products, the cross product's difference, two
/// sums), 48 u together; 52 covers the roundings of the bound. Proved in tests/proofs. No unit.
/// At a sixty-fourth, where random triangles come near it, ExtremeTriangleFilter.AgreesWithRationalsAtTheFilterBoundary
/// fails.
inline constexpr double kOrientationError = 52 * kRoundoff;

/// How far a point placed at a frame of a body's motion is from the exact motion, relative to the sum of the position's
/// largest coordinates at both ends and of the point's distance from the frame's origin: the position takes two
/// products and a sum (4 u), a rotation from axis and angle 12 u per entry, its product with the first rotation 6 u, so
/// 32 u of the distance over three coordinates, and placing 6 u; the ends themselves are off by as much. No unit.
/// At zero, ExactBodyMotion.WhatIsFreeMeetsNothingAtAnyFrameOfTheWay fails.
inline constexpr double kWayError = 96 * kRoundoff;

/// How far |q|^2, computed, is from 1 for a quaternion that has been divided by its norm: then it is not divided again.
/// No unit. At 1, GeometryPlacingError.NoPlacedPointIsFartherOff fails.
inline constexpr double kUnitSquareSlack = 8 * kRoundoff;

/// How far a point is from where the given quaternion rotates it, relative to its distance from the frame's origin,
/// before the position is added: dividing the quaternion by its norm rotates by 2 u, and leaves |q|^2 within 8 u of 1,
/// which the matrix of a unit quaternion contains twice (16 u); an entry of it is off by 5 u on the diagonal and 2 u
/// beside it (10 u as a whole), a row's product with the point by 3 u each (6 u). No unit.
/// At zero, GeometryPlacingError.NoPlacedPointIsFartherOff fails.
inline constexpr double kTurnedPoint = 40 * kRoundoff;

/// Bound on the rounding of the plain 2-D orientation determinant, relative to the sum of its two products: Shewchuk's
/// ccwerrboundA, (3 + 16 u) u. No unit. At zero, IntakePlanar.NearlyStraightTurnsAreExact fails.
inline constexpr double kTurnError = (3 + 16 * kRoundoff) * kRoundoff;

/// Largest | |q| - 1 | that validation accepts for a rotation written with seven digits or more; beyond it the four
/// numbers are not a rotation. No unit. At zero, IntakeSceneFile.AQuaternionOfSevenDigitsIsTaken fails.
inline constexpr double kUnitNormSlack = 1e-6;

/// | |q|^2 - 1 | up to which a quaternion is left unchanged. Dividing by the norm leaves four roundings in each number
/// (three of the norm, the quotient), so eight in the square, and four of summing it. No unit.
/// At zero, IntakeSceneFile.ComesBackBitForBit fails.
inline constexpr double kNormalizedSlack = 16 * kRoundoff;

/// Distance between neighbouring single-precision numbers from which on a scene's digits are reported as lost: the
/// resolution of a survey in millimetres. Metres. At zero, IntakeSinglePrecision.NearCoordinatesGiveNoWarning fails.
inline constexpr double kCoarseGrid_m = 1e-3;

/// How far a T-vertex may lie from its edge, in roundings of the largest coordinate: those of double, or of single
/// precision if the file has nothing else. The vertex and both ends are rounded on three axes, at most 3 sqrt(3) / 2
/// together; the rest up to 8 covers computing the distance. No unit.
/// At zero, IntakeSeams.TVerticesOfSinglePrecisionAreFound fails.
inline constexpr double kOnEdge = 8;

/// Default width of the cracks to look for, relative to the diagonal of the mesh: what two tessellations of one curve
/// with some hundred points each leave between them. No unit.
/// At zero, IntakeSeams.CracksAreFoundAtTheWidthThatIsStated fails.
inline constexpr double kCrackReach = 1e-4;

/// How far another point or edge may lie from a point to count as the same one, as a share of the shortest edge there:
/// points farther away are detail of the mesh, not a crack. No unit.
/// At 2, IntakeSeams.FineDetailIsNoCrack fails.
inline constexpr double kCrackShare = 0.25;

/// Error of the plain tests of balls and capsules against each other and against boxes, relative to the largest square
/// involved. Differences, products and sums are some twenty roundings of 2^-53 each; the position of the nearest point
/// along a segment is off by as much, which counts squared. A thousand times that, because it costs only one candidate
/// in 2^40. No unit.
/// At zero, BallFilter.NeverPartsWhatMeets fails.
inline constexpr double kBallsApartSlack = 0x1p-40;

}  // namespace collided::engine
