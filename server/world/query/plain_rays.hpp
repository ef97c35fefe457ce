#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "server/world/query/query.hpp"

namespace collided::engine {

/// Whether all rays asked are plain, but for those that start_plain_ray refuses.
bool are_plain_rays(const Snapshot& snapshot, const Questions& asked, const QueryScratch& scratch);

/// numbers  as Questions::numbers, already validated
/// returns  false for a ray whose length is not known in lengths of its direction: that is one for ask_ray
bool start_plain_ray(const double* numbers, PlainRay& ray);
void walk_plain_ray(const Snapshot& snapshot, HitMode mode, PlainRay& ray);
/// The same for up to kPlainRaysAtOnce rays, each scene's walks together.
///
/// tasks  memory for one a ray
inline constexpr std::size_t kPlainRaysAtOnce = 64;
void walk_plain_rays(const Snapshot& snapshot, HitMode mode, std::span<PlainRay*> rays, std::span<Bvh::RayTask> tasks);
/// Writes the answer's columns and appends the hit.
void write_plain_ray(const Snapshot& snapshot, HitMode mode, const PlainRay& ray, std::size_t place, Answers& answers);

}  // namespace collided::engine
