#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

/// The way from a question's beginning (a ray's origin, the middle of a ball or box, the first place of a sweep) to where
/// what was asked leaves the covered space.
struct Leaving {
  Vec3 point = Vec3::Zero();
  double covered_m = 0;  // of rays: how far they are covered at least
};

/// Whether a miss, or a nearest hit, was said of something that the loaded geometry does not cover: all that was asked, up to
/// the least distance of the nearest hit where one is told, must lie within the boxes together.
/// A ball, a segment along an axis and a box that is not turned are compared exactly with each box, whatever else, and all of
/// them together, with bounds rounded outward, so that nothing is called covered that is not. Of several boxes a ball, a way
/// and a turned box must lie in them with their own bounding box.
///
/// numbers  of one question, checked; hits: its own, in their order
/// returns  nothing where it is covered
/// threads  pure; no allocation
std::optional<Leaving> leaves_covered(const Questions& asked, const double* numbers, std::span<const AnswerHit> hits,
                                      std::span<const Aabb> covers);

/// The same of the ray's first length_m.
std::optional<Leaving> leaves_covered(const Ray& ray, std::span<const Aabb> covers);

}  // namespace collided::engine
