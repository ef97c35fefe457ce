#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "server/world/query/query.hpp"
#include "server/world/query/unknown_space.hpp"

namespace collided::engine {

/// True if all rays asked are plain, except those that start_plain_ray() refuses. Moving objects are tested afterwards,
/// if a ray reaches their bounds: see reaches_movers().
///
/// filter  the questions', for the snapshot
inline bool are_plain_rays(const Snapshot& snapshot, const Questions& asked, const AnswerFilter& filter) {
  if (asked.kind != QuestionKind::ray || asked.mode == HitMode::all) return false;
  if (asked.error_m != 0 || asked.highest != Level::rational || asked.deadline_ns != 0) return false;
  if (!filter.all_open || filter.has_solids || (filter.unknown && filter.unknown->is_any)) return false;
  return !snapshot.covers || snapshot.covers_without_places;
}

/// numbers  as Questions::numbers
/// returns  false for numbers that are not a ray, and for a ray whose length cannot be expressed in lengths of its
///          direction; those take the general path
bool start_plain_ray(const double* numbers, PlainRay& ray);
/// Walks up to kRaysAtOnce rays (scene_walk.hpp) through each scene together.
///
/// tasks  memory, one per ray
void walk_plain_rays(const Snapshot& snapshot, const Questions& asked, std::span<PlainRay*> rays,
                     std::span<Bvh::RayTask> tasks);
/// Writes the answer's columns and appends the hit.
void write_plain_ray(const Snapshot& snapshot, const Questions& asked, const PlainRay& ray, std::size_t place,
                     Answers& answers);
/// After the scenes: true if the ray may still meet a moving object that may answer. If not, its answer is complete.
bool reaches_movers(const Snapshot& snapshot, const std::vector<std::uint8_t>& allowed, PlainRay& ray);
/// Does all of this for a single ray.
///
/// ray      memory for it
/// returns  not_plain as start_plain_ray(); writes an answer only if answered
enum class PlainOutcome { not_plain, answered, reaches_movers };
PlainOutcome answer_plain_ray(const Snapshot& snapshot, const Questions& asked, const double* numbers,
                              const std::vector<std::uint8_t>& allowed, PlainRay& ray, std::size_t place,
                              Answers& answers);

}  // namespace collided::engine
