#pragma once

#include <vector>

#include "server/exact_phase/solid/solid_tree.hpp"

namespace collided::engine {

/// A number known to lie in [low, high]; equal if it is exactly known and a double.
struct ParameterBracket {
  double low = 0;
  double high = 0;
};

/// A part of the segment from a to b, as fractions from 0 at a to 1 at b. The border between a part that is in and one
/// that is out is on the surface. A part of length 0 that is `on` is a point at which the segment touches the surface.
struct SegmentPart {
  SolidSide side = SolidSide::out;
  ParameterBracket from;
  ParameterBracket to;
};

/// Which parts of a segment lie in a solid, on its surface and outside, in order and without gaps; neighbours differ.
/// Sides and order are exact; the ends are the crossings of the segment with planes of the mesh, rounded outward.
///
/// a, b   finite, in the mesh's frame; may be equal, which gives one part
/// cost   some 30 us for a segment through a stone of 1,280 triangles, 65 us for one of 20,480; allocates
std::vector<SegmentPart> segment_parts(const SolidTree& tree, const Vec3& a, const Vec3& b);

}  // namespace collided::engine
