#pragma once

#include "server/exact_phase/motion/box_motion_filter.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

/// An object that is one box, as a step uses it.
struct PlacedBox {
  kernel::MovingBox motion;    // ends at its pose; without motion if it was placed or did not move in the step
  double placing_error_m = 0;  // bound on how far points of motion.at_end are from their exact places

  PlacedBox(const Box& own, const Frame& before, const Frame& now, double reach_m, double error_m)
      : motion(own, before, now, reach_m), placing_error_m(error_m) {}
};

/// Bound on how far the points of two placed boxes together may be off, metres.
inline double placing_error_m(const PlacedBox& a, const PlacedBox& b) {
  return (a.placing_error_m + b.placing_error_m) * (1 + kBoundSlack);
}

/// Does what search_objects() does for two objects of one placed box each, if the filter in double decides. False: it
/// does not, and nothing was changed.
///
/// off_m  how far the points of the two may be off together
/// touch  has found nothing yet
bool search_boxes(const Box& a, const Box& b, double off_m, ContactSearch& touch);

}  // namespace collided::engine
