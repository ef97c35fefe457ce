#pragma once

#include "server/geometry/tolerance.hpp"

namespace collided::engine {

// Tolerances of surfaces as triangles: how far they are off, and how far from each other.

/// Roundings of a vertex of a curved surface, relative to the surface's reach: a product of three numbers that are off by
/// two units of roundoff each takes 9, a point of a spline 2 a degree and parameter, so 32 at the highest degree of 8, on
/// each of three axes: 56 as a length. The rest up to 128 is for the surface's own parameters. No unit.
/// At zero, IntakeTessellate.AFlatPatchIsOffByRoundingsAlone fails.
inline constexpr double kVertexRounding = 128 * kRoundoff;

/// A triangle under a surface that may cover it is looked at smaller by this share of its size, so that an edge of the
/// surface along its rim does not run over it; what lies in the rim is that much farther from the surface at most. Far above
/// kFlatSlack, far below distances that matter. No unit.
/// At zero, WorldSurfaceCover.AnEqualSheetWhoseBorderIsTheTablesCoversIt fails.
inline constexpr double kRim = 0x1p-20;

/// Of the table's size and the farthest coordinate met in its frame: a point turned into that frame is off by 16 roundings
/// of its largest coordinate there (differences 1, unit axes 6, products and sums 3, three of each), a clipped height by as
/// much again. 2^13 roundings, since it costs nothing. No unit.
/// At zero, WorldSurfaceCover.AnEqualSheetWhoseBorderIsTheTablesCoversIt fails, a rounding decides what is open, and so does
/// TheBoundHoldsUnderASheetOfAMillionMillionTimesItsSize.
inline constexpr double kFlatSlack = 0x1p-40;

}  // namespace collided::engine
