#include "server/world/fences/nearest_decisions.hpp"

#include <algorithm>
#include <cmath>

#include "server/geometry/tolerance.hpp"
#include "server/world/fences/standing_piece.hpp"

namespace collided::engine {
namespace {

/// Most changes of one question in one piece of time; the rest is left to the next.
constexpr std::uint32_t kMostChanges = 1'000;

}  // namespace

void NearestDecisions::decide(std::uint32_t fence, NearestProgress& question, const NearestGroup& group) {
  NearestAsked asked{.fence = fence, .question = question, .group = group, .rule = *table_.rule(fence).nearest};
  if (!find_about(asked)) {
    question.is_begun = question.has_nearest = false;
    return;
  }
  const OpenContact* open = open_of(fence);
  if (open != nullptr) asked.nearest = slot_of(open->a);
  const std::int64_t to_ns = known_ns(asked);
  if (!question.is_begun) {
    begin(asked, to_ns);
  } else {
    // The doubt about a lost object is over.
    if (open != nullptr && ledger_.is_found_again(open->a, open->b))
      tell(asked, {asked.nearest, at_once(question.decided_ns)});
    // The nearest was removed.
    if (open == nullptr && question.has_nearest) {
      find_candidates(asked,
                      grown(bounds_about(asked, {question.decided_ns, question.decided_ns}), asked.rule.within_m));
      tell(asked, {nearest_of_found(asked, question.decided_ns), at_once(question.decided_ns), true});
      note_reach(asked, question.decided_ns);
    }
    settle_what_came(asked);
    if (to_ns > question.decided_ns && may_change(asked, to_ns)) decide_pieces(asked, to_ns);
    question.decided_ns = std::max(question.decided_ns, to_ns);
  }
  question.has_nearest = asked.nearest != kNone;
}

/// False: the reference does not exist, or is a part of a scene, which has no body of its own.
bool NearestDecisions::find_about(NearestAsked& asked) const {
  if (!table_.is_carried(asked.fence)) return true;
  asked.about = table_.carrier(asked.fence);
  if (asked.about == kNone) return false;
  const ObjectInfo& about = *rows_.info(asked.about);
  if (about.scene_part != kNoScenePart) return false;
  if (about.id != asked.question.about) asked.question.is_begun = false;
  asked.question.about = about.id;
  return true;
}

/// Time up to which all its monitored objects are known; publishers silent for too long are not waited for.
std::int64_t NearestDecisions::known_ns(const NearestAsked& asked) const {
  std::int64_t known_ns = kForEver;
  const auto wait_for = [&](std::uint32_t source) {
    if (source != Sources::kResting) known_ns = std::min(known_ns, step_.sources[source].known_of(0));
  };
  std::for_each(asked.group.sources.begin(), asked.group.sources.end(), wait_for);
  if (asked.about != kNone) wait_for(rows_.source(asked.about));
  return known_ns == kForEver ? step_.world_time_ns : std::max(known_ns, step_.sources.floor_ns());
}

const OpenContact* NearestDecisions::open_of(std::uint32_t fence) const {
  const OpenContact* open = nullptr;
  ledger_.for_each_with(table_.id(fence), [&](std::uint32_t number) {
    open = &ledger_.open()[number];
    return false;
  });
  return open;
}

/// Nothing is reported for the time before the question.
void NearestDecisions::begin(NearestAsked& asked, std::int64_t time_ns) {
  asked.question.is_begun = true;
  asked.question.decided_ns = time_ns;
  asked.nearest = kNone;
  find_candidates(asked, grown(bounds_about(asked, {time_ns, time_ns}), asked.rule.within_m));
  const std::uint32_t nearest = nearest_of_found(asked, time_ns);
  if (nearest != kNone) tell(asked, {nearest, at_once(time_ns)});
  note_reach(asked, time_ns);
}

/// Takes new objects whose given beginning lies in decided time.
void NearestDecisions::settle_what_came(NearestAsked& asked) {
  found_.clear();
  for (const std::uint32_t slot : asked.group.came) {
    if (may_be(asked, slot) && born_ns(slot) <= asked.question.decided_ns) found_.push_back(slot);
  }
  order_found();
  const std::uint32_t nearer = nearest_of_found(asked, asked.question.decided_ns);
  if (nearer == kNone || !is_surely_nearer(asked, nearer, asked.question.decided_ns)) return;
  tell(asked, {nearer, at_once(asked.question.decided_ns)});
  note_reach(asked, asked.question.decided_ns);
}

/// A filter: true if a relevant object moved or began by then. Costs one search of the index if nothing changes.
bool NearestDecisions::may_change(const NearestAsked& asked, std::int64_t to_ns) {
  const Stretch newly{asked.question.decided_ns, to_ns};
  const auto moves = [&](std::uint32_t slot) {
    return slot != kNone && paths_.moves(slot, newly.from_ns, newly.to_ns);
  };
  if (moves(asked.about) || moves(asked.nearest)) return true;
  const std::vector<std::uint32_t>& young = asked.group.young;
  const auto begins = [&](std::uint32_t slot) { return born_ns(slot) > newly.from_ns && born_ns(slot) <= newly.to_ns; };
  if (std::any_of(young.begin(), young.end(), begins)) return true;
  if (paths_.travelling().empty()) return false;
  const double reach_m = asked.nearest == kNone ? asked.rule.within_m : asked.question.reach_m;
  bool is_any = false;
  const auto look_at = [&](std::uint32_t slot) {
    is_any = may_be(asked, slot) && moves(slot);
    return !is_any;
  };
  movers_.walk_box(grown(bounds_about(asked, newly), reach_m), look_at, walk_);
  return is_any;
}

void NearestDecisions::decide_pieces(NearestAsked& asked, std::int64_t to_ns) {
  std::int64_t from_ns = asked.question.decided_ns;
  for (const std::int64_t end_ns : cuts(asked, to_ns)) {
    decide_piece(asked, {from_ns, end_ns});
    from_ns = end_ns;
  }
  note_reach(asked, to_ns);
}

/// Divides at all instants of all publishers that it waits for, so that the pieces do not depend on when messages
/// arrived.
std::vector<std::int64_t> NearestDecisions::cuts(const NearestAsked& asked, std::int64_t to_ns) const {
  std::vector<std::int64_t> times{to_ns};
  const auto add = [&](std::uint32_t number) {
    if (number == Sources::kResting) return;
    const Source& source = step_.sources[number];
    const std::int64_t back_ns = source.is_streamed ? source.gap_ns : 0;
    for (const std::int64_t instant : source.instants) {
      for (const std::int64_t time : {instant, instant - back_ns}) {
        if (time > asked.question.decided_ns && time < to_ns) times.push_back(time);
      }
    }
  };
  std::for_each(asked.group.sources.begin(), asked.group.sources.end(), add);
  if (asked.about != kNone) add(rows_.source(asked.about));
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

void NearestDecisions::decide_piece(NearestAsked& asked, Stretch piece) {
  for (std::uint32_t changes = 0; changes < kMostChanges; ++changes) {
    find_candidates(asked, grown(bounds_about(asked, piece), reach_m(asked, piece)));
    const std::optional<Change> change = first_change(asked, piece);
    if (!change) return;
    tell(asked, *change);
    piece.from_ns = change->bracket.high_ns;
    if (piece.from_ns >= piece.to_ns) return decide_end(asked, {change->bracket.low_ns, piece.to_ns});
  }
  ++cost_.sweeps_skipped;
}

/// After a change in the last nanosecond of a piece: changes in the rest of that nanosecond are not found, but the end
/// of the piece counts, since nothing may move for a long time after it.
void NearestDecisions::decide_end(NearestAsked& asked, const BracketNs& last) {
  const std::int64_t to_ns = last.high_ns;
  find_candidates(asked, grown(bounds_about(asked, {to_ns, to_ns}), reach_m(asked, {to_ns, to_ns})));
  const std::uint32_t other = nearest_of_found(asked, to_ns);
  const bool is_nearer = other != kNone && is_surely_nearer(asked, other, to_ns);
  const bool has_left = asked.nearest != kNone && is_surely_nearer(asked, kNone, to_ns);
  if (is_nearer || has_left) tell(asked, {other, last});
}

/// Ends the old nearest and begins the new one, with the distance at the end of the bracket.
void NearestDecisions::tell(NearestAsked& asked, const Change& change) {
  const ObjectId question = table_.id(asked.fence);
  const std::int64_t error_ns = clock_error_ns(asked, change.to);
  const double low_s = change.is_by_step ? 0 : step_.seconds_ago(change.bracket.low_ns - error_ns);
  const double high_s = change.is_by_step ? 0 : step_.seconds_ago(change.bracket.high_ns + error_ns);
  if (asked.nearest != kNone && asked.nearest != change.to)
    ledger_.parts(rows_.info(asked.nearest)->id, question, EndReason::separated, low_s, high_s);
  asked.nearest = change.to;
  if (change.to == kNone) return;
  const GapBounds gap = gap_at(asked, change.to, change.bracket.high_ns, asked.rule.reach_m() * 2);
  FoundContact found{.a = rows_.info(change.to)->id,
                     .b = question,
                     .contact = {.point = gap.at.on_b,
                                 .normal = -gap.at.normal,
                                 .depth_m = -(gap.low_m + gap.high_m) / 2,
                                 .depth_error_m = (gap.high_m - gap.low_m) / 2 * (1 + kBoundSlack)}};
  found.bracket_low_s = found.parted_low_s = low_s;
  found.bracket_high_s = found.parted_high_s = high_s;
  ledger_.touches(found);
}

std::int64_t NearestDecisions::clock_error_ns(const NearestAsked& asked, std::uint32_t other) const {
  std::uint32_t first = Sources::kResting;
  for (const std::uint32_t slot : {asked.about, asked.nearest, other}) {
    const std::uint32_t source = slot == kNone ? Sources::kResting : rows_.source(slot);
    if (source == Sources::kResting || source == first) continue;
    if (first != Sources::kResting) return step_.options.clock_error_ns;
    first = source;
  }
  return 0;
}

void NearestDecisions::note_reach(const NearestAsked& asked, std::int64_t time_ns) {
  if (asked.nearest == kNone) return;
  const double most_m = asked.rule.reach_m();
  asked.question.reach_m = std::min(most_m, gap_at(asked, asked.nearest, time_ns, most_m).high_m);
}

}  // namespace collided::engine
