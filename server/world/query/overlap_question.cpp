// The objects that a ball or a box touches, with their deepest contacts.

#include "server/exact_phase/distance/nearest_filter.hpp"
#include "server/world/objects/object_placing.hpp"
#include "server/world/query/question.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/solid_hits.hpp"

namespace collided::engine {
namespace {

using kernel::reported_at_most;

/// Visits every triangle that the box may meet; in mode `any`, stops at the first that it meets.
template <class Allowed, class Meet>
void meet_scene(const Box&, const Aabb& near, const StaticScene& scene, Question& question, const Allowed& allowed,
                const Meet& meet) {
  const bool any = question.asked.mode == HitMode::any;
  visit_scene(scene, near, question.walk, allowed,
              [&](std::uint32_t triangle, std::uint32_t part, const Triangle& corners) {
                return !question.deadline.is_over() && !(meet(triangle, part, corners).yes && any);
              });
}

/// The deepest contact of a ball is with the nearest triangle, so in a scene of one part no triangle farther than the
/// deepest known needs a test.
template <class Allowed, class Meet>
void meet_scene(const Sphere& asked, const Aabb&, const StaticScene& scene, Question& question, const Allowed& allowed,
                const Meet& meet) {
  const bool any = question.asked.mode == HitMode::any;
  double limit_m2 = square_up(asked.radius_m);
  visit_scene_near(scene, asked.center, limit_m2, question.walk, allowed,
                   [&](std::uint32_t triangle, std::uint32_t part, const Triangle& corners) {
                     if (question.deadline.is_over()) return -1.0;
                     const ContactSearch& touch = meet(triangle, part, corners);
                     if (touch.yes && any) return -1.0;
                     if (touch.yes && scene.parts.size() == 1) {
                       const double nearest_m = asked.radius_m - touch.contact.depth_m;
                       limit_m2 = std::min(limit_m2, square_up(reported_at_most(nearest_m, asked.radius_m)));
                     }
                     return limit_m2;
                   });
}

/// The queried shape is A of each contact: normals point away from it. In mode `any` the first triangle or primitive
/// that it meets ends the search, without computing a contact: depth 0 with an infinite bound.
template <class Asked>
void ask_overlap(Question& question, const Asked& asked, const GivenPart& given, const Aabb& near) {
  question.found.clear();
  const bool any = question.asked.mode == HitMode::any;
  const double asked_placing_m = given.pose != nullptr ? given.placing_error_m(0) : 0;
  const auto ended = [&] { return (any && !question.found.empty()) || question.deadline.was_over(); };
  const auto take = [&](ObjectId object, const ContactSearch& touch) {
    question.exact_tests += touch.exact_tests;
    question.level = std::max(question.level, touch.level);
    if (touch.undecided && !touch.yes) question.undecided = true;
    if (!touch.yes) return;
    question.found.push_back(
        {.object = object,
         .triangle = touch.b_triangle,
         .flags = question.flags_of(object),
         .distance_m = touch.contact.depth_m,
         .error_m = any ? std::numeric_limits<double>::infinity() : touch.contact.depth_error_m + asked_placing_m,
         .point = touch.contact.point,
         .normal = touch.contact.normal});
  };
  // Reused from question to question, so that no answer allocates once it has grown.
  thread_local PartContacts touches(true);
  const SceneList& scenes = question.snapshot.scenes;
  scenes.walk_box(near, question.walk, [&](std::size_t index) {
    const auto& scene = scenes[index];
    touches.clear(!any);
    const auto allowed = [&](std::uint32_t part) { return question.allows_part(*scene, part); };
    const auto meet = [&](std::uint32_t triangle, std::uint32_t part, const Triangle& corners) -> const ContactSearch& {
      ContactSearch& touch = touches.of(part);
      search_parts(asked, kNoTriangle, corners, triangle - scene->parts[part].first_triangle, touch,
                   {given, GivenPart{}});
      return touch;
    };
    meet_scene(asked, near, *scene, question, allowed, meet);
    visit_solid_parts(*scene, near, question, [&](const SolidPart& part, const Placed& object) {
      meet_solid(asked, *part.solid, object, touches.of(part.part), question);
    });
    for (const PartContact& part : touches.list()) take(scene->part_objects[part.part], part.touch);
    return !ended();
  });
  if (ended() || !question.snapshot.grid) return;
  const Primitive primitive = asked;
  const auto candidate = [&](std::uint32_t slot) {
    if (!question.allows(question.object(slot).id)) return true;
    ContactSearch touch;
    touch.wanted = !any;
    touch.deadline = &question.deadline;
    const Placed object = question.placed_without_bounds(slot);
    search_object(primitive, given, object, touch, question.walk);
    if (touch.yes && touch.wanted)
      touch.contact.depth_error_m += placing_error_m(object, touch.b_triangle, bounds(asked));
    if (object.info->rare->solid) meet_solid(asked, *object.info->rare->solid, object, touch, question);
    take(question.object(slot).id, touch);
    return !ended();
  };
  question.snapshot.grid->walk_box(near, candidate, question.walk);
}

}  // namespace

void ask_sphere(Question& question, const double* n) {
  const Sphere asked = sphere_of(n);
  ask_overlap(question, asked, GivenPart{}, bounds(asked));
  finish_overlap(question);
}

void ask_box(Question& question, const double* n) {
  const BoxQuestionShape asked(n);
  ask_overlap(question, asked.placed(), asked.given(), asked.bounds());
  finish_overlap(question);
}

}  // namespace collided::engine
