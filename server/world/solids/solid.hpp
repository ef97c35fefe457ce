#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/exact_phase/solid/solid_tree.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// A closed mesh that stands for the space it encloses, in its own frame: the points around which it goes at least once.
/// Shared by every object that has it.
/// Always: the mesh is closed, as checked() says.
struct SolidMesh {
  std::shared_ptr<const IndexedMesh> surface;
  /// No two triangles cross or overlap, so the mesh is the border of the solid and nothing else.
  bool is_border = true;
  /// Nothing where rays are faster: for meshes of many triangles, and where the mesh is more than the border.
  std::optional<SolidTree> tree;
};

/// Whether a mesh bounds a solid.
struct SolidFindings {
  std::string refusal;  // why it bounds none, as a whole clause; empty: it does
  std::string warning;  // what makes it more than a border; empty: nothing does
};

/// A mesh bounds a solid where as many triangles run along each edge one way as the other, so that it goes around every
/// point a whole number of times, and where each of its shells faces outward, or inward as a cavity of another. It is the
/// border of that solid, and nothing else, where no two triangles cross or overlap and no shell lies in another that
/// faces the same way.
///
/// cancelled  called now and then; true ends the search for triangles that cross, and then some may
/// cost       about 1.5 us a triangle
/// threads    pure
SolidFindings checked(const IndexedMesh& surface, const std::function<bool()>& cancelled = {});

/// The solid within a surface, with its tree where that pays; and what the check found.
///
/// cancelled  as for checked(); leaves out the tree too
/// returns    null where the check refuses
/// cost       that of the check, and up to some 0.3 s for a tree
std::shared_ptr<const SolidMesh> solid_within(std::shared_ptr<const IndexedMesh> surface, SolidFindings& findings,
                                              const std::function<bool()>& cancelled = {});

/// A point's side, and what it took to find out.
struct SideFound {
  SolidSide side = SolidSide::out;
  Level level = Level::filter;
};

/// Where a point is, relative to a closed mesh in whose frame its coordinates are: by how often a ray leaves it less how
/// often it enters.
/// cost  a walk along the shortest of the six rays along the axes
SideFound side_by_ray(const IndexedMesh& surface, const Vec3& point, WalkCost& cost);

/// The same by the solid's tree, where there is one.
SideFound side_of(const SolidMesh& solid, const Vec3& point, WalkCost& cost);

/// The same for a closed mesh at a pose and a point of the world: exact for the numbers given, the unrounded rotation
/// v -> q v q* / |q|^2 included; where the pose was not given, for the corners as they are placed.
/// cost  that of side_of and of a walk about the point; microseconds a triangle near the ray where the point is so near
///       the surface that placing may have moved it across
SideFound side_of_placed(const SolidMesh& solid, const Placed& object, const Vec3& point, WalkCost& cost);
/// The same for a point of another object, given in that object's own frame: exact for both poses as given, however they
/// round.
SideFound side_of_placed(const SolidMesh& solid, const Placed& object, const Placed& inner, const Vec3& own,
                         WalkCost& cost);
/// The same without a tree, for a point of the world.
SideFound side_of_placed(const IndexedMesh& surface, const Placed& object, const Vec3& point, WalkCost& cost);

/// A point of the world as an object sees it, in its own frame, rounded by at most slack_m.
struct PointSeen {
  Vec3 at = Vec3::Zero();
  double slack_m = 0;
};
/// radius_m  no point that matters is farther from the frame's origin
PointSeen point_seen_from(const Placed& object, const Vec3& point, double radius_m);

/// The same by rationals alone and without an index, for audits.
SolidSide side_by_rationals(const SolidMesh& solid, const Placed& object, const Vec3& point);

}  // namespace collided::engine
