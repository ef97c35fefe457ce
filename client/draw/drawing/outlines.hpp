#pragma once

#include <vector>

#include "client/draw/drawing/features.hpp"

namespace collided::draw {

/// The silhouette and the rims of a solid in closed form, as chains in the world. A chain of a curve runs just outside
/// of it (it is the polygon about it), so that none of its points is inside the solid.
///
/// pose     of the object in whose frame the solid is
/// object   that the lines are said to be of
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
/// Its twelve edges.
void add_outline(const BoxShape& box, const Pose& pose, const Camera& camera, std::uint32_t object,
                 std::vector<FeatureLine>& lines);

}  // namespace collided::draw
