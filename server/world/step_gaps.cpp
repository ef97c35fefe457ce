#include "server/world/scene_touch.hpp"
#include "server/world/step.hpp"

namespace collided {
namespace {

/// A gap is looked for that is used up after so many steps like this one, so that looking for it pays.
constexpr double kGapInSteps = 16;

}  // namespace

/// What is remembered of meshes hangs on how far they go; that of a placed triangle is off by a rounding at either end.
void Step::count_way(std::uint32_t slot) {
  if (!(*s.objects)[slot] || !is_bare_mesh(slot)) return;
  if (s.motion[slot] != Motion::moved) {
    s.apart.placed(slot);
    return;
  }
  const double reach_m = (*s.objects)[slot]->mesh->radius_m;
  s.apart.moved(slot, longest_way_m(s.frames_before[slot], s.frames[slot], reach_m) * (1 + 0x1p-40) +
                          placement_slack(s.frames_before[slot], 0, reach_m) + placement_slack(s.frames[slot], 0, reach_m));
}

/// Of both together; not where one of them does not go on as it went.
double Step::gap_wanted_m(std::uint32_t slot) const {
  if (s.motion[slot] != Motion::moved) return 0;
  return kGapInSteps * longest_way_m(s.frames_before[slot], s.frames[slot], (*s.objects)[slot]->mesh->radius_m);
}

void Step::remember_gap(std::uint32_t slot, std::uint32_t partner, double gap_m, bool there_is) {
  if (there_is) s.apart.remember(slot, partner, gap_m);
  else s.apart.looked_in_vain(slot, partner);
}

void Step::look_for_gap(std::uint32_t first, std::uint32_t second) {
  const double gap_m = gap_wanted_m(first) + gap_wanted_m(second);
  if (!(gap_m > 0) || !s.apart.is_worth_looking(first, second)) return;
  bool there_is = true;
  const auto candidate = [](void* raw, std::uint32_t, std::uint32_t) { return *static_cast<bool*>(raw) = false; };
  walk_mesh_pairs(placed(first), placed(second), candidate, &there_is, walk, gap_m);
  remember_gap(first, second, gap_m, there_is);
}

void Step::look_for_gap(std::uint32_t mover, const StaticScene& scene, std::uint32_t partner) {
  const double gap_m = gap_wanted_m(mover);
  if (!(gap_m > 0) || !s.apart.is_worth_looking(mover, partner)) return;
  const ObjectInfo& info = *(*s.objects)[mover];
  bool there_is = true;
  const auto visit = [&](std::uint32_t triangle, const Triangle&, std::uint32_t, const Triangle&) {
    there_is = !may_meet(info.filter, scene.parts[scene.part_of(triangle)].filter);
    return there_is;
  };
  visit_scene_pairs(scene, *info.mesh, s.frames[mover], walk, visit, gap_m);
  remember_gap(mover, partner, gap_m, there_is);
}

}  // namespace collided
