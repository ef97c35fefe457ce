#pragma once

#include <functional>
#include <string>
#include <variant>

#include "idl/dds.hpp"
#include "server/world/groups/what_if.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// The subject of a chunk of what-if configurations, found by name in a state; or a sentence why it cannot be answered.
std::variant<WhatIfAsk, Refusal> what_if_asked(const wire::Query& query, const Snapshot& state);

/// Answers configurations: `numbers` has a pose for each moved object, per configuration. Invalid poses make that
/// configuration's answer `invalid`. A pair becomes two hits, that of the moved object first: both have the clearance
/// as their distance, the normal from the first to the second, and each its own nearest point; kHitInside is set if one
/// lies within the other.
///
/// time      of each configuration; one that is given up gets no answer, nor do those after it
/// pause_ns  steady clock; configurations left after this time get no answers; 0: none
/// goes_on   polled; false: the answers are not needed any more, and the rest is undecided
void answer_what_if(WhatIf& what_if, std::span<const double> numbers, const SearchTime& time, std::int64_t pause_ns,
                    const std::function<bool()>& goes_on, Answers& answers);

}  // namespace collided::engine::service
