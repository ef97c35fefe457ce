#pragma once

#include <vector>

#include "server/exact_phase/given/given_part.hpp"
#include "server/exact_phase/part.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// Number of parts of an object.
std::size_t part_count_of(const Snapshot& snapshot, ObjectId object);

/// All parts of an object at its pose: its primitives, then its triangles in order, without an index.
std::vector<ConvexPart> parts_of_object(const Snapshot& snapshot, ObjectId object);
/// The same parts, in the same order, as they were given.
std::vector<GivenPart> given_parts_of_object(const Snapshot& snapshot, ObjectId object);

}  // namespace collided::engine
