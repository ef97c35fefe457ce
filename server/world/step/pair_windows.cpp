#include "server/world/step/pair_windows.hpp"

#include <algorithm>
#include <cmath>

namespace collided::engine {
namespace {

/// Relative error of where objects are between two poses: a few roundings of the coordinates.
constexpr double kPlaceSlack = 0x1p-49;

}  // namespace

bool are_on_common_time(const StepView& step, std::uint32_t first, std::uint32_t second) {
  const Sources& sources = step.sources;
  const ObjectRows& rows = step.rows;
  const std::uint32_t source = rows.source(first);
  if (!sources.need_common_time() || source == Sources::kResting || rows.source(second) == Sources::kResting)
    return false;
  if (source != rows.source(second) || sources[source].is_streamed) return true;
  if (!sources[source].has_spoken) return false;
  // For two objects of one publisher: objects that it moved at one instant share the motion's time, and only these.
  if (!rows.is_posed(first) || !rows.is_posed(second)) return rows.is_posed(first) || rows.is_posed(second);
  const auto has_own_motion = [&](std::uint32_t slot) {
    const ObjectRow& row = rows[slot];
    return row.posed_before_ns >= row.posed_ns || (rows.is_new(slot) && row.born_ns < row.posed_ns);
  };
  if (has_own_motion(first) || has_own_motion(second) || rows.motion(first) != rows.motion(second)) return true;
  const ObjectRow& a = rows[first];
  const ObjectRow& b = rows[second];
  return a.posed_before_ns != b.posed_before_ns || a.posed_ns != b.posed_ns;
}

PairWindow window_of(const StepView& step, std::uint32_t first, std::uint32_t second) {
  const ObjectRows& rows = step.rows;
  const auto known_ns = [&](std::uint32_t slot) {
    return step.sources[rows.source(slot)].known_of(rows[slot].posed_ns);
  };
  const auto settled_ns = [&](std::uint32_t slot) {
    const ObjectRow& row = rows[slot];
    return step.sources[rows.source(slot)].settled_of(rows.is_posed(slot) ? row.said_before_ns : row.posed_ns);
  };
  // Motions of one publisher since the last step are complete for its own pairs, however far other publishers are.
  const std::uint32_t source = rows.source(first);
  const bool needs_memory = source != rows.source(second) || step.sources[source].is_streamed;
  const std::int64_t joined_ns = std::max(rows[first].joined_ns, rows[second].joined_ns);
  const std::int64_t floor_ns = needs_memory ? std::max(step.sources.floor_ns(), joined_ns) : 0;
  const std::int64_t decided_ns = std::min(settled_ns(first), settled_ns(second));
  const std::int64_t from_ns = std::max({decided_ns, rows[first].born_ns, rows[second].born_ns, floor_ns});
  // If the window does not continue the decided time, the pair begins again, however many steps ago both objects were
  // added.
  const bool begins = from_ns > decided_ns || rows.is_new(first) || rows.is_new(second) || step.looks_at_all;
  return {.decided_ns = decided_ns,
          .from_ns = from_ns,
          .to_ns = std::min(known_ns(first), known_ns(second)),
          .is_closed = begins};
}

void cut(const StepView& step, std::uint32_t first, std::uint32_t second, const PairWindow& window,
         std::vector<std::int64_t>& cuts) {
  cuts.assign(1, window.to_ns);
  for (const std::uint32_t slot : {first, second}) {
    step.motion.history().add_times(slot, window.from_ns, window.to_ns, cuts);
    const Source& source = step.sources[step.rows.source(slot)];
    const std::int64_t back_ns = source.is_streamed ? source.gap_ns : 0;
    for (const std::int64_t instant : source.instants) {
      for (const std::int64_t time : {instant, instant - back_ns}) {
        if (time > window.from_ns && time < window.to_ns) cuts.push_back(time);
      }
    }
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
}

BracketNs rounded_outward(std::int64_t from_ns, std::int64_t to_ns, const TimeBracket& bracket) {
  const double length_ns = static_cast<double>(to_ns - from_ns);
  const double low = std::clamp(bracket.low * length_ns, 0.0, length_ns);
  const double high = std::clamp(bracket.high * length_ns, 0.0, length_ns);
  return {.low_ns = from_ns + static_cast<std::int64_t>(std::floor(low)),
          .high_ns = from_ns + static_cast<std::int64_t>(std::ceil(high))};
}

BracketNs in_nanoseconds(std::int64_t from_ns, std::int64_t to_ns, const MotionPair& motions,
                         const TimeBracket& bracket, const Vec3& point, const Vec3& normal) {
  double place_m = 0;
  for (const BodyMotion* path : {&motions.a, &motions.b}) {
    place_m += path->from.position.cwiseAbs().maxCoeff() + path->to.position.cwiseAbs().maxCoeff();
  }
  const auto motion_of = [&](const BodyMotion& motion) {
    return motion.turn_rad == 0 ? motion.travel : motion.velocity(point, bracket.high, 1, 0).mps;
  };
  const double closing_m = std::abs(normal.dot(motion_of(motions.b) - motion_of(motions.a)));
  const double slack = kPlaceSlack * place_m < closing_m ? kPlaceSlack * place_m / closing_m : 1;
  return rounded_outward(from_ns, to_ns, {bracket.low - slack, bracket.high + slack});
}

}  // namespace collided::engine
