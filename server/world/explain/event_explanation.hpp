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

/// Explains an event of contacts, or of fences, by the memory of poses; all but the version is filled. That has a motion that
/// no publisher said begin at another time than the step had it, so that of such motions there are no gaps.
///
/// is_of_fence     its b is a fence
/// clock_error_ns  by which publishers' clocks may differ, as WorldOptions has it
/// name_of         a publisher's name; empty where it has none
/// cost            two states of the past, and two reports on the pair
/// threads         any
ExplainedEvent explain_event(const PoseMemory& memory, const RecentEvent& recent, bool is_of_fence,
                             std::int64_t clock_error_ns, FunctionRef<std::string(std::uint64_t)> name_of,
                             Deadline& deadline);

}  // namespace collided::engine
