#pragma once

#include <optional>

#include "server/world/query/query.hpp"

namespace collided::engine {

/// An object whose publisher is lost may have gone on. It is somewhere about its last pose, within the speed of its last
/// way times the age of that pose, whichever way it turned. Where that could change what was answered (a miss, or a
/// nearest hit behind it) the answer becomes undecided with reason stale_object; its hits stay for who wants them. A hit
/// of the stale object itself stays one and carries its flag; what stood still is where it was.
///
/// answers  of these questions on this snapshot; the age counts up to kAgeSlackNs after the snapshot's time, so that a
///          state this young says enough and the same question on the same state has the same answer
void doubt_where_stale_objects_reach(const Snapshot& snapshot, const Questions& questions, Answers& answers);

/// Where the object may be by now where nobody knows: it is stale and moved when it was last heard of; else nothing.
std::optional<Aabb> unknown_region(const Snapshot& snapshot, ObjectId id);

inline constexpr std::int64_t kAgeSlackNs = 500'000'000;

}  // namespace collided::engine
