#include "server/world/decisions.hpp"

#include <algorithm>
#include <utility>

namespace collided {
namespace {

using wire_contract::EndReason;

/// A step tests so many candidates for each contact that it may find: shapes that are apart cost time, never memory.
constexpr std::uint64_t kCandidatesAContact = 16;

}  // namespace

bool Decisions::has_room() const {
  return cost_.contacts < step_.options.max_contacts &&
         cost_.candidate_pairs < kCandidatesAContact * step_.options.max_contacts;
}

void Decisions::decide_open() {
  for (std::size_t i = 0; i < ledger_.open().size(); ++i) {
    if (ledger_.found(i)) continue;
    const std::uint32_t a = slot_of(ledger_.open()[i].a);
    const std::uint32_t b = slot_of(ledger_.open()[i].b);
    if (!rows_.has_moved(a) && !rows_.has_moved(b)) continue;
    const bool a_is_part = rows_.info(a)->scene_part != wire_contract::kNoTriangle;
    const bool b_is_part = rows_.info(b)->scene_part != wire_contract::kNoTriangle;
    if (!a_is_part && !b_is_part) {
      decide_pair(a, b);
      continue;
    }
    for (std::size_t scene = 0; scene < step_.scenes.size(); ++scene) {
      if (step_.scenes[scene]->name == rows_.info(a_is_part ? a : b)->scene) decide_scene(a_is_part ? b : a, scene);
    }
  }
}

void Decisions::end_parted(std::int64_t last_step_ns) {
  const auto reason = [&](const OpenContact& contact) {
    const Motion a = rows_.motion(slot_of(contact.a));
    const Motion b = rows_.motion(slot_of(contact.b));
    if (a == Motion::none && b == Motion::none) return EndReason::none;
    return std::max(a, b) == Motion::placed ? EndReason::teleported : EndReason::separated;
  };
  ledger_.end_unfound(reason, static_cast<double>(step_.world_time_ns - last_step_ns) * 1e-9);
}

/// For contacts first, for the time between: began now, began and parted on the way, or nothing new.
void Decisions::report(ObjectId a, ObjectId b, const Touch& touch, const SweptTouch* sweep, std::uint32_t mover) {
  if (sweep != nullptr) {
    ++cost_.swept;
    cost_.exact_tests += sweep->exact_tests;
    if (sweep->undecided && !sweep->yes && !touch.yes) ++cost_.sweeps_skipped;
  }
  if (touch.undecided && !touch.yes) ++cost_.undecided;
  const bool passed = sweep != nullptr && sweep->yes && !touch.yes;
  if (!touch.yes && !passed) return;
  const bool is_held = ledger_.holds(std::min(a, b), std::max(a, b));
  // Those that hold take their room, whether this search has come to them yet or not.
  if (!is_held && !passed && ledger_.open().size() >= step_.options.max_contacts) cost_.truncated = true;
  if (cost_.truncated && !is_held) return;
  ++cost_.contacts;
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
  const bool is_told = step_.wishes.persisted || !is_held;
  if (step_.wishes.contacts && is_told) {
    const double time = passed ? sweep->bracket.high : 1;
    const Vec3& point = found.contact.point;
    found.relative_velocity = velocity_at(point, slot_of(found.b), time) - velocity_at(point, slot_of(found.a), time);
  }
  if (passed) {
    ledger_.touched_and_parted(found);
  } else {
    ledger_.touches(found);
  }
}

void Decisions::set_bracket(FoundContact& found, const SweptTouch* sweep, std::uint32_t mover) const {
  const ObjectRow& row = rows_[mover];
  const double end_s = static_cast<double>(step_.world_time_ns - row.posed_ns) * 1e-9;
  const double way_s = rows_.motion(mover) == Motion::moved
                           ? static_cast<double>(row.posed_ns - row.posed_before_ns) * 1e-9
                           : 0.0;
  const bool timed = sweep != nullptr && sweep->yes;
  found.bracket_low_s = std::max(0.0, end_s + way_s * (timed ? 1 - sweep->bracket.low : 1.0));
  found.bracket_high_s = std::max(0.0, end_s + way_s * (timed ? 1 - sweep->bracket.high : 0.0));
}

/// Of the object's point that is there at that time of its last way, m/s.
Vec3 Decisions::velocity_at(const Vec3& point, std::uint32_t slot, double time) const {
  const ObjectRow& row = rows_[slot];
  const std::int64_t way_ns = row.posed_ns - row.posed_before_ns;
  if (!row.has_way || way_ns <= 0 || row.posed_before_ns == kPosedAtStep) return Vec3::Zero();
  // Whoever has not moved in this step is still under way for as long again as its last way took.
  if (!rows_.has_moved(slot) && step_.world_time_ns - row.posed_ns > way_ns) return Vec3::Zero();
  const BodyWay way(row.frame_before, row.frame);
  const Vec3 origin = rows_.has_moved(slot) ? way.at(time).position : way.to.position;
  const Vec3 turn = way.turn_rad * way.axis;
  return (way.travel + turn.cross(point - origin)) / (static_cast<double>(way_ns) * 1e-9);
}

}  // namespace collided
