#pragma once

#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// The verdict of double with its error bound about a ray and a triangle. blunt: the ray certainly meets it, but the
/// distance is less precise than the thread's Precision requires.
enum class FilterVerdict : int { miss, hit, blunt, unsure };

/// The first rung of cast_ray: decides nearly all rays. Fills `hit` on FilterVerdict::hit only.
///
/// SIMD, chosen at run time; every variant runs the same operations in the same order, so all give the same bits.
FilterVerdict filter_ray(const Ray& ray, const Triangle& triangle, RayHit& hit);
/// Miss and hit hold for every triangle whose corners are off from this one's by at most off_m. The hit is that of this
/// one.
FilterVerdict filter_ray_within(const Ray& ray, const Triangle& triangle, double off_m, RayHit& hit);

}  // namespace collided::engine::kernel
