#include "server/world/fences/fences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/world/objects/sweep.hpp"

namespace collided::engine {
namespace {

bool is_endless_primitive(const Primitive& primitive) { return std::holds_alternative<HalfSpace>(primitive); }

std::string refusal_of(const NearestRule& rule) {
  if (!(rule.within_m > 0) || !std::isfinite(rule.within_m))
    return fmt::format("it looks {} m far; a finite distance above 0 is needed", rule.within_m);
  if (!(rule.hysteresis_m >= 0) || !std::isfinite(rule.reach_m()))
    return fmt::format("its hysteresis is {} m; a finite distance, 0 or more, is needed", rule.hysteresis_m);
  return {};
}

std::string refusal_of(const FenceDefinition& definition) {
  const std::vector<Primitive>& primitives = definition.shape.primitives;
  if (definition.shape.mesh && !definition.solid)
    return "its mesh is a surface, which holds nothing; a fence needs a closed one, declared solid";
  if (primitives.empty() && !definition.solid) return "it has no shape";
  if (!definition.carrier.empty() && std::any_of(primitives.begin(), primitives.end(), is_endless_primitive))
    return "a half-space has no end, so it cannot move with an object";
  if (definition.nearest) return refusal_of(*definition.nearest);
  if (definition.detects == 0) return "it detects nothing; enter, exit and cross are offered";
  return {};
}

}  // namespace

std::string Fences::reason_against(const FenceDefinition& definition) const {
  if (table_.find(definition.name) || margins_.contains(definition.name))
    return "the name is taken; names are unique among fences, margins and questions for the nearest";
  if (table_.count() + margins_.size() >= FenceTable::kMost)
    return std::string("it is one more than the limit of ").append(std::to_string(FenceTable::kMost)).append(" fences");
  return definition.margin ? refusal_of(*definition.margin) : refusal_of(definition);
}

std::variant<ObjectId, Refusal> Fences::add(const FenceDefinition& definition) {
  const std::string reason = reason_against(definition);
  const char* kind = definition.margin ? "margin" : definition.nearest ? "nearest" : "fence";
  if (!reason.empty())
    return Refusal{std::string(kind) + " '" + definition.name + "': " + reason + ". Nothing was added"};
  if (definition.margin) {
    margins_.emplace(definition.name, definition);
    new_margins_.push_back(definition.name);
    return kStandingBit;
  }
  const ObjectId id = table_.add(definition);
  if (definition.nearest) nearest_.add(slot_of(id));
  new_.push_back(slot_of(id));
  return id;
}

bool Fences::remove(std::string_view name) {
  if (const auto margin = margins_.find(name); margin != margins_.end()) {
    for (std::uint32_t slot = 0; slot < table_.size(); ++slot) {
      if (table_.holds(slot) && table_.is_band(slot) && table_.rule(slot).band->margin == name) remove_row(slot);
    }
    std::erase(new_margins_, name);
    margins_.erase(margin);
    return true;
  }
  const std::optional<std::uint32_t> slot = table_.find(name);
  if (!slot || table_.is_band(*slot)) return false;
  remove_row(*slot);
  return true;
}

void Fences::remove_row(std::uint32_t fence) {
  removed_.push_back(table_.id(fence));
  std::erase(new_, fence);
  drop_pending(table_.id(fence));
  nearest_.remove(fence);
  table_.remove(fence);
}

std::optional<ObjectId> Fences::find(std::string_view name) const {
  const std::optional<std::uint32_t> slot = table_.find(name);
  if (!slot) return std::nullopt;
  return table_.id(*slot);
}

void Fences::begin_step(std::int64_t world_time_ns, const Changes& changes) {
  ledger_.begin_step(world_time_ns, false);
  cost_ = {};
  ++step_;
  for (const ObjectId fence : removed_) ledger_.end_object(fence, EndReason::fence_removed);
  removed_.clear();
  for (const auto& [id, reason] : changes.removed) {
    ledger_.end_object(id, reason);
    drop_pending(id);
    const std::span<const std::uint32_t> carried = table_.carried_by(slot_of(id));
    for (const std::uint32_t fence : std::vector<std::uint32_t>(carried.begin(), carried.end())) {
      ledger_.end_object(table_.id(fence), reason);
      if (!table_.is_band(fence)) {
        table_.unbind(fence);
        continue;
      }
      remove_row(fence);
      removed_.pop_back();  // it has ended
    }
  }
  for (const auto& [id, is_lost] : changes.lost) {
    drop_pending(id);
    is_lost ? ledger_.lose(id) : ledger_.find_again(id);
    for (const std::uint32_t fence : table_.carried_by(slot_of(id))) {
      drop_pending(table_.id(fence));
      is_lost ? ledger_.lose(table_.id(fence)) : ledger_.find_again(table_.id(fence));
    }
  }
}

void Fences::decide(const StepView& step, const Grid& movers) {
  make_bands(step);
  if (table_.count() == 0 && ledger_.open().empty()) return new_.clear();
  bind_waiting(step);
  std::sort(new_.begin(), new_.end());
  gather_movers(step);
  follow_carriers(step);
  are_fences_still_ = !table_.update_index();
  if (!are_fences_still_) clearings_.forget_all();
  StandingDecisions decisions(step, table_, ledger_, lists_, pending_, cost_);
  for (const std::uint32_t mover : movers_) {
    find_fences_of(step, mover);
    for (const std::uint32_t fence : found_) consider(step, decisions, fence, mover);
  }
  look_around_.clear();
  std::set_union(new_.begin(), new_.end(), followed_.begin(), followed_.end(), std::back_inserter(look_around_));
  for (const std::uint32_t fence : look_around_) {
    if (!table_.has_bounds(fence)) continue;
    with_inner_.clear();
    add_with_inner(fence, with_inner_);
    find_movers_of(step, movers, fence);
    for (const std::uint32_t mover : found_) {
      for (const std::uint32_t band : with_inner_) consider(step, decisions, band, mover);
    }
  }
  if (is_any_pending()) {
    decide_left_pending(step, decisions);
    decisions.settle();
  }
  nearest_.decide(step, movers, cost_);
  cut_short_ += cost_.sweeps_skipped;
  new_.clear();
}

/// Passes a pair to the decisions, once per step.
void Fences::consider(const StepView& step, StandingDecisions& decisions, std::uint32_t fence, std::uint32_t mover) {
  const ObjectInfo* info = step.rows.info(mover);
  if (info == nullptr) return;
  const OpenContact* open = ledger_.find(info->id, table_.id(fence));
  const auto pending = pending_.empty() ? pending_.end() : pending_.find({info->id, table_.id(fence)});
  if (pending != pending_.end()) {
    if (pending->second.considered_in_step != step_) decide_pair(decisions, fence, mover, false);
    return;
  }
  if (open == nullptr && !overlaps(step.motion.bounds()[mover], bounds_around(fence))) return;
  if (open == nullptr && !decisions.looks_at(fence, mover)) return;
  // Most objects in a fence are deep in it, and stay.
  if (open != nullptr && open->doubt == Doubt::none && decisions.surely_stays(fence, mover)) return;
  decide_pair(decisions, fence, mover, std::binary_search(new_.begin(), new_.end(), fence));
}

void Fences::decide_pair(StandingDecisions& decisions, std::uint32_t fence, std::uint32_t mover, bool is_new) {
  decisions.decide(fence, mover, is_new);
  decisions.note_considered(fence, mover, step_);
}

/// Binds new fences to their carriers, and new objects to the fences that wait for them.
void Fences::bind_waiting(const StepView& step) {
  if (table_.carried().empty()) return;
  for (const std::uint32_t fence : new_) {
    if (!table_.is_carried(fence) || table_.carrier(fence) != FenceTable::kNone) continue;
    if (const std::optional<ObjectId> carrier = step.rows.find(table_.rule(fence).carrier))
      bind(step, fence, slot_of(*carrier));
  }
  for (const std::uint32_t slot : step.rows.moved()) {
    const ObjectInfo* info = step.rows.info(slot);
    if (info == nullptr || !step.rows.is_new(slot)) continue;
    for (const std::uint32_t fence : table_.waiting_for(info->name)) {
      bind(step, fence, slot);
      new_.push_back(fence);
    }
  }
}

void Fences::bind(const StepView& step, std::uint32_t fence, std::uint32_t object) {
  table_.bind(fence, object);
  if (table_.has_bounds(fence)) table_.set_bounds(fence, bounds_at(step, fence));
  if (step.rows[object].is_stale) ledger_.lose(table_.id(fence));
}

/// Collects the movers about which something new may be known; the past of the others is decided.
void Fences::gather_movers(const StepView& step) {
  movers_.clear();
  const auto add = [&](std::uint32_t slot) {
    const ObjectInfo* info = step.rows.info(slot);
    if (info != nullptr && info->moving) movers_.push_back(slot);
  };
  if (step.looks_at_all) {
    for (std::uint32_t slot = 0; slot < step.rows.size(); ++slot) add(slot);
    return;
  }
  std::for_each(step.rows.moved().begin(), step.rows.moved().end(), add);
  // Only a carried fence may wait for time that is already behind a mover.
  if (table_.carried().empty()) return;
  const auto add_open = [&](std::uint32_t slot) {
    if (!step.rows.has_moved(slot)) add(slot);
  };
  std::for_each(step.motion.young().begin(), step.motion.young().end(), add_open);
  const std::vector<std::uint32_t>& travelling = step.motion.history().travelling();
  std::for_each(travelling.begin(), travelling.end(), add_open);
}

/// Gives carried fences the bounds of their whole undecided path.
void Fences::follow_carriers(const StepView& step) {
  if (table_.carried().empty() && followed_.empty()) return;
  const std::vector<std::uint32_t> before = std::exchange(followed_, {});
  for (const std::uint32_t mover : movers_) {
    const std::span<const std::uint32_t> carried = table_.carried_by(mover);
    const auto has_bounds = [&](std::uint32_t fence) { return table_.has_bounds(fence); };
    std::copy_if(carried.begin(), carried.end(), std::back_inserter(followed_), has_bounds);
  }
  // The floor passed a silent source: its pairs may begin again though nothing moved.
  if (step.sources.is_any_behind_floor()) {
    followed_.clear();
    std::copy_if(
        table_.carried().begin(), table_.carried().end(), std::back_inserter(followed_),
        [&](std::uint32_t fence) { return table_.carrier(fence) != FenceTable::kNone && table_.has_bounds(fence); });
  }
  std::sort(followed_.begin(), followed_.end());
  for (const std::uint32_t fence : followed_) table_.set_bounds(fence, bounds_on_the_way(step, fence));
  // Fences that rest again get the bounds of their place.
  for (const std::uint32_t fence : before) {
    if (!table_.holds(fence) || std::binary_search(followed_.begin(), followed_.end(), fence)) continue;
    const std::uint32_t carrier = table_.carrier(fence);
    if (carrier != FenceTable::kNone) table_.set_bounds(fence, bounds_at(step, fence));
  }
}

/// Bounds of the fence where its carrier is.
Aabb Fences::bounds_at(const StepView& step, std::uint32_t fence) {
  return grown(bounds_of(table_.body(fence), step.rows[table_.carrier(fence)].frame()), table_.beyond_m(fence));
}

Aabb Fences::bounds_on_the_way(const StepView& step, std::uint32_t fence) {
  const std::uint32_t carrier = table_.carrier(fence);
  const ObjectInfo& body = table_.body(fence);
  const ObjectRow& row = step.rows[carrier];
  Aabb all = bounds_of(body, row.frame());
  if (step.rows.motion(carrier) == Motion::moved)
    all.extend(
        bounds(body, BodyMotion(row.frame_before(), row.frame(), step.rows.pivot(carrier)), table_.reach_m(fence)));
  step.motion.history().for_each(carrier, [&](const MotionSegment& segment) {
    if (segment.is_jump()) {
      all.extend(bounds_of(body, segment.from));
      all.extend(bounds_of(body, segment.to));
    } else {
      all.extend(bounds(body, segment.path(), table_.reach_m(fence)));
    }
  });
  return grown(all, table_.beyond_m(fence));
}

/// True if something new may be known about the object, so that it looks for its fences itself.
bool Fences::is_pending(const StepView& step, std::uint32_t slot) const {
  return step.looks_at_all || step.rows.has_moved(slot) || (!table_.carried().empty() && step.motion.is_open(slot));
}

/// Finds the fences that its motion may meet, and those that it is in, whose bounds it may have left.
void Fences::find_fences_of(const StepView& step, std::uint32_t mover) {
  found_.clear();
  if (!clearings_.hold(mover, step.motion.bounds()[mover])) walk_fences(step, mover);
  const auto is_in = [&](std::uint32_t number) {
    const std::uint32_t fence = slot_of(ledger_.open()[number].b);
    if (table_.holds(fence) && !table_.is_nearest(fence)) found_.push_back(fence);
    return true;
  };
  if (const ObjectInfo* info = step.rows.info(mover)) ledger_.for_each_with(info->id, is_in);
  keep_found_once();
}

/// Finds the fences that its bounds meet. While fences stand still the walk looks farther, so that if nothing is found
/// the next steps need no walk.
void Fences::walk_fences(const StepView& step, std::uint32_t mover) {
  const Aabb& bounds = step.motion.bounds()[mover];
  const double size_m = (bounds.high - bounds.low).maxCoeff();
  const double margin_m = are_fences_still_ && std::isfinite(size_m) ? std::max(0.0, size_m) : 0;
  const Aabb wide = grown(bounds, margin_m);
  bool is_clear = margin_m > 0;
  const auto meets = [&](std::uint32_t fence) {
    is_clear = false;
    if (margin_m == 0 || overlaps(bounds, table_.bounds(fence))) add_with_inner(fence, found_);
    return true;
  };
  table_.index().walk_box(wide, meets, walk_);
  if (is_clear) clearings_.set(mover, wide);
}

/// Finds the objects that do not look for their fences themselves; the fence and its inner bands are in with_inner_.
void Fences::find_movers_of(const StepView& step, const Grid& movers, std::uint32_t fence) {
  found_.clear();
  const auto add = [&](std::uint32_t mover) {
    if (!is_pending(step, mover)) found_.push_back(mover);
    return true;
  };
  movers.walk_box(table_.bounds(fence), add, walk_);
  for (const std::uint32_t band : with_inner_) {
    ledger_.for_each_with(table_.id(band),
                          [&](std::uint32_t number) { return add(slot_of(ledger_.open()[number].a)); });
  }
  keep_found_once();
}

void Fences::keep_found_once() {
  std::sort(found_.begin(), found_.end());
  found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
}

}  // namespace collided::engine
