#pragma once

#include <span>
#include <vector>

#include "client/draw/drawing/sight.hpp"

namespace collided::draw {

/// A place where two segments cross in the picture, one behind the other.
struct LineCrossing {
  std::uint32_t nearer = 0;
  std::uint32_t farther = 0;
  double at = 0;  // fraction of the farther one's image
};

/// All crossings, except of segments that meet in space, share an end or belong to one line.
/// cost  a sweep along x: n log n, and the pairs whose extents overlap
std::vector<LineCrossing> crossings(std::span<const LineSegment> segments, bool is_orthographic);

/// The segments without the parts that are behind another one and within halo_px of its image.
/// source  Appel, Rohlf, Stein, "The Haloed Line Effect for Hidden Line Elimination", 1979
std::vector<Piece> haloed_pieces(std::span<const LineSegment> segments, std::span<const LineCrossing> crossings,
                                 double halo_px);

}  // namespace collided::draw
