#include "server/world/explain/standing_explanation.hpp"

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

/// A lower bound on the distance between the contents of two boxes.
double least_distance_m(const Aabb& a, const Aabb& b) {
  const Vec3 gap = (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0);
  return gap.norm() * (1 - kBoundSlack);
}

class StandingSearch {
 public:
  StandingSearch(const Snapshot& snapshot, const StandingLook& standing, const StandingExplanationAsk& ask,
                 PartMeshes& part_meshes, Deadline& deadline)
      : snapshot_(snapshot), standing_(standing), ask_(ask), members_(snapshot, part_meshes), deadline_(deadline) {}

  ExplainedStanding run() {
    define();
    explained_.placed = place();
    for (const auto& info : snapshot_.objects) {
      if (info) consider(*info);
    }
    if (explained_.placed) {
      for (const Outsider& one : outsiders_in_order()) look_at(one);
    }
    std::stable_sort(explained_.holds.begin(), explained_.holds.end(),
                     [](const ExplainedObject& a, const ExplainedObject& b) { return a.clearance_m < b.clearance_m; });
    explained_.late = deadline_.was_over();
    return std::move(explained_);
  }

 private:
  struct Outsider {
    std::uint32_t number = 0;  // index among the members
    double at_least_m = 0;
    std::string why_not;
  };

