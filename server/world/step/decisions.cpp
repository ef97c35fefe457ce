#include "server/world/step/decisions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "idl/clocks.hpp"
#include "server/world/objects/object_placing.hpp"

namespace collided::engine {
bool Decisions::has_room() const {
  if (ledger_.is_recording()) return true;
  return cost_.contacts < step_.options.max_contacts &&
         cost_.candidate_pairs < kCandidatesAContact * step_.options.max_contacts;
}

void Decisions::decide_open() {
  for (std::size_t i = 0; i < ledger_.all().open().size(); ++i) {
    if (ledger_.all().found(i)) continue;
    const std::uint32_t a = slot_of(ledger_.all().open()[i].a);
    const std::uint32_t b = slot_of(ledger_.all().open()[i].b);
    if (are_on_common_time(a, b)) continue;  // decided by end_parted()
    if (!rows_.has_moved(a) && !rows_.has_moved(b)) continue;
    const bool a_is_part = rows_.info(a)->scene_part != kNoTriangle;
    const bool b_is_part = rows_.info(b)->scene_part != kNoTriangle;
    if (!a_is_part && !b_is_part) {
      decide_pair(a, b);
      continue;
    }
    for (std::size_t scene = 0; scene < step_.scenes.size(); ++scene) {
      if (step_.scenes[scene]->name == rows_.info(a_is_part ? a : b)->rare->scene)
        decide_scene(a_is_part ? b : a, scene);
    }
  }
}

void Decisions::end_parted(std::int64_t last_step_ns) {
  if (step_.sources.need_common_time()) decide_unfound();
  const auto end_of = [&](const OpenContact& contact) -> ContactEnd {
    const std::uint32_t a = slot_of(contact.a);
    const std::uint32_t b = slot_of(contact.b);
    if (are_on_common_time(a, b)) return {};
    const Motion how = std::max(rows_.motion(a), rows_.motion(b));
    if (how == Motion::none) return {};
    ContactEnd end{.reason = how == Motion::placed ? EndReason::teleported : EndReason::separated,
                   .bracket_low_s = seconds_ago(last_step_ns)};
    const std::uint32_t mover = rows_.motion(a) == how ? a : b;
    if (is_timed(mover)) {
      const ObjectRow& row = rows_[mover];
      end.bracket_low_s = seconds_ago(how == Motion::placed ? row.posed_ns : row.posed_before_ns);
      end.bracket_high_s = seconds_ago(row.posed_ns);
    }
    return end;
  };
  ledger_.all().end_unfound(rows_.moved(), end_of);
}

/// Decides the contacts on common time whose objects' bounds no longer meet. Nothing new is known about two objects
/// that did not move and whose motions are all decided, unless the floor passed one of them.
void Decisions::decide_unfound() {
  std::vector<std::uint32_t>& unfound = lists_.unfound;
  unfound.clear();
  const auto look_at = [&](std::uint32_t number) {
    const OpenContact& open = ledger_.all().open()[number];
    if (!ledger_.all().found(number) && are_on_common_time(slot_of(open.a), slot_of(open.b))) unfound.push_back(number);
    return true;
  };
  if (step_.looks_at_all || step_.sources.is_any_behind_floor()) {
    for (std::uint32_t number = 0; number < ledger_.all().open().size(); ++number) look_at(number);
  } else {
    for (const std::vector<std::uint32_t>* slots :
         {&rows_.moved(), &motion_.young(), &motion_.history().travelling()}) {
      for (const std::uint32_t slot : *slots) ledger_.all().for_each_of(slot, look_at);
    }
  }
  std::sort(unfound.begin(), unfound.end());
  unfound.erase(std::unique(unfound.begin(), unfound.end()), unfound.end());
  lists_.unfound_pairs.clear();
  for (const std::uint32_t number : unfound) {
    const OpenContact& open = ledger_.all().open()[number];
    lists_.unfound_pairs.emplace_back(slot_of(open.a), slot_of(open.b));
  }
  for (const auto& [a, b] : lists_.unfound_pairs) {
    decide_on_common_time(a, b);
    if (ledger_.all().is_found_again(rows_.info(a)->id, rows_.info(b)->id)) decide_where_known(a, b);
  }
}

bool Decisions::is_timed(std::uint32_t slot) const {
  const std::uint32_t source = rows_.source(slot);
  return source != Sources::kResting && step_.sources[source].is_timed;
}

/// Sends one pair's finding to the ledger: a contact that begins or continues, one that began and ended within the
/// step, or nothing new.
///
/// parted  when a contact that began and ended within the step ended; null: unknown, before the step's end
void Decisions::report(ObjectId a, ObjectId b, const ContactSearch& touch, const SweptContact* sweep,
                       std::uint32_t mover, Contained contained, const ContactEnd* parted) {
  if (sweep != nullptr) {
    ++cost_.swept;
    cost_.exact_tests += sweep->exact_tests;
    if (sweep->undecided && !sweep->yes && !touch.yes) ++cost_.sweeps_skipped;
  }
  if (touch.undecided && !touch.yes) ++cost_.undecided;
  const OpenContact* known = ledger_.find(std::min(a, b), std::max(a, b));
  const bool is_held = known != nullptr && known->doubt == Doubt::none;
  // Once touching, a pair stays in contact until it is known to be apart.
  const bool passed = sweep != nullptr && sweep->yes && !touch.yes && !(touch.undecided && !is_held);
  const bool holds_on = sweep != nullptr && sweep->yes && !touch.yes && !passed;
  if (!touch.yes && !passed && !holds_on) return report_doubt(a, b, touch, sweep, mover);
  // Open contacts take their room whether or not this search has reached them yet.
  if (!is_held && !passed && ledger_.is_full(step_.options.max_contacts)) cost_.truncated = true;
  if (cost_.truncated && !is_held) return;
  ++cost_.contacts;
  FoundContact found{.a = a,
                     .b = b,
                     .a_triangle = touch.a_triangle,
                     .b_triangle = touch.b_triangle,
                     .contact = passed || holds_on ? sweep->contact : touch.contact,
                     .contained = contained};
  if (passed || holds_on) {
    found.a_triangle = sweep->a_triangle;
    found.b_triangle = sweep->b_triangle;
  }
  if (found.b < found.a) {
    std::swap(found.a, found.b);
    std::swap(found.a_triangle, found.b_triangle);
    found.contact.normal = -found.contact.normal;
    found.contained = turned_round(contained);
  }
  const bool is_told = step_.step_options.persisted || !is_held;
  // A contact that continues without an event needs no time, unless one of the two came to lie within the other.
  if (is_told || found.contained != known->contained) set_bracket(found, sweep, mover);
  if (step_.step_options.contacts) { found.contact.depth_error_m += placing_error_of(found); }
  if (step_.step_options.contacts && is_told) {
    const double time = passed || holds_on ? sweep->bracket.high : 1;
    const Vec3& point = found.contact.point;
    const double slack_s = found.bracket_low_s - found.bracket_high_s;
    set_velocity(found, velocity_at(point, slot_of(found.a), time, slack_s),
                 velocity_at(point, slot_of(found.b), time, slack_s));
  }
  if (passed) {
    if (parted != nullptr) {
      found.parted_low_s = std::min(parted->bracket_low_s, found.bracket_low_s);
      found.parted_high_s = std::min(parted->bracket_high_s, found.parted_low_s);
    }
    ledger_.touched_and_parted(found);
  } else {
    ledger_.touches(found);
  }
}

/// Bound on the error of placing both.
double Decisions::placing_error_of(const FoundContact& found) {
  const std::uint32_t a = slot_of(found.a);
  const std::uint32_t b = slot_of(found.b);
  const PlacedBoxPair boxes = lists_.boxes.pair(rows_, a, b);
  if (boxes.are_boxes()) return placing_error_m(*boxes.a, *boxes.b);
  const bool with_bounds = !are_balls_or_boxes(a, b);
  return placing_error_m(placed(a, with_bounds), found.a_triangle, placed(b, with_bounds), found.b_triangle);
}

/// The pair was found neither to touch nor to be apart, at the step's end or during the step.
void Decisions::report_doubt(ObjectId a, ObjectId b, const ContactSearch& touch, const SweptContact* sweep,
                             std::uint32_t mover) {
  FoundContact found{.a = std::min(a, b), .b = std::max(a, b), .contact = {}};
  const bool is_swept_undecided = sweep != nullptr && sweep->undecided && !ledger_.is_open(found.a, found.b);
  if (!touch.undecided && !is_swept_undecided) return;
  set_bracket(found, nullptr, mover);
  found.parted_low_s = found.bracket_low_s;
  found.parted_high_s = found.bracket_high_s;
  if (touch.undecided) ledger_.doubts(found, Doubt::numeric);
  else if (may_begin()) ledger_.doubted_and_parted(found, sweep->is_cut_short ? Doubt::cost_limit : Doubt::numeric);
}

/// Sets when a contact began: by the swept mover's motion if the sweep found a time, else by all motions of the two in
/// this step. Exact to the nanosecond if the publisher gives instants, so it does not depend on the steps.
void Decisions::set_bracket(FoundContact& found, const SweptContact* sweep, std::uint32_t mover) const {
  const ObjectRow& row = rows_[mover];
  const std::int64_t motion_ns = rows_.motion(mover) == Motion::moved ? row.posed_ns - row.posed_before_ns : 0;
  if (sweep == nullptr || !sweep->yes) {
    set_bracket_of_moves(found);
  } else if (is_timed(mover)) {
    const double duration_ns = static_cast<double>(motion_ns);
    found.bracket_low_s =
        seconds_ago(row.posed_ns - motion_ns + static_cast<std::int64_t>(std::floor(sweep->bracket.low * duration_ns)));
    found.bracket_high_s =
        seconds_ago(row.posed_ns - motion_ns + static_cast<std::int64_t>(std::ceil(sweep->bracket.high * duration_ns)));
  } else {
    const double end_s = seconds_ago(row.posed_ns);
    const double motion_s = static_cast<double>(motion_ns) * wire_contract::kNanosecond_s;
    found.bracket_low_s = std::max(0.0, end_s + motion_s * (1 - sweep->bracket.low));
    found.bracket_high_s = std::max(0.0, end_s + motion_s * (1 - sweep->bracket.high));
  }
  if (is_timed(mover)) found.parted_high_s = seconds_ago(row.posed_ns);
  // The two separated at some time between the first contact and the end.
  found.parted_low_s = found.bracket_high_s;
}

/// Brackets the contact by the motions of both objects in this step.
void Decisions::set_bracket_of_moves(FoundContact& found) const {
  std::int64_t first_ns = std::numeric_limits<std::int64_t>::max();
  std::int64_t placed_ns = std::numeric_limits<std::int64_t>::min();
  std::int64_t last_ns = placed_ns;
  bool all_timed = true;
  for (const std::uint32_t slot : {slot_of(found.a), slot_of(found.b)}) {
    const Motion motion = rows_.motion(slot);
    if (motion == Motion::none) continue;
    const ObjectRow& row = rows_[slot];
    // An object without a time, new or static, exists from this step on and touches from then on.
    if (row.posed_ns == 0) return;
    if (motion == Motion::moved) {
      first_ns = std::min(first_ns, row.posed_before_ns);
    } else {
      placed_ns = std::max(placed_ns, row.posed_ns);  // nothing touched the object before it existed
    }
    last_ns = std::max(last_ns, row.posed_ns);
    all_timed = all_timed && is_timed(slot);
  }
  found.bracket_low_s = seconds_ago(std::max(placed_ns, std::min(first_ns, last_ns)));
  found.bracket_high_s = seconds_ago(last_ns);
  if (all_timed) return;
  found.bracket_low_s = std::max(0.0, found.bracket_low_s);
  found.bracket_high_s = std::clamp(found.bracket_high_s, 0.0, found.bracket_low_s);
}

/// The velocity of the object's point that is at `point` at a fraction of its last motion, m/s.
BodyMotion::PointVelocity Decisions::velocity_at(const Vec3& point, std::uint32_t slot, double time,
                                                 double slack_s) const {
  const ObjectRow& row = rows_[slot];
  const std::int64_t motion_ns = row.posed_ns - row.posed_before_ns;
  if (!row.has_motion || motion_ns <= 0 || row.posed_before_ns == kPosedAtStep) return {};
  // An object that its publisher's instant does not name rests. One without instants counts as moving on for as long as
  // its last motion took.
  if (!rows_.has_moved(slot) && is_timed(slot)) return {};
  if (!rows_.has_moved(slot) && step_.world_time_ns - row.posed_ns > motion_ns) return {};
  const Frame now = row.frame();
  const BodyMotion path(row.frame_before(now), now, rows_.pivot(slot));
  return path.velocity(point, rows_.has_moved(slot) ? time : 1,
                       static_cast<double>(motion_ns) * wire_contract::kNanosecond_s, slack_s);
}

}  // namespace collided::engine
