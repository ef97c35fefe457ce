// Pairs of a mover and a static scene: decides all parts of the scene that the mover touches, in one walk.

#include <algorithm>

#include "server/geometry/common_origin.hpp"
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
  lists_.part_touches.clear(step_.step_options.contacts);
  touch_scene(a, scene, lists_.part_touches);
  look_within_scene(a, scene);
  sweep_through(mover, scene);
  for (PartContact& found : lists_.part_touches.list()) {
    cost_.exact_tests += found.touch.exact_tests;
    const auto sweep = std::find_if(lists_.part_sweeps.begin(), lists_.part_sweeps.end(),
                                    [&](const PartSweep& of) { return of.part == found.part; });
    const auto within = std::find_if(lists_.parts_within.begin(), lists_.parts_within.end(),
                                     [&](const PartWithin& of) { return of.part == found.part; });
    const SweptContact* const first = sweep != lists_.part_sweeps.end() ? &sweep->touch : nullptr;
    WithinSolid inside;
    if (within != lists_.parts_within.end()) inside = {true, within->contained};
    if (decide_part(mover, scene, found, first, inside)) continue;
    report(a.info->id, scene.part_objects[found.part], found.touch, first, mover, inside.contained);
  }
  if (lists_.part_touches.list().empty() && is_bare_mesh(mover)) look_for_gap(mover, scene, partner_of(scene_number));
}

/// Reports all contacts of the mover and a part before it reaches its pose. False: they have none besides that at the
/// pose.
bool Decisions::decide_part(std::uint32_t mover, const StaticScene& scene, const PartContact& found,
                            const SweptContact* sweep, const WithinSolid& within) {
  const std::uint32_t part = slot_of(scene.part_objects[found.part]);
  const bool is_turned = rows_.has_lower_id(part, mover);
  const std::uint32_t first = is_turned ? part : mover;
  const std::uint32_t second = is_turned ? mover : part;
  const bool is_met = sweep != nullptr && sweep->yes;
  if (!found.touch.yes && !is_met && !ledger_.holds(rows_.id(first), rows_.id(second))) return false;
  std::optional<PairPiece> piece = piece_of_step(first, second);
  if (!piece) return false;
  piece->scene = &scene;
  SweptContact met;
  if (is_met) met = is_turned ? turned_round(*sweep) : *sweep;
  return decide_intervals(*piece, is_turned ? turned_round(found.touch) : found.touch,
                          {within.is_some, is_turned ? turned_round(within.contained) : within.contained},
                          is_met ? &met : nullptr);
}

/// Tests the mover at a frame against the part of the piece, like Decisions::touch_at.
ContactSearch Decisions::touch_part(const PairPiece& piece, const Frame& frame, WithinSolid* within) {
  const bool is_turned = rows_.info(piece.a)->scene_part != kNoScenePart;
  const std::uint32_t mover = is_turned ? piece.b : piece.a;
  const std::uint32_t part = rows_.info(is_turned ? piece.a : piece.b)->scene_part;
  const Placed a{.info = rows_.info(mover), .frame = frame, .bounds = bounds_of(*rows_.info(mover), frame)};
  lists_.touches_between.clear(true);
  touch_scene(a, *piece.scene, lists_.touches_between, part);
  ContactSearch touch = lists_.touches_between.of(part);
  cost_.exact_tests += touch.exact_tests;
  if (within != nullptr && !touch.yes) {
    within->contained = look_within_part_at(a, *piece.scene, part, touch);
    if (is_turned) within->contained = turned_round(within->contained);
    within->is_some = touch.yes;
  }
  return is_turned ? turned_round(touch) : touch;
}

