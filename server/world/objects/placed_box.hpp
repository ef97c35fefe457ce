#pragma once

#include "server/exact_phase/motion/box_motion_filter.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

/// An object that is one box, where a step has it.
struct PlacedBox {
  kernel::MovingBox motion;    // to its pose; at rest there where it did not move in the step or was placed
  double placing_error_m = 0;  // of motion.at_end: how far its points may be from where its pose puts them

  PlacedBox(const Box& own, const Frame& before, const Frame& now, double reach_m, double error_m)
      : motion(own, before, now, reach_m), placing_error_m(error_m) {}
};

/// How far the points of two placed boxes may be off together, metres.
inline double placing_error_m(const PlacedBox& a, const PlacedBox& b) {
  return (a.placing_error_m + b.placing_error_m) * (1 + kBoundSlack);
}

/// What search_objects() does for two objects of one box each, placed already, where the filter in double decides. False:
/// it does not, and nothing was done.
///
/// off_m  how far the points of the two may be off together
/// touch  has found nothing yet
bool search_boxes(const Box& a, const Box& b, double off_m, ContactSearch& touch);

}  // namespace collided::engine
