#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/world/objects/contained.hpp"
#include "server/world/solids/nearest_surface.hpp"

namespace collided::engine {

/// A corner of each connected piece of the mesh's triangles from `first` on; triangles are connected if they share a
/// corner by number. In a mesh that repeats its corners for each triangle, every triangle is a piece: more corners than
/// needed, and none missing.
/// source  Galler, Fischer, "An improved equivalence algorithm", Communications of the ACM 7, 1964
std::vector<std::uint32_t> corner_of_each_piece(const TriangleMesh& mesh, std::uint32_t first, std::uint32_t count);

/// A point of a primitive, in the primitive's frame, and a ball around it inside the primitive.
struct InnerBall {
  Vec3 point;
  double radius_m = 0;
};
InnerBall inner_ball(const Primitive& own);

/// A point of each primitive and of each connected piece of the mesh, in the object's frame: if the object meets no
/// surface of a solid, these decide which pieces lie within. A part of a static scene has none here.
std::vector<Vec3> points_of_pieces(const ObjectInfo& info);

/// How many pieces of an object lie in a solid; none of them may meet its surface.
struct PiecesWithin {
  bool some = false;
  bool all = false;
  Vec3 point = Vec3::Zero();  // of the first such piece, in the world
};

/// points  of the pieces, in the object's frame
/// cost    that of side_of_placed for each point
PiecesWithin pieces_within(const SolidMesh& solid, const Placed& outer, const Placed& inner,
                           std::span<const Vec3> points, Deadline& deadline, WalkCost& cost, std::uint32_t& tests);

/// The contact of an object with a piece in a solid whose surface it does not meet: normal from the solid to the
/// object, and the nearest triangle of the solid.
struct ContactWithin {
  Contact contact;
  std::uint32_t triangle = kNoTriangle;
};
/// point  of that piece, in the world
ContactWithin contact_within(const SolidMesh& solid, const Placed& outer, const Placed& inner, const Vec3& point,
                             WalkCost& cost, std::uint32_t& tests);

}  // namespace collided::engine