/// The first contact of the mover and the part within a span of the piece.
SweptContact Decisions::sweep_part_piece(const PairPiece& piece, const TimeSpan& span, double width) {
  const bool is_turned = rows_.info(piece.a)->scene_part != kNoScenePart;
  const std::uint32_t mover = is_turned ? piece.b : piece.a;
  const BodyMotion& motion = is_turned ? piece.b_motion : piece.a_motion;
  const StaticScene& scene = *piece.scene;
  const std::uint32_t part = rows_.info(is_turned ? piece.a : piece.b)->scene_part;
  const std::optional<Sphere> sphere = rows_.lone_sphere(mover);
  SweptContact touch;
  if (sphere && span.low == 0 && span.high == 1) {
    SphereSweep sweep{.mover = {.start = place(motion.from, sphere->center),
                                .end = place(motion.to, sphere->center),
                                .radius_m = sphere->radius_m},
                      .width = step_.options.sweep_width};
    visit_scene(
        scene, bounds(sweep.mover), walk_, [&](std::uint32_t number) { return number == part; },
        [&](std::uint32_t triangle, std::uint32_t, const Triangle& corners) {
          sweep_part(sweep, corners, triangle);
          return true;
        });
    touch = sweep.found;
  } else {
    const SweepOptions options{
        .width = width, .span = span, .contacts = true, .most_looks = sweep_looks(), .looks = &cost_.sweep_looks};
    const auto touch_of = [&](std::uint32_t triangle) { return scene.part_of(triangle) == part ? &touch : nullptr; };
    if (!sweep_scene(SweptBody(*rows_.info(mover), motion), SweptBody(scene), options, walk_, touch_of))
      touch.undecided = touch.is_cut_short = true;
  }
  cost_.exact_tests += touch.exact_tests;
  if (touch.yes) touch.b_triangle -= scene.parts[part].first_triangle;
  return is_turned ? turned_round(touch) : touch;
}

/// Collects the parts that the mover touches at its pose; with `only`, just this one. Far from the world's origin both
/// are tested as seen from the mover's place.
///
/// touches  empty
void Decisions::touch_scene(const Placed& a, const StaticScene& scene, PartContacts& touches, std::uint32_t only) {
  const Vec3 origin = common_origin(scene, a.frame);
  const SeenPlaced seen(origin, a);
  const Placed& near = seen.placed();
  const auto allowed = [&](std::uint32_t part) {
    return (only == kNoScenePart || part == only) && may_meet(a.info->filter, scene.parts[part].filter);
  };
  const auto test = [&](const auto& part_of_a, const Primitive& own) {
    const GivenPart given = near.given(own);
    visit_scene(scene, bounds_as_given(a.frame, own), walk_, allowed,
                [&](std::uint32_t triangle, std::uint32_t part, const Triangle& b) {
                  ContactSearch& touch = touches.of(part);
                  if (!touch.done())
                    search_parts(part_of_a, kNoTriangle, seen_from(origin, b),
                                 triangle - scene.parts[part].first_triangle, touch, {given, GivenPart{}});
                  return true;
                });
  };
  for (const Primitive& primitive : a.info->primitives) {
    std::visit([&](const auto& own) { test(place(near.frame, own), primitive); }, primitive);
  }
  if (a.info->mesh && overlaps(a.bounds, scene.tree.bounds())) touch_scene_with_mesh(a, scene, touches, only);
  for (PartContact& found : touches.list()) found.touch.move_back_from(origin);
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

/// The sweep of a part, started if there is none; the reference is valid until the next call.
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

/// The contacts' points are relative to common_origin(scene, a.frame).
void Decisions::touch_scene_with_mesh(const Placed& a, const StaticScene& scene, PartContacts& touches,
                                      std::uint32_t only) {
  std::size_t open_parts = only == kNoScenePart ? 0 : 1;
  if (only == kNoScenePart) {
    for (const Part& part : scene.parts) open_parts += may_meet(a.info->filter, part.filter) ? 1 : 0;
  }
  const Vec3 origin = common_origin(scene, a.frame);
  const SeenPlaced seen(origin, a);
  const auto visit = [&](std::uint32_t triangle, const Triangle& b, std::uint32_t a_triangle, const Triangle& own) {
    const std::uint32_t number = scene.part_of(triangle);
    const Part& part = scene.parts[number];
    if ((only != kNoScenePart && number != only) || !may_meet(a.info->filter, part.filter)) return true;
    ContactSearch& touch = touches.of(number);
    if (touch.done()) return true;
    const GivenPart given = seen.placed().given(a_triangle);
    search_parts(own, a_triangle, b, triangle - part.first_triangle, touch, {given, GivenPart{}});
    if (touch.done()) --open_parts;
    return open_parts > 0;
  };
  visit_scene_pairs(scene, *a.info->mesh, a.frame, origin, walk_, visit);
}

}  // namespace collided::engine
