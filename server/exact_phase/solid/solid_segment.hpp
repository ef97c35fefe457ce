#pragma once

#include <vector>

#include "server/exact_phase/solid/solid_tree.hpp"

namespace collided::engine {

/// A number known to lie in [low, high]; equal where it is a double that is known.
struct ParameterBracket {
  double low = 0;
  double high = 0;
};

/// A part of the way from a to b, as shares of it: from 0 at a to 1 at b. The border between a part that is in and one
/// that is out is on the surface. A part that is `on` and begins where it ends is a point at which the segment touches it.
struct SegmentPart {
  SolidSide side = SolidSide::out;
  ParameterBracket from;
  ParameterBracket to;
};

/// Which parts of a segment lie in a solid, on its surface and outside, in order and without gaps; neighbours differ. Sides
/// and order are exact; the ends are where the segment crosses planes of the mesh, rounded outward.
///
/// a, b   finite, in the mesh's frame; may be equal, which gives one part
/// cost   some 30 us for a segment through a stone of 1,280 triangles, 65 us for one of 20,480; allocates
std::vector<SegmentPart> segment_parts(const SolidTree& tree, const Vec3& a, const Vec3& b);

}  // namespace collided::engine
