// Candidates for the nearest of a standing question, and when one is nearer than another.

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/geometry/tolerance.hpp"
#include "server/world/fences/nearest_decisions.hpp"
#include "server/world/fences/standing_piece.hpp"

namespace collided::engine {
namespace {

/// Each evaluation involves three bodies.
constexpr LookBudget kNearestLooks{.most = 1'000, .of_step = 200'000, .least = 100};

}  // namespace

bool NearestDecisions::may_be(const NearestAsked& asked, std::uint32_t slot) const {
  return asked.group.holds(slot) && slot != asked.about && slot != asked.nearest;
}

void NearestDecisions::find_candidates(const NearestAsked& asked, const Aabb& box) {
  found_.clear();
  const auto add = [&](std::uint32_t slot) {
    if (may_be(asked, slot)) found_.push_back(slot);
    return true;
  };
  movers_.walk_box(box, add, walk_);
  order_found();
}

/// Ties go to the first name, independent of ids.
void NearestDecisions::order_found() {
  std::sort(found_.begin(), found_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return rows_.info(a)->name < rows_.info(b)->name; });
}

/// Bounds of the question's reference in a piece of time.
Aabb NearestDecisions::bounds_about(const NearestAsked& asked, const Stretch& piece) {
  Aabb all = bounds_of(info(asked, asked.about), frame_at(asked.about, piece.from_ns));
  if (asked.about == kNone) return all;
  std::int64_t from_ns = piece.from_ns;
  for (const std::int64_t end_ns : part_ends(asked, kNone, piece)) {
    all.extend(bounds(*rows_.info(asked.about), body(asked, asked.about, {from_ns, end_ns}).motion,
                      rows_[asked.about].reach_m));
    all.extend(bounds_of(*rows_.info(asked.about), frame_at(asked.about, end_ns)));
    from_ns = end_ns;
  }
  return all;
}

/// Upper bound on the distance of the nearest in the piece: its distance at the start, plus the paths of both.
double NearestDecisions::reach_m(const NearestAsked& asked, const Stretch& piece) {
  if (asked.nearest == kNone) return asked.rule.within_m;
  const double most_m = asked.rule.reach_m();
  double reach_m = gap_at(asked, asked.nearest, piece.from_ns, most_m).high_m;
  std::int64_t from_ns = piece.from_ns;
  for (const std::int64_t end_ns : part_ends(asked, kNone, piece)) {
    for (const std::uint32_t slot : {asked.about, asked.nearest}) {
      if (slot == kNone) continue;
      if (paths_.jumps(slot, end_ns)) return most_m;
      reach_m += body(asked, slot, {from_ns, end_ns}).motion.length_m(rows_[slot].reach_m) * (1 + kBoundSlack);
    }
    from_ns = end_ns;
  }
  return std::min(reach_m, most_m);
}

/// kNone if none of them is near enough at that time.
std::uint32_t NearestDecisions::nearest_of_found(const NearestAsked& asked, std::int64_t time_ns) {
  std::uint32_t nearest = kNone;
  double nearest_m = asked.rule.within_m;
  for (const std::uint32_t slot : found_) {
    if (born_ns(slot) > time_ns) continue;
    const double high_m = gap_at(asked, slot, time_ns, nearest_m).high_m;
    if (nearest == kNone ? high_m > nearest_m : high_m >= nearest_m) continue;
    nearest = slot;
    nearest_m = high_m;
  }
  return nearest;
}

