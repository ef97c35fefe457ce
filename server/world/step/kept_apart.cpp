#include "server/world/objects/scene_touch.hpp"
#include "server/world/step/decisions.hpp"

namespace collided::engine {
namespace {

/// Searches for a gap that lasts for this many steps at the present speed: a smaller one would not repay the search.
constexpr double kGapInSteps = 16;

}  // namespace

/// For one object: 0 if it has no motion to extrapolate.
double Decisions::gap_wanted_m(std::uint32_t slot) const {
  return kGapInSteps * motion_.longest_displacement_m(slot, rows_.info(slot)->mesh->radius_m);
}

void Decisions::remember_gap(std::uint32_t slot, std::uint32_t partner, double gap_m, bool there_is) {
  const GapFound found{.slot = slot, .partner = partner, .gap_m = gap_m, .there_is = there_is};
  if (StepBlock* const block = ledger_.block()) block->gaps.push_back(found);
  else apart_.note(found);
}

void Decisions::look_for_gap(std::uint32_t first, std::uint32_t second) {
  const double gap_m = gap_wanted_m(first) + gap_wanted_m(second);
  if (!(gap_m > 0) || !apart_.is_worth_looking(first, second)) return;
  bool there_is = true;
  const auto candidate = [&](std::uint32_t, std::uint32_t) { return there_is = false; };
  walk_mesh_pairs(placed(first), placed(second), candidate, kNeverOver, walk_, gap_m);
  remember_gap(first, second, gap_m, there_is);
}

void Decisions::look_for_gap(std::uint32_t mover, const StaticScene& scene, std::uint32_t partner) {
  const double gap_m = gap_wanted_m(mover);
  if (!(gap_m > 0) || !apart_.is_worth_looking(mover, partner)) return;
  const ObjectInfo& info = *rows_.info(mover);
  bool there_is = true;
  const auto visit = [&](std::uint32_t triangle, const Triangle&, std::uint32_t, const Triangle&) {
    there_is = !may_meet(info.filter, scene.parts[scene.part_of(triangle)].filter);
    return there_is;
  };
  visit_scene_pairs(scene, *info.mesh, rows_[mover].frame(), Vec3::Zero(), walk_, visit, gap_m);
  remember_gap(mover, partner, gap_m, there_is);
}

}  // namespace collided::engine
