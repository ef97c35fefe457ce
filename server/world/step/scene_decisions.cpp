// Pairs of a mover and a static scene: decides all parts of the scene that the mover touches, in one walk.

#include <algorithm>

#include "server/world/objects/scene_touch.hpp"
#include "server/world/step/decisions.hpp"

namespace collided::engine {

void Decisions::decide_scene(std::uint32_t mover, std::size_t scene_number) {
  if (is_bare_mesh(mover) && apart_.holds(mover, partner_of(scene_number))) {
    ++cost_.kept_apart;
    return;
  }
  const StaticScene& scene = *step_.scenes[scene_number];
  const Placed a = placed(mover);
  touch_scene(a, scene);
  look_within_scene(a, scene);
  sweep_through(mover, scene);
  for (PartContact& found : lists_.part_touches.list()) {
    cost_.exact_tests += found.touch.exact_tests;
    const auto sweep = std::find_if(lists_.part_sweeps.begin(), lists_.part_sweeps.end(),
                                    [&](const PartSweep& of) { return of.part == found.part; });
    const auto within = std::find_if(lists_.parts_within.begin(), lists_.parts_within.end(),
                                     [&](const PartWithin& of) { return of.part == found.part; });
    report(a.info->id, scene.part_objects[found.part], found.touch,
           sweep != lists_.part_sweeps.end() ? &sweep->touch : nullptr, mover,
           within != lists_.parts_within.end() ? within->contained : Contained::none);
  }
  if (lists_.part_touches.list().empty() && is_bare_mesh(mover)) look_for_gap(mover, scene, partner_of(scene_number));
}

/// Collects in part_touches the parts that the mover touches at its pose.
void Decisions::touch_scene(const Placed& a, const StaticScene& scene) {
  const auto allowed = [&](std::uint32_t part) { return may_meet(a.info->filter, scene.parts[part].filter); };
  lists_.part_touches.clear(step_.step_options.contacts);
  const auto test = [&](const auto& part_of_a, const Primitive& own) {
    const GivenPart given = a.given(own);
    visit_scene(scene, bounds_as_given(a.frame, own), walk_, allowed,
                [&](std::uint32_t triangle, std::uint32_t part, const Triangle& b) {
                  ContactSearch& touch = lists_.part_touches.of(part);
                  if (!touch.done())
                    search_parts(part_of_a, kNoTriangle, b, triangle - scene.parts[part].first_triangle, touch,
                                 {given, GivenPart{}});
                  return true;
                });
  };
  for (const Primitive& primitive : a.info->primitives) {
    std::visit([&](const auto& own) { test(place(a.frame, own), primitive); }, primitive);
  }
  if (a.info->mesh && overlaps(a.bounds, scene.tree.bounds())) touch_scene_with_mesh(a, scene);
}

/// Collects in part_sweeps the parts that the mover meets during its motion. Parts not touched at its end need an entry
/// in part_touches too, since decide_scene() reports from there.
void Decisions::sweep_through(std::uint32_t mover, const StaticScene& scene) {
  lists_.part_sweeps.clear();
  if (const std::optional<MovingSphere> motion = motion_.sphere_motion(mover)) {
    sweep_sphere_parts(*motion, *rows_.info(mover), scene);
  } else if (motion_.is_swept(mover)) {
    sweep_parts(mover, scene);
  }
  for (const PartSweep& sweep : lists_.part_sweeps) lists_.part_touches.of(sweep.part);
}

/// Only pairs without a contact need a first time.
bool Decisions::is_sweepable(const ObjectInfo& mover, const StaticScene& scene, std::uint32_t part) const {
  const ObjectId id = scene.part_objects[part];
  return may_meet(mover.filter, scene.parts[part].filter) &&
         !ledger_.holds(std::min(mover.id, id), std::max(mover.id, id));
}

/// The sweep of a part, begun if there is none; the reference is valid until the next call.
SweptContact& Decisions::part_sweep(std::uint32_t part) {
  if (lists_.part_sweeps.empty() || lists_.part_sweeps.back().part != part) {
    const auto found = std::find_if(lists_.part_sweeps.begin(), lists_.part_sweeps.end(),
                                    [&](const PartSweep& sweep) { return sweep.part == part; });
    if (found != lists_.part_sweeps.end()) return found->touch;
    lists_.part_sweeps.push_back({.part = part, .touch = {}});
  }
  return lists_.part_sweeps.back().touch;
}

void Decisions::sweep_sphere_parts(const MovingSphere& motion, const ObjectInfo& mover, const StaticScene& scene) {
  SphereSweep sweep{.mover = motion, .width = step_.options.sweep_width};
  visit_scene(
      scene, bounds(motion), walk_, [&](std::uint32_t part) { return is_sweepable(mover, scene, part); },
      [&](std::uint32_t triangle, std::uint32_t part, const Triangle& corners) {
        sweep.found = part_sweep(part);
        sweep_part(sweep, corners, triangle - scene.parts[part].first_triangle);
        part_sweep(part) = sweep.found;
        return true;
      });
}

void Decisions::sweep_parts(std::uint32_t mover, const StaticScene& scene) {
  const ObjectInfo& info = *rows_.info(mover);
  const auto touch_of = [&](std::uint32_t triangle) {
    const std::uint32_t part = scene.part_of(triangle);
    return is_sweepable(info, scene, part) ? &part_sweep(part) : nullptr;
  };
  const SweptBody body(info, motion_.body_motion(mover));
  if (!sweep_scene(body, SweptBody(scene), sweep_options(mover), walk_, touch_of)) ++cost_.sweeps_skipped;
  // The search numbers triangles within the scene; contacts number them within the part.
  for (PartSweep& sweep : lists_.part_sweeps)
    sweep.touch.b_triangle -= sweep.touch.yes ? scene.parts[sweep.part].first_triangle : 0;
}

void Decisions::touch_scene_with_mesh(const Placed& a, const StaticScene& scene) {
  std::size_t open_parts = 0;
  for (const Part& part : scene.parts) open_parts += may_meet(a.info->filter, part.filter) ? 1 : 0;
  const auto visit = [&](std::uint32_t triangle, const Triangle& b, std::uint32_t a_triangle, const Triangle& own) {
    const std::uint32_t number = scene.part_of(triangle);
    const Part& part = scene.parts[number];
    if (!may_meet(a.info->filter, part.filter)) return true;
    ContactSearch& touch = lists_.part_touches.of(number);
    if (touch.done()) return true;
    const GivenPart given = a.given(a_triangle);
    search_parts(own, a_triangle, b, triangle - part.first_triangle, touch, {given, GivenPart{}});
    if (touch.done()) --open_parts;
    return open_parts > 0;
  };
  visit_scene_pairs(scene, *a.info->mesh, a.frame, walk_, visit);
}

}  // namespace collided::engine
