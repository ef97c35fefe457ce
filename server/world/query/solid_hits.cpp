#include "server/world/query/solid_hits.hpp"

#include <cmath>

#include "server/exact_phase/distance/closest.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/world/query/underflow.hpp"

namespace collided::engine {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// The contact of a shape whose middle lies in the solid, as moving it along the normal parts the two.
void take_contact(const NearestSurface& nearest, double beyond_m, double more_error_m, ContactSearch& touch) {
  touch.contact.point = nearest.point;
  // The nearest way out goes on beyond the surface, and a contact's normal points the other way: to what was met.
  touch.contact.normal = nearest.normal.isZero(0) ? Vec3(-Vec3::UnitZ()) : Vec3(-nearest.normal);
  touch.contact.depth_m = nearest.distance_m + beyond_m;
  touch.contact.depth_error_m =
      nearest.error_m + more_error_m + 2 * kRoundoff * touch.contact.depth_m * (1 + kBoundSlack);
  touch.b_triangle = nearest.triangle;
}

std::optional<NearestSurface> nearest_surface(const SolidMesh& solid, const Placed& object, const Vec3& point,
                                              Question& question) {
  const IndexedMesh& surface = *solid.surface;
  NearestSurface best{.distance_m = kUnbounded};
  double limit_m2 = kUnbounded;
  const auto candidate = [&](std::uint32_t number, double) {
    if (question.deadline.is_over()) return -1.0;
    const Triangle own = surface.mesh->triangle(number);
    const Closest found = closest(point, place(*object.frame, own));
    ++question.exact_tests;
    const bool is_nearer =
        found.distance_m < best.distance_m || (found.distance_m == best.distance_m && number < best.triangle);
    if (!is_nearer) return limit_m2;
    best = {.distance_m = found.distance_m,
            .error_m = found.distance_error_m + placing_error_m(*object.frame, own),
            .triangle = number,
            .point = found.point,
            .normal = -found.normal};
    limit_m2 = square_up(best.distance_m + best.error_m);
    return limit_m2;
  };
  const Vec3 away = point - object.frame->position;
  const double slack_m = placement_slack(*object.frame, away.lpNorm<1>() + point.lpNorm<1>(), surface.radius_m);
  surface.tree.walk_near(object.frame->rotation.transpose() * away, limit_m2, slack_m, candidate, question.walk);
  if (question.deadline.was_over() || best.triangle == kNoTriangle) return std::nullopt;
  best.error_m = solid.is_border ? with_underflow(best.distance_m, best.error_m) : kUnbounded;
  return best;
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
  std::optional<NearestSurface> nearest = nearest_surface(solid, object, point, question);
  if (!nearest) return std::nullopt;
  // Where the mesh is more than the border, a point on it may still be deep inside.
  if (side == SolidSide::on) nearest->distance_m = 0;
  if (side == SolidSide::on && solid.is_border) nearest->error_m = 0;
  return nearest;
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
    if (!is_deeper) take_contact(*nearest, asked.radius_m, 0, touch);
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
    take_contact(*nearest, 0, kUnbounded, touch);
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
