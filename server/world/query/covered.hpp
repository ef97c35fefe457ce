#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"
#include "server/world/query/question.hpp"

namespace collided::engine {

/// Whether a miss, or a nearest hit, claims something about space that the loaded geometry does not cover. All that the
/// question covers, up to the least distance of the nearest hit where there is one, must lie within the union of the
/// boxes.
/// Each single box is compared exactly with a ball, a segment along an axis and an axis-aligned box; anything else, and
/// all boxes together, with bounds rounded outward, so nothing is called covered that is not. Where only several boxes
/// together can cover a ball, a motion or a rotated box, they must cover its bounding box.
///
/// numbers  of the question, which is answered; its snapshot has covers
/// returns  nothing where all is covered
/// threads  pure; no allocation
std::optional<Leaving> leaves_covered(const Question& question, const double* numbers);

/// Of a shard: the same for all answers to a batch that claim something, by what the shard holds. To be called when there is
/// nothing else to doubt them by: whoever asks all shards that a question reaches may leave this doubt aside, and no other.
void doubt_where_not_held(const Snapshot& snapshot, const Questions& asked, Answers& answers);

/// The same for the ray's first length_m metres.
std::optional<Leaving> leaves_covered(const Ray& ray, std::span<const Aabb> covers);

}  // namespace collided::engine
