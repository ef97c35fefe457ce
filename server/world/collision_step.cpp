#include <algorithm>
#include <cassert>
#include <chrono>
#include <limits>
#include <utility>

#include "server/geometry/float_environment.hpp"
#include "server/world/inner_edges.hpp"
#include "server/world/step.hpp"

namespace collided {
namespace {

using wire_contract::EndReason;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

/// Contacts of removed objects end before anything else is looked at: their slots may be used again from now on.
void Step::end_removed() {
  for (const auto& [id, reason] : s.removed) s.ledger.end_object(id, reason);
  s.removed.clear();
}

/// Only what changed since this ring state was last filled is copied: moving 100 of 100,000 objects costs 100 copies.
void Step::fill_snapshot() {
  for (const std::uint32_t slot : s.moved_slots) {
    s.changed[slot] = s.step_count;
    if (s.posed_ns[slot] == kPosedAtStep) s.posed_ns[slot] = world_time_ns;
  }
  const std::size_t known = next.changed.size();
  const std::size_t count = s.objects->size();
  next.poses.resize(count);
  next.frames.resize(count);
  next.bounds.resize(count);
  next.posed_ns.resize(count);
  next.stale.resize(count);
  next.changed.resize(count);
  for (std::size_t slot = 0; slot < count; ++slot) {
    if (slot < known && next.changed[slot] == s.changed[slot]) continue;
    next.poses[slot] = s.poses[slot];
    next.frames[slot] = s.frames[slot];
    next.bounds[slot] = s.bounds[slot];
    next.posed_ns[slot] = s.posed_ns[slot];
    next.stale[slot] = s.stale[slot];
    next.changed[slot] = s.changed[slot];
  }
  next.epoch = s.options.epoch;
  next.version = s.version;
  next.world_time_ns = world_time_ns;
  next.scenes = s.scenes;
  next.objects = s.objects;
  next.table_version = s.table_version;
  next.stale_objects = s.stale_objects;
  next.covers = s.covers;
  s.objects_shared = true;
}

/// The grid holds each mover's whole way since its last pose, so that pairs that met on the way are candidates.
void Step::index_movers() {
  if (s.moved_slots.empty() && s.ring.current().grid) {
    next.grid = s.ring.current().grid;
    return;
  }
  s.swept_bounds.assign(s.bounds.begin(), s.bounds.end());
  s.balls.resize(s.bounds.size());
  for (const std::uint32_t slot : s.moved_slots) {
    const std::optional<MovingSphere> way = way_of(slot);
    s.fast[slot] = is_fast(slot) ? 1 : 0;
    if (way) {
      s.swept_bounds[slot].extend(bounds(*way));
    } else if (s.fast[slot] != 0) {
      s.swept_bounds[slot].extend(bounds(*(*s.objects)[slot], body_way(slot), s.sizes[slot].reach_m));
    }
    set_ball(slot, way);
    count_way(slot);
  }
  if (!next.grid || next.grid.use_count() > 1) next.grid = std::make_shared<Grid>();
  next.grid->rebuild(s.swept_bounds);
}

/// For contacts first, for the time between: began now, began and parted on the way, or nothing new.
void Step::report(ObjectId a, ObjectId b, const Touch& touch, const SweptTouch* sweep, std::uint32_t mover) {
  if (sweep != nullptr) {
    ++s.cost.swept;
    s.cost.exact_tests += sweep->exact_tests;
    if (sweep->undecided && !sweep->yes && !touch.yes) ++s.cost.sweeps_skipped;
  }
  if (touch.undecided && !touch.yes) ++s.cost.undecided;
  const bool passed = sweep != nullptr && sweep->yes && !touch.yes;
  if (!touch.yes && !passed) return;
  const bool is_held = s.ledger.holds(std::min(a, b), std::max(a, b));
  // Those that hold take their room, whether this search has come to them yet or not.
  if (!is_held && !passed && s.ledger.open().size() >= s.options.max_contacts) s.cost.truncated = true;
  if (s.cost.truncated && !is_held) return;
  ++s.cost.contacts;
  FoundContact found{.a = a, .b = b, .a_triangle = touch.a_triangle, .b_triangle = touch.b_triangle,
                     .contact = passed ? sweep->contact : touch.contact};
  if (passed) {
    found.a_triangle = sweep->a_triangle;
    found.b_triangle = sweep->b_triangle;
  }
  if (found.b < found.a) {
    std::swap(found.a, found.b);
    std::swap(found.a_triangle, found.b_triangle);
    found.contact.normal = -found.contact.normal;
  }
  set_bracket(found, sweep, mover);
  const bool is_told = wishes.persisted || !is_held;
  if (wishes.contacts && is_told) {
    const double time = passed ? sweep->bracket.high : 1;
    const Vec3& point = found.contact.point;
    found.relative_velocity = velocity_at(point, slot_of(found.b), time) - velocity_at(point, slot_of(found.a), time);
  }
  if (passed) {
    s.ledger.touched_and_parted(found);
  } else {
    s.ledger.touches(found);
  }
}

/// From the way of the swept mover where its contact is timed, else from all that the two did in this step.
void Step::set_bracket(FoundContact& found, const SweptTouch* sweep, std::uint32_t mover) const {
  const auto seconds_ago = [&](std::int64_t time_ns) { return static_cast<double>(world_time_ns - time_ns) * 1e-9; };
  const auto way_s = [&](std::uint32_t slot) {
    return s.motion[slot] == Motion::moved ? static_cast<double>(s.posed_ns[slot] - s.posed_before_ns[slot]) * 1e-9 : 0.0;
  };
  if (sweep != nullptr && sweep->yes) {
    found.bracket_low_s = std::max(0.0, seconds_ago(s.posed_ns[mover]) + way_s(mover) * (1 - sweep->bracket.low));
    found.bracket_high_s = std::max(0.0, seconds_ago(s.posed_ns[mover]) + way_s(mover) * (1 - sweep->bracket.high));
    return;
  }
  double low_s = 0, high_s = std::numeric_limits<double>::infinity();
  for (const std::uint32_t slot : {slot_of(found.a), slot_of(found.b)}) {
    if (!has_moved(slot)) continue;
    // Who is new, or static and so without a time, is there from this step on and touches from then on.
    const double posed_s = s.posed_ns[slot] == 0 ? 0.0 : seconds_ago(s.posed_ns[slot]);
    if (s.motion[slot] == Motion::placed && posed_s == 0) return;
    low_s = std::max(low_s, posed_s + way_s(slot));
    high_s = std::min(high_s, posed_s);
  }
  found.bracket_low_s = low_s;
  found.bracket_high_s = std::clamp(high_s, 0.0, low_s);
}

/// Of the object's point that is there at that time of its last way, m/s.
Vec3 Step::velocity_at(const Vec3& point, std::uint32_t slot, double time) const {
  const std::int64_t way_ns = s.posed_ns[slot] - s.posed_before_ns[slot];
  if (s.has_way[slot] == 0 || way_ns <= 0 || s.posed_before_ns[slot] == kPosedAtStep) return Vec3::Zero();
  // Whoever has not moved in this step is still under way for as long again as its last way took.
  if (!has_moved(slot) && world_time_ns - s.posed_ns[slot] > way_ns) return Vec3::Zero();
  const BodyWay way(s.frames_before[slot], s.frames[slot]);
  const Vec3 origin = has_moved(slot) ? way.at(time).position : way.to.position;
  const Vec3 turn = way.turn_rad * way.axis;
  return (way.travel + turn.cross(point - origin)) / (static_cast<double>(way_ns) * 1e-9);
}

/// A contact that was not found again although one of the two moved is over.
void Step::end_parted() {
  const auto reason = [&](const OpenContact& contact) {
    const Motion a = s.motion[slot_of(contact.a)];
    const Motion b = s.motion[slot_of(contact.b)];
    if (a == Motion::none && b == Motion::none) return EndReason::none;
    return std::max(a, b) == Motion::placed ? EndReason::teleported : EndReason::separated;
  };
  s.ledger.end_unfound(reason, static_cast<double>(world_time_ns - s.last_step_ns) * 1e-9);
}

bool World::step(std::int64_t world_time_ns, std::uint64_t batches, const StepWishes& wishes) {
  const OwnFloatEnvironment own_floats;
  State& s = *state_;
  Snapshot* next = s.ring.writable();
  if (next == nullptr) return false;
  const std::int64_t started = now_ns();
  s.version += batches;
  ++s.step_count;
  s.cost = {.moved = static_cast<std::uint32_t>(s.moved_slots.size())};
  s.ledger.begin_step(world_time_ns, wishes.persisted);

  Step step{.s = s, .next = *next, .wishes = wishes, .world_time_ns = world_time_ns, .walk = {}};
  step.end_removed();
  step.fill_snapshot();
  const std::int64_t updated = now_ns();
  step.index_movers();
  const std::int64_t indexed = now_ns();
  if (!s.moved_slots.empty()) {
    step.moving_against_static();
    if (!s.cost.truncated) step.moving_against_moving();
    if (s.cost.truncated) step.look_again_at_open();
    step.end_parted();
    if (wishes.contacts) correct_inner_edges(s);
    s.looks_at_all = s.cost.truncated;
  } else {
    s.cost.truncated = s.looks_at_all;
  }
  next->contacts_truncated = s.cost.truncated;
  s.ledger.finish_step();
  s.apart.end_step();
  s.ring.publish();

  for (const std::uint32_t slot : s.moved_slots) {
    s.motion[slot] = Motion::none;
    s.fast[slot] = 0;
  }
  s.moved_slots.clear();
  s.free_slots.insert(s.free_slots.end(), s.freed_this_step.begin(), s.freed_this_step.end());
  s.freed_this_step.clear();
  s.last_step_ns = world_time_ns;
  s.cost.update_ns = updated - started;
  s.cost.broad_ns = indexed - updated;
  s.cost.exact_ns = now_ns() - indexed;
  return true;
}

}  // namespace collided
