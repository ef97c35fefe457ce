#pragma once

#include <cstdint>
#include <string>

#include "server/geometry/function_ref.hpp"
#include "server/world/events/recent_events.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/query/pose_memory.hpp"

namespace collided {
struct ExplainedEvent;
}

namespace collided::engine {

/// Explains an event of a contact or fence from the memory of poses; fills everything but the version. Some motions in
/// that memory begin at another time than in the step, at one that no publisher gave; no gaps are reported for them.
///
/// is_of_fence     its b is a fence
/// clock_error_ns  largest difference between publishers' clocks, as in WorldOptions
/// name_of         returns a publisher's name; empty if it has none
/// cost            two states of the past, and two reports on the pair
/// threads         any
ExplainedEvent explain_event(const PoseMemory& memory, const RecentEvent& recent, bool is_of_fence,
                             std::int64_t clock_error_ns, FunctionRef<std::string(std::uint64_t)> name_of,
                             Deadline& deadline);

}  // namespace collided::engine
