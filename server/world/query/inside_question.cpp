// The solids that hold a point, with its depth in each.

#include "server/world/objects/object_placing.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/solid_hits.hpp"

namespace collided::engine {
namespace {

/// The point as a ball of radius 0: a primitive's decision about it holds for the point.
struct InsideSearch {
  Question& question;
  Sphere ball;
  Aabb near = bounds(ball);
  bool any = question.asked.mode == HitMode::any;

  bool ended() const { return (any && !question.found.empty()) || question.deadline.was_over(); }
  void take(ObjectId object, const ContactSearch& touch) {
    question.exact_tests += touch.exact_tests;
    question.level = std::max(question.level, touch.level);
    if (touch.undecided && !touch.yes) question.undecided = true;
    if (!touch.yes) return;
    question.found.push_back({.object = object,
                              .triangle = touch.b_triangle,
                              .flags = static_cast<std::uint8_t>(question.flags_of(object) | kHitInside),
                              .distance_m = touch.contact.depth_m,
                              .error_m = any ? std::numeric_limits<double>::infinity() : touch.contact.depth_error_m,
                              .point = touch.contact.point,
                              .normal = touch.contact.normal});
  }
  ContactSearch begun() {
    ContactSearch touch;
    touch.wanted = !any;
    touch.deadline = &question.deadline;
    return touch;
  }
  void search(const Placed& object) {
    ContactSearch touch = begun();
    visit_primitives_near(*object.info, object.frame, near, question.walk, [&](const Primitive& primitive) {
      search_parts(Primitive(ball), kNoTriangle, place(object.frame, primitive), kNoTriangle, touch,
                   {GivenPart{}, object.given(primitive)});
      return !touch.done();
    });
    if (touch.yes && touch.wanted) touch.contact.depth_error_m += placing_error_m(object, kNoTriangle, near);
    if (object.info->rare->solid) meet_deeper(*object.info->rare->solid, object, touch);
    take(object.info->id, touch);
    if (object.info->rare->winding && !touch.yes) search_by_winding(*object.info->rare->winding, object);
  }
  /// An open mesh has no measurable way out, so the distance of its surface is reported.
  void search_by_winding(const WindingMesh& winding, const Placed& object) {
    const std::optional<NearestSurface> nearest = surface_from_inside(winding, object, ball.center, question);
    if (!nearest) return;
    question.found.push_back(
        {.object = object.info->id,
         .triangle = nearest->triangle,
         .flags = static_cast<std::uint8_t>(question.flags_of(object.info->id) | kHitInside | kHitByWinding),
         .distance_m = nearest->distance_m,
         .error_m = std::numeric_limits<double>::infinity(),
         .point = nearest->point,
         .normal = nearest->normal});
  }
  /// Keeps the deepest part of an object.
  void meet_deeper(const SolidMesh& solid, const Placed& object, ContactSearch& touch) {
    ContactSearch own = begun();
    if (touch.done()) return;
    meet_solid(ball, solid, object, own, question);
    if (own.yes && (!touch.yes || own.contact.depth_m > touch.contact.depth_m)) {
      own.exact_tests = touch.exact_tests;
      own.level = touch.level;
      touch = own;
    }
  }
};

}  // namespace

void ask_inside(Question& question, const double* n) {
  question.found.clear();
  InsideSearch search{.question = question, .ball = {.center = point_of(n), .radius_m = 0}};
  const SceneList& scenes = question.snapshot.scenes;
  scenes.walk_box(search.near, question.walk, [&](std::size_t index) {
    const auto& scene = scenes[index];
    visit_solid_parts(*scene, search.near, question, [&](const SolidPart& part, const Placed& object) {
      if (search.ended() || question.deadline.is_over()) return;
      ContactSearch touch = search.begun();
      meet_solid(search.ball, *part.solid, object, touch, question);
      search.take(object.info->id, touch);
    });
    visit_winding_parts(*scene, search.near, question, [&](const WindingPart& part, const Placed& object) {
      if (!search.ended() && !question.deadline.is_over()) search.search_by_winding(*part.winding, object);
    });
    return !search.ended();
  });
  if (question.snapshot.grid && !search.ended()) {
    const auto candidate = [&](std::uint32_t slot) {
      const Placed object = question.placed_without_bounds(slot);
      const bool is_solid = !object.info->primitives.empty() || object.info->rare->solid || object.info->rare->winding;
      if (is_solid && question.allows(object.info->id)) search.search(object);
      return !search.ended();
    };
    question.snapshot.grid->walk_box(search.near, candidate, question.walk);
  }
  finish_overlap(question);
}

}  // namespace collided::engine
