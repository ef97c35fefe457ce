#pragma once

#include "server/broad_phase/hierarchy/bvh_layout.hpp"

namespace collided::engine::bvh {

/// Sets every node's order for rays that any triangle stops: the child first that is likely to stop a ray soonest, by
/// the chance that a ray through its box meets a triangle there, over the cost of searching it. A line that meets a
/// convex body of surface A meets a surface of area S inside it 2 S / A times on average.
///
/// source  the ratio: Nah, Manocha, "SATO: Surface Area Traversal Order for Shadow Ray Tracing", 2014; the mean count:
///         Crofton's formula
void set_occlusion_orders(Layout& layout, unsigned threads);

}  // namespace collided::engine::bvh
