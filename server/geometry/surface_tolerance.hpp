#pragma once

#include "server/geometry/tolerance.hpp"

namespace collided::engine {

// Tolerances of surfaces given as triangles: how far they are from the true surface, and from each other.

/// Roundings of a vertex of a curved surface, relative to the surface's reach: a product of three numbers that are off
/// by two units of roundoff each takes 9, a point of a spline 2 per degree and parameter, so 32 at the highest degree
/// of 8, on each of three axes: 56 as a length. The rest up to 128 covers the surface's own parameters. No unit.
/// At zero, IntakeTessellate.AFlatPatchIsOffByRoundingsAlone fails.
inline constexpr double kVertexRounding = 128 * kRoundoff;

/// A triangle that a surface may cover is shrunk by this share of its size, so that an edge of the surface along its
/// rim does not run over it; points in the rim are farther from the surface by at most that much. Far above kFlatSlack,
/// far below relevant distances. No unit.
/// At zero, WorldSurfaceCover.AnEqualSheetWhoseBorderIsTheTablesCoversIt fails.
inline constexpr double kRim = 0x1p-20;

/// Relative to the table's size plus the farthest coordinate in its frame: a point rotated into that frame is off by 16
/// roundings of its largest coordinate there (differences 1, unit axes 6, products and sums 3, three of each), a
/// clipped height by as much again. 2^13 roundings, because a larger value costs nothing. No unit.
/// At zero, WorldSurfaceCover.AnEqualSheetWhoseBorderIsTheTablesCoversIt fails, because a rounding decides what is
/// uncertain, and so does TheBoundHoldsUnderASheetOfAMillionMillionTimesItsSize.
inline constexpr double kFlatSlack = 0x1p-40;

}  // namespace collided::engine
