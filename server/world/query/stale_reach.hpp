#pragma once

#include <optional>

#include "server/world/query/query.hpp"

namespace collided::engine {

/// An object whose publisher is lost may have moved on, in any direction: it is within its last speed times the age of
/// its last pose. If that could change an answer (a miss, or a nearest hit behind that region) the answer becomes
/// undecided with reason stale_object; its hits stay in it. A hit of the stale object itself stays a hit, with its
/// flag; an object that stood still is assumed to be where it was.
///
/// answers  to these questions on this snapshot. Ages count to kAgeSlackNs after the snapshot's time, so that a
///          snapshot this young covers the motion since, and the same question on the same state has the same answer
void doubt_where_stale_objects_reach(const Snapshot& snapshot, const Questions& questions, Answers& answers);

/// The region in which a stale object may be by now; nothing if the object is not stale or stood still.
std::optional<Aabb> unknown_region(const Snapshot& snapshot, ObjectId id);

/// Age added to every stale object: how old a snapshot may be when it is used.
inline constexpr std::int64_t kAgeSlackNs = 500'000'000;

}  // namespace collided::engine
