#include "server/world/explain/fence_explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <collided/explanations.hpp>

#include "idl/glob.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/explain/ray_explanation.hpp"
#include "server/world/groups/members.hpp"
#include "server/world/groups/object_clearance.hpp"

namespace collided::engine {
namespace {

/// A lower bound on the distance of what two boxes hold.
double least_distance_m(const Aabb& a, const Aabb& b) {
  const Vec3 gap = (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0);
  return gap.norm() * (1 - kBoundSlack);
}

class FenceSearch {
 public:
  FenceSearch(const Snapshot& snapshot, const FenceLook& fence, const FenceExplanationAsk& ask, PartMeshes& part_meshes,
              Deadline& deadline)
      : snapshot_(snapshot), fence_(fence), ask_(ask), members_(snapshot, part_meshes), deadline_(deadline) {}

  ExplainedFence run() {
    tell_rule();
    told_.placed = place_fence();
    for (const auto& info : snapshot_.objects) {
      if (info) consider(*info);
    }
    if (told_.placed) {
      for (const Outsider& one : outsiders_in_order()) look_at(one);
    }
    std::stable_sort(
        told_.inside.begin(), told_.inside.end(),
        [](const ExplainedStanding& a, const ExplainedStanding& b) { return a.clearance_m < b.clearance_m; });
    told_.late = deadline_.was_over();
    return std::move(told_);
  }

 private:
  struct Outsider {
    std::uint32_t number = 0;  // among the members
    double at_least_m = 0;
    std::string why_not;
  };

  void tell_rule() {
    told_.fence = fence_.name;
    told_.kind = kind_of(fence_.body);
    told_.to = fence_.rule.carrier;
    told_.only = fence_.rule.only;
    told_.skip = fence_.rule.skip;
    told_.mask = fence_.rule.mask;
    for (const auto& [word, bit] : kTellsWords) {
      if ((fence_.rule.tells & bit) != 0) told_.tells.emplace_back(word);
    }
    told_.keep = fence_.rule.owner == 0;
    told_.world_time = std::chrono::nanoseconds(snapshot_.world_time_ns);
    told_.version = snapshot_.version;
  }
  /// False: its carrier is not there.
  bool place_fence() {
    placed_ = {.info = &fence_.body, .frame = {}, .bounds = {}, .pose = &world_pose_};
    if (!fence_.rule.carrier.empty()) {
      const auto carrier = std::find_if(snapshot_.objects.begin(), snapshot_.objects.end(),
                                        [&](const auto& info) { return info && info->name == fence_.rule.carrier; });
      if (carrier == snapshot_.objects.end()) return false;
      const std::uint32_t slot = slot_of((*carrier)->id);
      placed_.frame = snapshot_.frame(slot);
      placed_.pose = snapshot_.has_given_poses ? &snapshot_.poses[slot] : nullptr;
      // Distances are to the object itself.
      if (is_of_nearest()) placed_.info = carrier->get();
    }
    placed_.bounds = bounds_of(*placed_.info, placed_.frame);
    return true;
  }
  bool is_of_nearest() const { return fence_.rule.nearest.has_value(); }
  /// What stands still fills a world; only what might have been meant is worth a look.
  bool might_be_meant(const ObjectInfo& info) const {
    return info.moving || (is_of_nearest() && wire_contract::glob_matches(fence_.rule.only, info.name));
  }
  const OpenContact* told_in(ObjectId id) const {
    const auto found =
        std::find_if(fence_.inside.begin(), fence_.inside.end(), [&](const OpenContact& open) { return open.a == id; });
    return found == fence_.inside.end() ? nullptr : &*found;
  }
  void consider(const ObjectInfo& info) {
    std::string why_not = why_not_looked_at(fence_.rule, info);
    if (why_not.empty()) ++told_.looked_at;
    const OpenContact* told = told_in(info.id);
    const bool is_asked_for = ask_.why_not == info.id;
    if (!why_not.empty() && !might_be_meant(info) && !is_asked_for && told == nullptr) return;
    // What the distances are to is at no distance.
    if (is_of_nearest() && info.name == fence_.rule.carrier && !is_asked_for) return;
    const std::uint32_t number = members_.add(info.id);
    if (told != nullptr || is_asked_for) {
      ExplainedStanding standing =
          standing_of(number, kNoLimit_m, true)
              .value_or(ExplainedStanding{.object = info.name, .clearance_m = kNoLimit_m, .error_m = kNoLimit_m});
      standing.why_left_out = std::move(why_not);
      if (told != nullptr) {
        standing.told = true;
        standing.since = std::chrono::nanoseconds(told->began_ns);
        standing.episode = told->episode;
        standing.doubt = std::string(name_of(told->doubt));
      }
      if (is_asked_for) told_.asked_for = standing;
      if (told != nullptr) told_.inside.push_back(std::move(standing));
    } else if (!members_.bounds(number).empty()) {
      outsiders_.push_back({number, least_distance_m(members_.bounds(number), placed_.bounds), std::move(why_not)});
    }
  }
  const std::vector<Outsider>& outsiders_in_order() {
    std::stable_sort(outsiders_.begin(), outsiders_.end(),
                     [](const Outsider& a, const Outsider& b) { return a.at_least_m < b.at_least_m; });
    return outsiders_;
  }
  void look_at(const Outsider& one) {
    if (!one.why_not.empty()) return look_at_left_out(one);
    const bool is_full = told_.outside.size() >= ask_.most_outside;
    const double limit_m = !is_full ? kNoLimit_m : told_.outside.empty() ? -1 : told_.outside.back().clearance_m;
    if (one.at_least_m > limit_m) return;
    const std::optional<ExplainedStanding> standing = standing_of(one.number, limit_m, false);
    if (!standing) return;
    const auto nearer = [](const auto& a, const auto& b) { return a.clearance_m < b.clearance_m; };
    told_.outside.insert(std::upper_bound(told_.outside.begin(), told_.outside.end(), *standing, nearer), *standing);
    if (told_.outside.size() > ask_.most_outside) told_.outside.pop_back();
  }
  void look_at_left_out(const Outsider& one) {
    const double limit_m = left_out_limit_m();
    if (one.at_least_m > limit_m || told_.left_out.size() >= ask_.most_left_out) return;
    std::optional<ExplainedStanding> standing = standing_of(one.number, limit_m, true);
    if (!standing || (is_of_nearest() ? standing->clearance_m > limit_m : standing->verdict == collided::Verdict::miss))
      return;
    standing->why_left_out = one.why_not;
    told_.left_out.push_back(std::move(*standing));
  }
  /// What is left out is told of in a fence, and where it is nearer than the nearest.
  double left_out_limit_m() const {
    if (!is_of_nearest()) return 0;
    return told_.inside.empty() ? fence_.rule.nearest->within_m : told_.inside.front().clearance_m;
  }
  /// Nothing where it is surely farther than the limit, or the deadline is over.
  std::optional<ExplainedStanding> standing_of(std::uint32_t number, double limit_m, bool with_depth) {
    ExplainedStanding standing{.object = members_.info(number).name,
                               .clearance_m = kNoLimit_m,
                               .error_m = kNoLimit_m,
                               .stale = members_.is_stale(number)};
    if (placed_.bounds.empty() || members_.bounds(number).empty()) return standing;
    WalkCost cost;
    const std::optional<ObjectClearance> found = clearance_between(
        placed_, members_.placed(number, deadline_), {.limit_m = limit_m, .depth = with_depth}, cost, deadline_);
    if (!found || deadline_.was_over()) return std::nullopt;
    standing.verdict = static_cast<collided::Verdict>(found->touches);
    standing.clearance_m = found->clearance_m;
    standing.error_m = found->error_m;
    if (found->touches == Decision::no && found->clearance_m < kNoLimit_m) {
      standing.on_fence = found->on_a;
      standing.on_object = found->on_b;
    }
    return standing;
  }

