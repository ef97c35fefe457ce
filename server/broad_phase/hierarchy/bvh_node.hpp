#pragma once

#include <span>

#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/broad_phase/hierarchy/bvh_split.hpp"

namespace collided::engine::bvh {

/// A cut that made children of a node: child `left` was cut along an axis, and its upper part became `right`.
struct Cut {
  int left;
  int right;
  int axis;
};

/// A node without children.
Node empty_node();

void set_child(Node& node, int slot, const FloatBox& box, Ref ref);

/// Sets the order of children near to far, for each octant of directions.
void set_order(const Cut (&cuts)[kWidth], int child_count, Node& node);

/// Cuts a range until there are eight children or all fit leaves, and reorders its primitives; returns the number of
/// children.
///
/// by_count  in halves by count, for a range so deep in the tree that the surface-area heuristic has failed
int cut_wide(std::span<Primitive> primitives, const Range& range, bool by_count, Range (&children)[kWidth],
             Cut (&cuts)[kWidth]);

}  // namespace collided::engine::bvh
