#pragma once

#include <collided.h>
#include <collided/client.hpp>

/// Events of fences, margins and questions for the nearest as C has them. Their texts are lent: those of the event.
namespace collided::c {

collided_fence_event lend_fence(const FenceEvent& event);
collided_margin_event lend_margin(const MarginEvent& event);
collided_nearest_event lend_nearest(const NearestEvent& event);

}  // namespace collided::c