  const Snapshot& snapshot_;
  const FenceLook& fence_;
  const FenceExplanationAsk& ask_;
  Members members_;
  Deadline& deadline_;
  static constexpr double kNoLimit_m = std::numeric_limits<double>::infinity();

  const Pose world_pose_;
  Placed placed_;
  std::vector<Outsider> outsiders_;
  ExplainedFence told_;
};

}  // namespace

namespace {

FenceLook look_at_slot(const Fences& fences, std::uint32_t slot) {
  const FenceTable& table = fences.table();
  FenceLook look{.id = table.id(slot),
                 .name = table.name(slot),
                 .rule = table.rule(slot),
                 .body = table.described(slot),
                 .inside = {},
                 .cut_short = fences.cut_short(slot)};
  for (const OpenContact& open : fences.inside()) {
    if (open.b == look.id) look.inside.push_back(open);
  }
  return look;
}

}  // namespace

std::optional<FenceLook> look_at_fence(const Fences& fences, std::string_view name) {
  const FenceTable& table = fences.table();
  const std::optional<std::uint32_t> slot = table.find(name);
  if (!slot || !table.has_bounds(*slot) || table.is_band(*slot)) return std::nullopt;
  return look_at_slot(fences, *slot);
}

std::optional<FenceLook> look_at_nearest(const Fences& fences, std::string_view name) {
  const std::optional<std::uint32_t> slot = fences.table().find(name);
  if (!slot || !fences.table().is_nearest(*slot)) return std::nullopt;
  return look_at_slot(fences, *slot);
}

std::string why_not_looked_at(const FenceRule& rule, const ObjectInfo& object) {
  const char* const who = rule.nearest ? "question" : "fence";
  if (rule.nearest && object.scene_part != kNoScenePart) return "it is a part of a loaded scene";
  if (!rule.nearest && !object.moving) return "it does not move";
  if (!rule.carrier.empty() && rule.carrier == object.name)
    return rule.nearest ? "the distances are to it" : "it carries the fence";
  const bool has_band_of_either_group = rule.band && wire_contract::glob_matches(rule.band->around, object.name);
  if (!has_band_of_either_group && (object.filter.layers & rule.mask) == 0)
    return fmt::format("its layers {:#x} are not in the {}'s mask {:#x}", object.filter.layers, who, rule.mask);
  if (!rule.skip.empty() && wire_contract::glob_matches(rule.skip, object.name))
    return fmt::format("the {} leaves '{}' out", who, rule.skip);
  if (!has_band_of_either_group && !rule.only.empty() && !wire_contract::glob_matches(rule.only, object.name))
    return fmt::format("the {} looks at '{}' alone", who, rule.only);
  return {};
}

ExplainedFence explain_fence(const Snapshot& snapshot, const FenceLook& fence, const FenceExplanationAsk& ask,
                             PartMeshes& part_meshes, Deadline& deadline) {
  const OwnFloatEnvironment own_floats;
  return FenceSearch(snapshot, fence, ask, part_meshes, deadline).run();
}

}  // namespace collided::engine
