#include "server/world/fences/standing_decisions.hpp"

#include <algorithm>

#include "idl/glob.hpp"

namespace collided::engine {
namespace {

const Frame kWorldFrame;

bool is_of(const std::string& glob, const ObjectInfo& info) { return wire_contract::glob_matches(glob, info.name); }

}  // namespace

bool StandingDecisions::looks_at(std::uint32_t fence, std::uint32_t mover) const {
  const ObjectInfo* info = rows_.info(mover);
  if (info == nullptr || !info->moving || table_.carrier(fence) == mover) return false;
  const FenceRule& rule = table_.rule(fence);
  if (!rule.skip.empty() && wire_contract::glob_matches(rule.skip, info->name)) return false;
  if (rule.band) return band_looks_at(fence, *info);
  if ((info->filter.layers & rule.mask) == 0) return false;
  return rule.only.empty() || wire_contract::glob_matches(rule.only, info->name);
}

/// A pair is reported once: if both objects have bands around them, by the bands of the first name. Static objects of
/// either group have bands. The mask applies to the object of `only`, whichever of the two has the bands.
bool StandingDecisions::band_looks_at(std::uint32_t fence, const ObjectInfo& mover) const {
  const FenceRule& rule = table_.rule(fence);
  const ObjectInfo* about = rows_.info(table_.carrier(fence));
  if (about == nullptr) return false;
  const std::string& around = rule.band->around;
  const auto is_of_only = [&](const ObjectInfo& object) {
    return is_of(rule.only, object) && (object.filter.layers & rule.mask) != 0;
  };
  const bool is_reported_here = is_of(around, *about) && is_of_only(mover);
  const bool is_reported_there = is_of_only(*about) && is_of(around, mover);
  if (!about->moving) return is_reported_here || is_reported_there;
  return is_reported_here && !(is_reported_there && mover.name < about->name);
}

void StandingDecisions::decide(std::uint32_t fence, std::uint32_t mover, bool is_new) {
  ++cost_.candidate_pairs;
  if (is_new) return decide_new(fence, mover);
  if (!table_.is_carried(fence)) return decide_at_rest_in_the_world(fence, mover);
  const std::uint32_t carrier = table_.carrier(fence);
  if (carrier == FenceTable::kNone) return;
  if (are_on_common_time(step_, carrier, mover)) return decide_on_common_time(fence, mover, carrier);
  decide_carried(fence, mover, carrier);
}

/// If the object was placed, only the place counts; else its whole motion.
void StandingDecisions::decide_at_rest_in_the_world(std::uint32_t fence, std::uint32_t mover) {
  if (!rows_.has_moved(mover)) return;
  const ObjectRow& row = rows_[mover];
  if (rows_.motion(mover) == Motion::placed) {
    return decide_instant(instant_now(fence, mover, row.posed_ns), {EndReason::teleported, at_once(row.posed_ns)});
  }
  decide_piece({.mover = mover,
                .fence = fence,
                .from_ns = row.posed_before_ns > 0 ? row.posed_before_ns : row.posed_ns,
                .to_ns = row.posed_ns,
                .mover_motion = step_.motion.body_motion(mover),
                .fence_motion = BodyMotion::resting(kWorldFrame)});
}

/// Both are known up to the same instant, and those that moved did so in the same time.
void StandingDecisions::decide_carried(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier) {
  const Motion how = std::max(rows_.motion(mover), rows_.motion(carrier));
  if (how == Motion::none) return;
  const ObjectRow& row = rows_[rows_.motion(mover) == how ? mover : carrier];
  if (how == Motion::placed) {
    return decide_instant(instant_now(fence, mover, row.posed_ns), {EndReason::teleported, at_once(row.posed_ns)});
  }
  decide_piece(
      {.mover = mover,
       .fence = fence,
       .from_ns = row.posed_before_ns > 0 ? row.posed_before_ns : row.posed_ns,
       .to_ns = row.posed_ns,
       .mover_motion = step_.motion.body_motion(mover),
       .fence_motion = {rows_.motion(carrier) == Motion::moved ? rows_[carrier].frame_before() : rows_[carrier].frame(),
                        rows_[carrier].frame(), rows_.pivot(carrier)}});
}

void StandingDecisions::decide_on_common_time(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier) {
  const PairWindow window = window_of(step_, carrier, mover);
  const MotionHistory& history = step_.motion.history();
  const auto moves = [&](std::uint32_t slot) { return history.moves(slot, window.from_ns, window.to_ns); };
  const bool is_moved = moves(carrier) || moves(mover);
  if (window.is_empty() || !(window.is_closed || is_moved)) return;
  if (window.is_closed) {
    decide_instant(instant_on(fence, mover, carrier, window.from_ns),
                   {EndReason::separated, {window.decided_ns, window.from_ns}});
  }
  if (window.to_ns <= window.from_ns) return;
  cut(step_, carrier, mover, window, lists_.cuts);
  std::int64_t from_ns = window.from_ns;
  for (const std::int64_t to_ns : lists_.cuts) {
    decide_piece({.mover = mover,
                  .fence = fence,
                  .from_ns = from_ns,
                  .to_ns = to_ns,
                  .mover_motion = history.motion(mover, from_ns, to_ns, rows_[mover].pose),
                  .fence_motion = history.motion(carrier, from_ns, to_ns, rows_[carrier].pose)});
    if (history.jumps(carrier, to_ns) || history.jumps(mover, to_ns)) {
      decide_instant(instant_on(fence, mover, carrier, to_ns), {EndReason::teleported, at_once(to_ns)});
    }
    from_ns = to_ns;
  }
}

/// Decides the present, or the newest instant known of both: nothing is reported for the time before the fence.
void StandingDecisions::decide_new(std::uint32_t fence, std::uint32_t mover) {
  const std::uint32_t carrier = table_.carrier(fence);
  if (carrier != FenceTable::kNone && are_on_common_time(step_, carrier, mover)) {
    const std::int64_t known_ns = window_of(step_, carrier, mover).to_ns;
    return decide_instant(instant_on(fence, mover, carrier, known_ns), {EndReason::separated, at_once(known_ns)});
  }
  decide_instant(instant_now(fence, mover, step_.world_time_ns), {EndReason::separated, at_once(step_.world_time_ns)});
}

StandingPiece StandingDecisions::instant_on(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier,
                                            std::int64_t time_ns) const {
  const MotionHistory& history = step_.motion.history();
  return {.mover = mover,
          .fence = fence,
          .from_ns = time_ns,
          .to_ns = time_ns,
          .mover_motion = BodyMotion::resting(history.at(mover, time_ns, rows_[mover].pose)),
          .fence_motion = BodyMotion::resting(history.at(carrier, time_ns, rows_[carrier].pose))};
}

StandingPiece StandingDecisions::instant_now(std::uint32_t fence, std::uint32_t mover, std::int64_t time_ns) const {
  const std::uint32_t carrier = table_.carrier(fence);
  return {.mover = mover,
          .fence = fence,
          .from_ns = time_ns,
          .to_ns = time_ns,
          .mover_motion = BodyMotion::resting(rows_[mover].frame()),
          .fence_motion = BodyMotion::resting(carrier == FenceTable::kNone ? kWorldFrame : rows_[carrier].frame())};
}

}  // namespace collided::engine