  void define() {
    static_cast<DefinedStanding&>(explained_) = defined_standing(standing_.name, standing_.rule, standing_.body);
    explained_.cut_short = standing_.cut_short;
    explained_.world_time = std::chrono::nanoseconds(snapshot_.world_time_ns);
    explained_.version = snapshot_.version;
  }
  /// False if its carrier does not exist.
  bool place() {
    placed_ = {.info = &standing_.body, .frame = {}, .bounds = {}, .pose = &world_pose_};
    if (!standing_.rule.carrier.empty()) {
      const auto carrier = std::find_if(snapshot_.objects.begin(), snapshot_.objects.end(),
                                        [&](const auto& info) { return info && info->name == standing_.rule.carrier; });
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
  bool is_of_nearest() const { return standing_.rule.nearest.has_value(); }
  /// True for objects that the user can have meant: static objects are numerous, and never monitored.
  bool might_be_meant(const ObjectInfo& info) const {
    return info.moving || (is_of_nearest() && wire_contract::glob_matches(standing_.rule.only, info.name));
  }
  const OpenContact* reported_of(ObjectId id) const {
    const auto found = std::find_if(standing_.inside.begin(), standing_.inside.end(),
                                    [&](const OpenContact& open) { return open.a == id; });
    return found == standing_.inside.end() ? nullptr : &*found;
  }
  void consider(const ObjectInfo& info) {
    std::string why_not = why_not_looked_at(standing_.rule, info);
    if (why_not.empty()) ++explained_.looked_at;
    const OpenContact* reported = reported_of(info.id);
    const bool is_asked_for = ask_.why_not == info.id;
    if (!why_not.empty() && !might_be_meant(info) && !is_asked_for && reported == nullptr) return;
    // The reference object itself is at no distance.
    if (is_of_nearest() && info.name == standing_.rule.carrier && !is_asked_for) return;
    const std::uint32_t number = members_.add(info.id);
    if (reported != nullptr || is_asked_for) {
      ExplainedObject object =
          object_of(number, kNoLimit_m, true)
              .value_or(ExplainedObject{.object = info.name, .clearance_m = kNoLimit_m, .error_m = kNoLimit_m});
      object.why_left_out = std::move(why_not);
      if (reported != nullptr) {
        object.reported = true;
        object.since = std::chrono::nanoseconds(reported->began_ns);
        object.episode = reported->episode;
        object.doubt = std::string(name_of(reported->doubt));
      }
      if (is_asked_for) explained_.asked_for = object;
      if (reported != nullptr) explained_.holds.push_back(std::move(object));
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
    const bool is_full = explained_.others.size() >= ask_.most_others;
    const double limit_m = !is_full                    ? kNoLimit_m
                           : explained_.others.empty() ? -1
                                                       : explained_.others.back().clearance_m;
    if (one.at_least_m > limit_m) return;
    const std::optional<ExplainedObject> object = object_of(one.number, limit_m, false);
    if (!object) return;
    const auto nearer = [](const auto& a, const auto& b) { return a.clearance_m < b.clearance_m; };
    explained_.others.insert(std::upper_bound(explained_.others.begin(), explained_.others.end(), *object, nearer),
                             *object);
    if (explained_.others.size() > ask_.most_others) explained_.others.pop_back();
  }
  void look_at_left_out(const Outsider& one) {
    const double limit_m = left_out_limit_m();
    if (one.at_least_m > limit_m || explained_.left_out.size() >= ask_.most_left_out) return;
    std::optional<ExplainedObject> object = object_of(one.number, limit_m, true);
    if (!object || (is_of_nearest() ? object->clearance_m > limit_m : object->verdict == collided::Verdict::miss))
      return;
    object->why_left_out = one.why_not;
    explained_.left_out.push_back(std::move(*object));
  }
  /// Excluded objects are listed if they are in the region, or nearer than the nearest.
  double left_out_limit_m() const {
    if (!is_of_nearest()) return 0;
    return explained_.holds.empty() ? standing_.rule.nearest->within_m : explained_.holds.front().clearance_m;
  }
  /// Nothing if the object is certainly farther than the limit, or the deadline is over.
  std::optional<ExplainedObject> object_of(std::uint32_t number, double limit_m, bool with_depth) {
    ExplainedObject object{.object = members_.info(number).name,
                           .clearance_m = kNoLimit_m,
                           .error_m = kNoLimit_m,
                           .stale = members_.is_stale(number)};
    if (placed_.bounds.empty() || members_.bounds(number).empty()) return object;
    WalkCost cost;
    const std::optional<ObjectClearance> found = clearance_between(
        placed_, members_.placed(number, deadline_), {.limit_m = limit_m, .depth = with_depth}, cost, deadline_);
    if (!found || deadline_.was_over()) return std::nullopt;
    object.verdict = static_cast<collided::Verdict>(found->touches);
    object.clearance_m = found->clearance_m;
    object.error_m = found->error_m;
    if (found->touches == Decision::no && found->clearance_m < kNoLimit_m) {
      object.on_other = found->on_a;
      object.on_object = found->on_b;
    }
    return object;
  }

  const Snapshot& snapshot_;
  const StandingLook& standing_;
  const StandingExplanationAsk& ask_;
  Members members_;
  Deadline& deadline_;
  static constexpr double kNoLimit_m = std::numeric_limits<double>::infinity();

  const Pose world_pose_;
  Placed placed_;
  std::vector<Outsider> outsiders_;
  ExplainedStanding explained_;
};

StandingLook look_at_slot(const Fences& fences, std::uint32_t slot) {
  const FenceTable& table = fences.table();
  StandingLook look{.id = table.id(slot),
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

std::optional<StandingLook> look_at_standing(const Fences& fences, std::string_view name) {
  const std::optional<std::uint32_t> slot = fences.table().find(name);
  if (!slot || fences.table().is_band(*slot)) return std::nullopt;
  return look_at_slot(fences, *slot);
}

DefinedStanding defined_standing(const std::string& name, const FenceRule& rule, const ObjectInfo& body) {
  DefinedStanding defined{.name = name,
                          .form = rule.nearest ? StandingForm::nearest : StandingForm::region,
                          .only = rule.only,
                          .skip = rule.skip,
                          .mask = rule.mask,
                          .keep = rule.owner == 0,
                          .to = rule.carrier};
  if (rule.nearest) {
    if (rule.carrier.empty()) defined.point = std::get<Sphere>(body.primitives.front()).center;
    defined.within_m = rule.nearest->within_m;
    defined.hysteresis_m = rule.nearest->hysteresis_m;
    return defined;
  }
  defined.kind = kind_of(body);
  for (const auto& [word, bit] : kDetectWords) {
    if ((rule.detects & bit) != 0) defined.detect.emplace_back(word);
  }
  return defined;
}

DefinedStanding defined_standing(const FenceDefinition& margin) {
  return {.name = margin.name,
          .form = StandingForm::bands,
          .only = margin.only,
          .skip = margin.skip,
          .mask = margin.mask,
          .keep = margin.owner == 0,
          .around = margin.margin->around,
          .bands_m = margin.margin->bands_m,
          .dwell = std::chrono::nanoseconds(margin.margin->dwell_ns),
          .hysteresis_m = margin.margin->hysteresis_m};
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

ExplainedStanding explain_standing(const Snapshot& snapshot, const StandingLook& standing,
                                   const StandingExplanationAsk& ask, PartMeshes& part_meshes, Deadline& deadline) {
  const OwnFloatEnvironment own_floats;
  return StandingSearch(snapshot, standing, ask, part_meshes, deadline).run();
}

}  // namespace collided::engine
