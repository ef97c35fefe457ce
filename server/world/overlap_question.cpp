#include "server/world/question.hpp"

namespace collided {
namespace {

/// The asked shape is A of each contact: normals point from it to what it meets.
template <class Asked>
void ask_overlap(Question& question, const Asked& asked) {
  question.found.clear();
  const auto take = [&](ObjectId object, const Touch& touch) {
    question.exact_tests += touch.exact_tests;
    question.level = std::max(question.level, touch.level);
    if (touch.undecided && !touch.yes) question.undecided = true;
    if (!touch.yes) return;
    question.found.push_back({.object = object,
                              .triangle = touch.b_triangle,
                              .flags = question.flags_of(object),
                              .distance_m = touch.contact.depth_m,
                              .error_m = touch.contact.depth_error_m,
                              .point = touch.contact.point,
                              .normal = touch.contact.normal});
  };
  for (const auto& scene : question.snapshot.scenes) {
    PartTouches touches(true);
    visit_scene(
        *scene, bounds(asked), question.walk, [&](std::uint32_t part) { return question.allows_part(*scene, part); },
        [&](std::uint32_t triangle, std::uint32_t part, const Triangle& corners) {
          const std::uint32_t own = triangle - scene->parts[part].first_triangle;
          touch_parts(asked, wire_contract::kNoTriangle, corners, own, touches.of(part));
          return true;
        });
    for (const PartTouch& part : touches.list()) take(scene->part_objects[part.part], part.touch);
  }
  if (!question.snapshot.grid) return;
  const Primitive primitive = asked;
  auto visit = [&](std::uint32_t slot) {
    if (!question.allows(question.object(slot).id)) return;
    Touch touch;
    touch_object(primitive, question.placed(slot), touch, question.walk);
    take(question.object(slot).id, touch);
  };
  const auto candidate = [](void* raw, std::uint32_t slot) {
    (*static_cast<decltype(visit)*>(raw))(slot);
    return true;
  };
  question.snapshot.grid->walk_box(bounds(asked), candidate, &visit, question.walk);
}

/// Deepest first; ties by object.
void finish_overlap(Question& question) {
  std::sort(question.found.begin(), question.found.end(), [](const AnswerHit& a, const AnswerHit& b) {
    return a.distance_m != b.distance_m ? a.distance_m > b.distance_m : a.object < b.object;
  });
  if (question.found.size() > question.asked.max_hits) {
    question.found.resize(question.asked.max_hits);
    question.truncated = true;
  }
}

}  // namespace

void ask_sphere(Question& question, const double* n) {
  ask_overlap(question, Sphere{.center = {n[0], n[1], n[2]}, .radius_m = n[3]});
  finish_overlap(question);
}

void ask_box(Question& question, const double* n) {
  const Pose pose{.position = {n[0], n[1], n[2]}, .rotation = Quat(n[6], n[7], n[8], n[9])};
  ask_overlap(question, Box{.center = pose.position, .axes = frame_of(pose).rotation, .half_m = {n[3], n[4], n[5]}});
  finish_overlap(question);
}

}  // namespace collided
