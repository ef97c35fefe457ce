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

/// What a chunk of what-if configurations is about, found by name in a state; or why it cannot be answered, as a sentence.
std::variant<WhatIfAsk, Refusal> what_if_asked(const wire::Query& query, const Snapshot& state);

/// Answers configurations: numbers has, for each, a pose for each moved object. Poses that are none get `invalid`, each
/// configuration for itself. A pair becomes two hits, that of the moved object first: both have the clearance as their
/// distance, the normal from the first to the second, and each its own nearest point; kHitInside is set of one that lies
/// within the other.
///
/// time      of each configuration; one that is given up gets no answer, nor do those after it
/// pause_ns  steady clock; the configurations that are left once it has passed get no answers; 0: none
/// goes_on  asked now and then; false: nobody reads the answers any more, and the rest is undecided
void answer_what_if(WhatIf& what_if, std::span<const double> numbers, const SearchTime& time, std::int64_t pause_ns,
                    const std::function<bool()>& goes_on, Answers& answers);

}  // namespace collided::engine::service
