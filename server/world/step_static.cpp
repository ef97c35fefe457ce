#include <algorithm>

#include "server/world/scene_touch.hpp"
#include "server/world/step.hpp"

namespace collided {
namespace {

using wire_contract::kNoTriangle;

}  // namespace

void Step::moving_against_static() {
  for (const std::uint32_t slot : s.moved_slots) {
    for (std::size_t scene = 0; scene < s.scenes.size(); ++scene) {
      // Most movers of a large world are nowhere near a given scene.
      if (!overlaps(s.swept_bounds[slot], s.scenes[scene]->tree.bounds())) continue;
      const ObjectInfo* info = (*s.objects)[slot].get();
      if (info == nullptr || !info->moving) continue;
      if (!has_room()) {
        s.cost.truncated = true;
        return;
      }
      test_scene(slot, scene);
    }
  }
}

void Step::test_scene(std::uint32_t mover, std::size_t scene_number) {
  if (is_bare_mesh(mover) && s.apart.holds(mover, partner_of(scene_number))) {
    ++s.cost.kept_apart;
    return;
  }
  const StaticScene& scene = *s.scenes[scene_number];
  const Placed a = placed(mover);
  const auto allowed = [&](std::uint32_t part) { return may_meet(a.info->filter, scene.parts[part].filter); };
  s.part_touches.clear(wishes.contacts);
  const auto test = [&](const auto& part_of_a, std::uint32_t a_triangle) {
    visit_scene(scene, bounds(part_of_a), walk, allowed, [&](std::uint32_t triangle, std::uint32_t part, const Triangle& b) {
      Touch& touch = s.part_touches.of(part);
      if (!touch.done()) touch_parts(part_of_a, a_triangle, b, triangle - scene.parts[part].first_triangle, touch);
      return true;
    });
  };
  for (const Primitive& primitive : a.info->primitives) {
    std::visit([&](const auto& own) { test(place(*a.frame, own), kNoTriangle); }, primitive);
  }
  if (a.info->mesh && overlaps(a.bounds, scene.tree.bounds())) {
    test_mesh_against(a, scene);
  }
  s.part_sweeps.clear();
  if (const std::optional<MovingSphere> way = way_of(mover)) {
    sweep_sphere_parts(*way, *a.info, scene);
  } else if (s.fast[mover] != 0) {
    sweep_scene_parts(mover, scene);
  }
  // Parts that are met on the way but not at its end need a place in the list too.
  for (const PartSweep& sweep : s.part_sweeps) s.part_touches.of(sweep.part);
  for (PartTouch& found : s.part_touches.list()) {
    s.cost.exact_tests += found.touch.exact_tests;
    const auto sweep = std::find_if(s.part_sweeps.begin(), s.part_sweeps.end(),
                                    [&](const PartSweep& of) { return of.part == found.part; });
    report(a.info->id, scene.part_objects[found.part], found.touch,
           sweep != s.part_sweeps.end() ? &sweep->touch : nullptr, mover);
  }
  if (s.part_touches.list().empty() && is_bare_mesh(mover)) look_for_gap(mover, scene, partner_of(scene_number));
}

/// Contacts that hold need no time.
bool Step::is_sweepable(const ObjectInfo& mover, const StaticScene& scene, std::uint32_t part) const {
  const ObjectId id = scene.part_objects[part];
  return may_meet(mover.filter, scene.parts[part].filter) && !s.ledger.holds(std::min(mover.id, id), std::max(mover.id, id));
}

SweptTouch& Step::part_sweep(std::uint32_t part) {
  if (s.part_sweeps.empty() || s.part_sweeps.back().part != part) {
    const auto found = std::find_if(s.part_sweeps.begin(), s.part_sweeps.end(),
                                    [&](const PartSweep& sweep) { return sweep.part == part; });
    if (found != s.part_sweeps.end()) return found->touch;
    s.part_sweeps.push_back({.part = part, .touch = {}});
  }
  return s.part_sweeps.back().touch;
}

void Step::sweep_sphere_parts(const MovingSphere& way, const ObjectInfo& mover, const StaticScene& scene) {
  SphereSweep sweep{.mover = way, .width = s.options.sweep_width};
  visit_scene(scene, bounds(way), walk, [&](std::uint32_t part) { return is_sweepable(mover, scene, part); },
              [&](std::uint32_t triangle, std::uint32_t part, const Triangle& corners) {
                sweep.found = part_sweep(part);
                sweep_part(sweep, corners, triangle - scene.parts[part].first_triangle);
                part_sweep(part) = sweep.found;
                return true;
              });
}

void Step::sweep_scene_parts(std::uint32_t mover, const StaticScene& scene) {
  struct Context {
    Step& step;
    const ObjectInfo& mover;
    const StaticScene& scene;
  } context{*this, *(*s.objects)[mover], scene};
  const auto touch_of = [](void* raw, std::uint32_t triangle) -> SweptTouch* {
    const Context& c = *static_cast<Context*>(raw);
    const std::uint32_t part = c.scene.part_of(triangle);
    return c.step.is_sweepable(c.mover, c.scene, part) ? &c.step.part_sweep(part) : nullptr;
  };
  const SweptBody body(context.mover, body_way(mover));
  if (!sweep_scene(body, SweptBody(scene), sweep_options(mover), walk, touch_of, &context)) ++s.cost.sweeps_skipped;
  for (PartSweep& sweep : s.part_sweeps) sweep.touch.b_triangle -= sweep.touch.yes ? scene.parts[sweep.part].first_triangle : 0;
}

void Step::test_mesh_against(const Placed& a, const StaticScene& scene) {
  std::size_t open_parts = 0;
  for (const Part& part : scene.parts) open_parts += may_meet(a.info->filter, part.filter) ? 1 : 0;
  const auto visit = [&](std::uint32_t triangle, const Triangle& b, std::uint32_t a_triangle, const Triangle& own) {
    const std::uint32_t number = scene.part_of(triangle);
    const Part& part = scene.parts[number];
    if (!may_meet(a.info->filter, part.filter)) return true;
    Touch& touch = s.part_touches.of(number);
    if (touch.done()) return true;
    touch_parts(own, a_triangle, b, triangle - part.first_triangle, touch);
    if (touch.done()) --open_parts;
    return open_parts > 0;
  };
  visit_scene_pairs(scene, *a.info->mesh, *a.frame, walk, visit);
}

}  // namespace collided
