#pragma once

#include "server/world/query/question.hpp"
#include "server/world/solids/nearest_surface.hpp"
#include "server/world/solids/winding.hpp"

namespace collided::engine {

/// The nearest point of a solid's surface to a point in the solid or on it; nothing if the point is outside, or the
/// question's deadline ends the search.
std::optional<NearestSurface> surface_from_inside(const SolidMesh& solid, const Placed& object, const Vec3& point,
                                                  Question& question);

/// The point's side, counted as a test of the question.
SolidSide side_in_question(const SolidMesh& solid, const Placed& object, const Vec3& point, Question& question);

/// Turns a ball's or box's contact with the surface of a solid into one with the solid: if its centre is inside, it
/// meets the solid even if it does not reach the surface. A ball's depth is then the centre's depth plus the radius; a
/// box keeps the contact with the surface or, without one, gets the shortest way out.
void meet_solid(const Sphere& asked, const SolidMesh& solid, const Placed& object, ContactSearch& touch,
                Question& question);
void meet_solid(const Box& asked, const SolidMesh& solid, const Placed& object, ContactSearch& touch,
                Question& question);

/// The nearest point of a mesh's surface to a point that is inside by winding number. Nothing if the point is outside,
/// or if that is undecided, which the question then records.
std::optional<NearestSurface> surface_from_inside(const WindingMesh& mesh, const Placed& object, const Vec3& point,
                                                  Question& question);

template <class Part, class Visit>
void visit_parts_about(const std::vector<Part>& parts, const StaticScene& scene, const Aabb& near, Question& question,
                       Visit&& visit) {
  for (const Part& part : parts) {
    if (!overlaps(part.bounds, near) || !question.allows_part(scene, part.part)) continue;
    Placed placed = question.placed(slot_of(scene.part_objects[part.part]));
    placed.bounds = part.bounds;
    visit(part, placed);
  }
}
/// Calls visit(solid part, placed) for each declared part of the scene that may answer and whose bounds meet the box.
template <class Visit>
void visit_solid_parts(const StaticScene& scene, const Aabb& near, Question& question, Visit&& visit) {
  visit_parts_about(scene.solid_parts, scene, near, question, visit);
}
/// Calls visit() for parts that are solid by winding number.
template <class Visit>
void visit_winding_parts(const StaticScene& scene, const Aabb& near, Question& question, Visit&& visit) {
  visit_parts_about(scene.winding_parts, scene, near, question, visit);
}

/// Sorts deepest first, ties by name; cuts at max_hits.
void finish_overlap(Question& question);

}  // namespace collided::engine
