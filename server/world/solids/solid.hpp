#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/exact_phase/solid/solid_tree.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// A closed mesh that represents the space it encloses, in its own frame: the points that it winds around at least
/// once. Shared by all objects that have it.
/// Always: the mesh is closed, by checked().
struct SolidMesh {
  std::shared_ptr<const IndexedMesh> surface;
  /// No two triangles cross or overlap, so the mesh is the border of the solid and nothing else.
  bool is_border = true;
  /// Empty if rays are faster: for meshes of many triangles, and if the mesh is more than the border.
  std::optional<SolidTree> tree;
};

/// Whether a mesh bounds a solid.
struct SolidFindings {
  std::string refusal;  // why it bounds no solid, as a whole clause; empty: it does
  std::string warning;  // why the mesh is more than the border; empty: it is not
};

/// A mesh bounds a solid if as many triangles run along each edge one way as the other, so that it winds around every
/// point a whole number of times, and if each of its shells faces outward, or inward as a cavity of another. It is
/// exactly the border of that solid if no two triangles cross or overlap and no shell lies in another that faces the
/// same way.
///
/// cancelled  called now and then; true ends the search for crossing triangles, which then may remain unfound
/// cost       about 1.5 us a triangle
/// threads    pure
SolidFindings checked(const IndexedMesh& surface, const std::function<bool()>& cancelled = {});

/// The solid within a surface, with its tree if that pays, and the findings of the check.
///
/// cancelled  as for checked(); leaves out the tree too
/// returns    null if the check refuses
/// cost       that of the check, and up to some 0.3 s for a tree
std::shared_ptr<const SolidMesh> solid_within(std::shared_ptr<const IndexedMesh> surface, SolidFindings& findings,
                                              const std::function<bool()>& cancelled = {});

/// A point's side, and the work to find it.
struct SideFound {
  SolidSide side = SolidSide::out;
  Level level = Level::filter;
};

/// The side of a point relative to a closed mesh in whose frame it is: by how often a ray leaves the mesh less how
/// often it enters.
/// cost  a walk along the shortest of the six rays along the axes
SideFound side_by_ray(const IndexedMesh& surface, const Vec3& point, WalkCost& cost);

/// Finds the side by the solid's tree, if there is one.
SideFound side_of(const SolidMesh& solid, const Vec3& point, WalkCost& cost);

/// Finds the side of a world point for a closed mesh at a pose: exact for the numbers given, including the unrounded
/// rotation v -> q v q* / |q|^2; if no pose was given, exact for the corners as placed.
/// cost  that of side_of and of a walk around the point; microseconds for each triangle near the ray if the point is so
///       near the surface that placing may have moved it across
SideFound side_of_placed(const SolidMesh& solid, const Placed& object, const Vec3& point, WalkCost& cost);
/// Finds the side of a point of another object, given in that object's frame: exact for both poses as given, regardless
/// of rounding.
SideFound side_of_placed(const SolidMesh& solid, const Placed& object, const Placed& inner, const Vec3& own,
                         WalkCost& cost);
/// Finds the side of a world point without a tree.
SideFound side_of_placed(const IndexedMesh& surface, const Placed& object, const Vec3& point, WalkCost& cost);

/// A world point in an object's own frame, rounded by at most slack_m.
struct PointSeen {
  Vec3 at = Vec3::Zero();
  double slack_m = 0;
};
/// radius_m  no relevant point is farther from the frame's origin
PointSeen point_seen_from(const Placed& object, const Vec3& point, double radius_m);

/// Finds the side by rationals alone and without an index, for audits.
SolidSide side_by_rationals(const SolidMesh& solid, const Placed& object, const Vec3& point);

}  // namespace collided::engine
