#include "server/world/query/part_pairs.hpp"

namespace collided::engine {
namespace {

/// One walk over pairs; stops at all levels as soon as the visit returns false.
struct PartPairWalk {
  const Placed& a;
  const Placed& b;
  double gap_m;
  const PartPairVisit& visit;
  WalkCost& cost;
  bool goes_on = true;

  bool tell(const PlacedPart& of_a, const PlacedPart& of_b) { return goes_on = goes_on && visit(of_a, of_b); }

  /// Visits the triangles of an object's mesh that may be near a part of the other object.
  template <class Tell>
  void triangles_near(const ConvexPart& part, const Placed& object, const Tell& tell_one) {
    const IndexedMesh& mesh = *object.info->mesh;
    const auto candidate = [&](std::uint32_t triangle) {
      tell_one(PlacedPart{place(object.frame, mesh.mesh->triangle(triangle)), triangle});
      return goes_on;
    };
    const Aabb near = grown(bounds_of_part(part), gap_m);
    mesh.tree.walk_box(seen_from(object.frame, near, mesh.radius_m), candidate, cost);
  }

  void primitives_of_a() {
    visit_primitives_near(*a.info, a.frame, grown(b.bounds, gap_m), cost, [&](const Primitive& own) {
      const PlacedPart of_a{place(a.frame, own)};
      visit_primitives_near(*b.info, b.frame, grown(bounds_of_part(of_a.part), gap_m), cost,
                            [&](const Primitive& other) { return tell(of_a, {place(b.frame, other)}); });
      if (goes_on && b.info->mesh) triangles_near(of_a.part, b, [&](const PlacedPart& of_b) { tell(of_a, of_b); });
      return goes_on;
    });
  }

  void mesh_of_a() {
    visit_primitives_near(*b.info, b.frame, grown(a.bounds, gap_m), cost, [&](const Primitive& other) {
      const PlacedPart of_b{place(b.frame, other)};
      triangles_near(of_b.part, a, [&](const PlacedPart& of_a) { tell(of_a, of_b); });
      return goes_on;
    });
    if (!goes_on || !b.info->mesh) return;
    PlacedTriangles all_of_a(*a.info->mesh->mesh, a.frame);
    PlacedTriangles all_of_b(*b.info->mesh->mesh, b.frame);
    const auto candidate = [&](std::uint32_t triangle_a, std::uint32_t triangle_b) {
      return tell({all_of_a.at(triangle_a), triangle_a}, {all_of_b.at(triangle_b), triangle_b});
    };
    walk_mesh_pairs(a, b, candidate, kNeverOver, cost, gap_m);
  }
};

}  // namespace

void visit_part_pairs(const Placed& a, const Placed& b, double gap_m, const PartPairVisit& visit, WalkCost& cost) {
  PartPairWalk walk{a, b, gap_m, visit, cost};
  walk.primitives_of_a();
  if (walk.goes_on && a.info->mesh) walk.mesh_of_a();
}

std::vector<PlacedPart> parts_of(const Placed& object) {
  std::vector<PlacedPart> parts;
  for (const Primitive& own : object.info->primitives) parts.push_back({place(object.frame, own)});
  if (!object.info->mesh) return parts;
  const TriangleMesh& mesh = *object.info->mesh->mesh;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) parts.push_back({place(object.frame, mesh.triangle(i)), i});
  return parts;
}

}  // namespace collided::engine
