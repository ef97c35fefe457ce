#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"
#include "server/world/query/question.hpp"

namespace collided::engine {

/// Whether a miss, or a nearest hit, depends on space that the loaded geometry does not cover. The whole space of the
/// question, up to the least distance of the nearest hit if there is one, must lie within the union of the boxes.
/// Each single box is compared exactly with a ball, a segment along an axis and an axis-aligned box. Anything else, and
/// the union of boxes, is compared with bounds rounded outward, so uncovered space is never called covered. If only
/// several boxes together can cover a ball, a motion or a rotated box, they must cover its bounding box.
///
/// numbers  of the question, which is answered; its snapshot has covers
/// returns  nothing if all is covered
/// threads  pure; no allocation
std::optional<Leaving> leaves_covered(const Question& question, const double* numbers);

/// For a shard: doubts all answers of a batch that depend on space that the shard does not hold. Call it when no other
/// doubt applies: a client that asks all shards reached by a question may drop this doubt, and no other.
void doubt_where_not_held(const Snapshot& snapshot, const Questions& asked, Answers& answers);

/// Tests the ray's first length_m metres.
std::optional<Leaving> leaves_covered(const Ray& ray, std::span<const Aabb> covers);

}  // namespace collided::engine