std::optional<NearestDecisions::Change> NearestDecisions::first_change(const NearestAsked& asked,
                                                                       const Stretch& piece) {
  std::optional<Change> first;
  std::int64_t until_ns = piece.to_ns;
  cut_from_ns_ = kForEver;
  const auto gap_of = [&](std::uint32_t slot) {
    return gap_at(asked, slot, until_ns, std::numeric_limits<double>::infinity()).high_m;
  };
  for (const std::uint32_t slot : found_) {
    const std::optional<BracketNs> time = first_time(asked, slot, piece, until_ns);
    if (!time || (first && time->high_ns > until_ns)) continue;
    if (first && time->high_ns == until_ns && gap_of(slot) >= gap_of(first->to)) continue;
    first = {slot, *time};
    until_ns = time->high_ns;
  }
  if (asked.nearest != kNone) {
    const std::optional<BracketNs> left = first_time(asked, kNone, piece, until_ns);
    // With a hysteresis, another object may be near enough by then without having been nearer.
    if (left && !(first && left->high_ns >= until_ns)) first = {nearest_of_found(asked, left->high_ns), *left};
  }
  // A change that a cut-short search missed may have come earlier.
  if (first) first->bracket.low_ns = std::min(first->bracket.low_ns, cut_from_ns_);
  return first;
}

/// When the candidate is first certainly nearer than the nearest, or near enough if there is no nearest. For kNone:
/// when the nearest is certainly beyond its reach. Nothing: not in the piece, or only after until_ns.
std::optional<BracketNs> NearestDecisions::first_time(const NearestAsked& asked, std::uint32_t nearer,
                                                      const Stretch& piece, std::int64_t until_ns) {
  std::int64_t from_ns = piece.from_ns;
  if (nearer != kNone && born_ns(nearer) > from_ns) {
    from_ns = born_ns(nearer);
    if (from_ns > piece.to_ns) return std::nullopt;
    if (is_surely_nearer(asked, nearer, from_ns)) return BracketNs{from_ns, from_ns};
  }
  for (const std::int64_t end_ns : part_ends(asked, nearer, {from_ns, piece.to_ns})) {
    if (from_ns > until_ns) return std::nullopt;
    if (const auto time = first_time_in_part(asked, nearer, {from_ns, end_ns})) return time;
    from_ns = end_ns;
  }
  return std::nullopt;
}

std::optional<BracketNs> NearestDecisions::first_time_in_part(const NearestAsked& asked, std::uint32_t nearer,
                                                              const Stretch& part) {
  const GapBody about = body(asked, asked.about, part);
  const GapBody other = nearer == kNone ? GapBody{} : body(asked, nearer, part);
  const GapBody nearest = asked.nearest == kNone ? GapBody{} : body(asked, asked.nearest, part);
  const double length_ns = static_cast<double>(part.to_ns - part.from_ns);
  bool is_cut_short = false;
  std::int64_t low_ns = part.to_ns;
  if (!is_resting(about.motion) || !is_resting(other.motion) || !is_resting(nearest.motion)) {
    const GapSide side = nearer == kNone ? GapSide{nullptr, asked.rule.reach_m()} : GapSide{&other, 0};
    const GapSide bar = asked.nearest == kNone ? GapSide{nullptr, asked.rule.within_m}
                                               : GapSide{&nearest, nearer == kNone ? 0 : -asked.rule.hysteresis_m};
    const GapOptions options{.width = bracket_width(part.from_ns, part.to_ns),
                             .most_looks = kNearestLooks.after(cost_.sweep_looks),
                             .looks = &cost_.sweep_looks};
    ++cost_.swept;
    const NearerTime time = first_nearer(about, side, bar, options, walk_);
    const double round_ns = 4 * kRoundoff * length_ns;
    const auto whole_ns = [&](double ns) { return part.from_ns + static_cast<std::int64_t>(ns); };
    low_ns = whole_ns(std::floor(std::max(0.0, time.bracket.low * length_ns - round_ns)));
    const std::int64_t high_ns = whole_ns(std::ceil(time.bracket.high * length_ns + round_ns));
    if (time.yes) return BracketNs{low_ns, std::min(high_ns, part.to_ns)};
    is_cut_short = time.is_cut_short;
    if (is_cut_short) {
      ++cost_.sweeps_skipped;
      cut_from_ns_ = std::min(cut_from_ns_, low_ns);
    }
  }
  const auto jumps = [&](std::uint32_t slot) { return slot != kNone && paths_.jumps(slot, part.to_ns); };
  const bool is_any_jump = jumps(asked.about) || jumps(asked.nearest) || jumps(nearer);
  if (!(is_cut_short || is_any_jump) || !is_surely_nearer(asked, nearer, part.to_ns)) return std::nullopt;
  return BracketNs{is_cut_short ? low_ns : part.to_ns, part.to_ns};
}

