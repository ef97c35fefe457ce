#pragma once

#include <optional>

#include "server/exact_phase/distance/core.hpp"

namespace collided::engine::kernel {

/// The mean of the midpoints of the edges of two boxes, each clipped by the other box: middle_of_both() for two boxes,
/// to the last bit, with four edges at a time. Nothing if no edge remains, or if squares of the axes may leave the
/// range of double.
///
/// axes: as in Box, of about unit length
/// cost  a fifth of clipping edge by edge; no allocation
/// source  outcodes and clipping of segments: Cyrus, Beck, "Generalized two- and three-dimensional clipping", 1978
std::optional<Vec3> middle_of_boxes(const Core& a, const Core& b, double size_m);

}  // namespace collided::engine::kernel
