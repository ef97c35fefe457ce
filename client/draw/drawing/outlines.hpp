#pragma once

#include <vector>

#include "client/draw/drawing/features.hpp"

namespace collided::draw {

/// Adds the silhouette and the rims of a solid, in closed form, as chains in the world. The chain of a curve is a
/// polygon around it, so that none of its points is inside the solid.
///
/// pose     of the object in whose frame the solid is
/// object   number that the lines get
void add_outline(const SphereShape& sphere, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines);
void add_outline(const CapsuleShape& capsule, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines);
void add_outline(const CylinderShape& cylinder, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines);
void add_outline(const ConeShape& cone, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines);
void add_outline(const EllipsoidShape& ellipsoid, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines);
/// For a box, its twelve edges.
void add_outline(const BoxShape& box, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines);

}  // namespace collided::draw
