#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

/// Where a question leaves the covered space, on the line from its beginning (a ray's origin, the centre of a ball or
/// box, the first pose of a sweep).
struct Leaving {
  Vec3 point = Vec3::Zero();
  double covered_m = 0;  // of rays: the length that is surely covered, metres
};

/// Whether a miss, or a nearest hit, claims something about space that the loaded geometry does not cover. All that the
/// question covers, up to the least distance of the nearest hit where there is one, must lie within the union of the
/// boxes.
/// Each single box is compared exactly with a ball, a segment along an axis and an axis-aligned box; anything else, and
/// all boxes together, with bounds rounded outward, so nothing is called covered that is not. Where only several boxes
/// together can cover a ball, a motion or a rotated box, they must cover its bounding box.
///
/// numbers  of one question, validated; hits: its own, in their order
/// returns  nothing where all is covered
/// threads  pure; no allocation
std::optional<Leaving> leaves_covered(const Questions& asked, const double* numbers, std::span<const AnswerHit> hits,
                                      std::span<const Aabb> covers);

/// The same for the ray's first length_m metres.
std::optional<Leaving> leaves_covered(const Ray& ray, std::span<const Aabb> covers);

}  // namespace collided::engine
