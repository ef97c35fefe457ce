#include "server/world/query/solid_hits.hpp"

#include <cmath>

#include "server/geometry/tolerance.hpp"
#include "server/world/query/underflow.hpp"
#include "server/world/solids/within.hpp"

namespace collided::engine {
namespace {

void take_contact(const NearestSurface& nearest, const WayOut& way, ContactSearch& touch) {
  touch.contact = contact_inside(nearest, way);
  touch.b_triangle = nearest.triangle;
}

}  // namespace

SolidSide side_in_question(const SolidMesh& solid, const Placed& object, const Vec3& point, Question& question) {
  const SideFound found = side_of_placed(solid, object, point, question.walk);
  ++question.exact_tests;
  question.level = std::max(question.level, found.level);
  return found.side;
}

std::optional<NearestSurface> surface_from_inside(const SolidMesh& solid, const Placed& object, const Vec3& point,
                                                  Question& question) {
  const SolidSide side = side_in_question(solid, object, point, question);
  if (side == SolidSide::out) return std::nullopt;
  std::optional<NearestSurface> nearest =
      nearest_surface(solid, object, point, question.deadline, question.walk, question.exact_tests);
  if (!nearest) return std::nullopt;
  nearest->error_m = with_underflow(nearest->distance_m, nearest->error_m);
  // If the mesh is more than the border, a point on it may still be deep inside.
  if (side == SolidSide::on) nearest->distance_m = 0;
  if (side == SolidSide::on && solid.is_border) nearest->error_m = 0;
  return nearest;
}

std::optional<NearestSurface> surface_from_inside(const WindingMesh& mesh, const Placed& object, const Vec3& point,
                                                  Question& question) {
  const WindingSide side = side_by_winding(mesh, object, point, question.walk);
  ++question.exact_tests;
  if (side == WindingSide::undecided) question.undecided = true;
  if (side != WindingSide::in) return std::nullopt;
  return nearest_surface(*mesh.surface, object, point, question.deadline, question.walk, question.exact_tests);
}

void meet_solid(const Sphere& asked, const SolidMesh& solid, const Placed& object, ContactSearch& touch,
                Question& question) {
  if (!touch.wanted) {
    touch.yes = touch.yes || side_in_question(solid, object, asked.center, question) != SolidSide::out;
    return;
  }
  const std::optional<NearestSurface> nearest = surface_from_inside(solid, object, asked.center, question);
  if (nearest) {
    const bool is_deeper = touch.yes && touch.contact.depth_m > nearest->distance_m + asked.radius_m;
    if (!is_deeper) {
      const double depth_m = nearest->distance_m + asked.radius_m;
      const double error_m = nearest->error_m + 2 * kRoundoff * depth_m * (1 + kBoundSlack);
      take_contact(*nearest, {.least_m = depth_m, .most_m = depth_m + error_m}, touch);
      touch.contact.depth_error_m = error_m;
    }
    touch.yes = true;
  }
}

void meet_solid(const Box& asked, const SolidMesh& solid, const Placed& object, ContactSearch& touch,
                Question& question) {
  if (touch.yes) return;
  if (!touch.wanted) {
    touch.yes = side_in_question(solid, object, asked.center, question) != SolidSide::out;
    return;
  }
  const std::optional<NearestSurface> nearest = surface_from_inside(solid, object, asked.center, question);
  if (nearest) {
    const double inscribed_m = inner_ball(asked).radius_m;
    take_contact(*nearest, way_out(solid, object, *nearest, inscribed_m, bounds(asked)), touch);
    touch.yes = true;
  }
}

void finish_overlap(Question& question) {
  std::sort(question.found.begin(), question.found.end(), [&](const AnswerHit& a, const AnswerHit& b) {
    return a.distance_m != b.distance_m ? a.distance_m > b.distance_m : question.precedes(a, b);
  });
  if (question.found.size() > question.asked.max_hits) {
    question.found.resize(question.asked.max_hits);
    question.truncated = true;
  }
}

}  // namespace collided::engine