/// The times at which one of the three begins or ends a motion; they do not depend on other objects nearby.
std::vector<std::int64_t> NearestDecisions::part_ends(const NearestAsked& asked, std::uint32_t nearer,
                                                      const Stretch& piece) const {
  std::vector<std::int64_t> times;
  if (piece.to_ns > piece.from_ns) times.push_back(piece.to_ns);
  for (const std::uint32_t slot : {asked.about, asked.nearest, nearer}) {
    if (slot != kNone) paths_.add_times(slot, piece.from_ns, piece.to_ns, times);
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

bool NearestDecisions::is_surely_nearer(const NearestAsked& asked, std::uint32_t nearer, std::int64_t time_ns) {
  const double reach_m = asked.rule.reach_m();
  if (nearer == kNone) return gap_at(asked, asked.nearest, time_ns, reach_m * 2).low_m > reach_m;
  if (asked.nearest == kNone) return gap_at(asked, nearer, time_ns, reach_m).high_m <= asked.rule.within_m;
  const double bar_m = gap_at(asked, asked.nearest, time_ns, std::numeric_limits<double>::infinity()).low_m;
  return gap_at(asked, nearer, time_ns, bar_m).high_m < bar_m - asked.rule.hysteresis_m;
}

GapBounds NearestDecisions::gap_at(const NearestAsked& asked, std::uint32_t slot, std::int64_t time_ns,
                                   double limit_m) {
  const Frame frame_about = frame_at(asked.about, time_ns);
  const Frame frame = frame_at(slot, time_ns);
  const ObjectInfo& about = info(asked, asked.about);
  const Placed a{.info = &about, .frame = frame_about, .bounds = bounds_of(about, frame_about), .pose = nullptr};
  const ObjectInfo& other = *rows_.info(slot);
  const Placed b{.info = &other, .frame = frame, .bounds = bounds_of(other, frame), .pose = nullptr};
  ++cost_.exact_tests;
  GapBounds gap = gap_bounds(a, b, limit_m, walk_);
  const double error_m = off_m(asked.about, time_ns) + off_m(slot, time_ns);
  gap.low_m = std::max(0.0, gap.low_m - error_m);
  if (error_m > 0) gap.high_m += error_m;
  return gap;
}

GapBody NearestDecisions::body(const NearestAsked& asked, std::uint32_t slot, const Stretch& part) {
  if (slot == kNone) return {.info = &info(asked, slot), .motion = BodyMotion::resting(Frame{}), .reach_m = 0};
  const BodyMotion motion = paths_.motion(slot, part.from_ns, part.to_ns, rows_[slot].pose);
  return {.info = rows_.info(slot),
          .motion = motion,
          .reach_m = motion.turn_rad > 0 ? motion.lever_m(rows_[slot].reach_m) : 0,
          .off_m = std::max(off_m(slot, part.from_ns), off_m(slot, part.to_ns))};
}

Frame NearestDecisions::frame_at(std::uint32_t slot, std::int64_t time_ns) const {
  return slot == kNone ? Frame{} : paths_.at(slot, time_ns, rows_[slot].pose);
}

/// Bound on the object's distance from its motion at frame_at().
double NearestDecisions::off_m(std::uint32_t slot, std::int64_t time_ns) const {
  const MotionSegment* segment = slot == kNone ? nullptr : paths_.under_way(slot, time_ns);
  return segment == nullptr || time_ns == segment->to_ns ? 0 : segment->path().error_m(rows_[slot].reach_m);
}

/// The object in the given slot; kNone: the question's point.
const ObjectInfo& NearestDecisions::info(const NearestAsked& asked, std::uint32_t slot) {
  return slot == kNone ? table_.body(asked.fence) : *rows_.info(slot);
}

}  // namespace collided::engine
