#include "server/world/query/stale_reach.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "idl/clocks.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/sweep.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/ray_entry.hpp"

namespace collided::engine {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// The region in which the object may be by now, including rounding.
Aabb region_of(const StaleObject& object, std::int64_t world_time_ns) {
  const std::int64_t age_ns = std::max<std::int64_t>(0, world_time_ns - object.posed_ns) + kAgeSlackNs;
  const double travel_m = object.speed_mps * static_cast<double>(age_ns) * wire_contract::kNanosecond_s;
  Aabb region;
  region.extend(object.position);
  const double slack_m = object.position.cwiseAbs().maxCoeff() + object.reach_m + travel_m;
  return grown(region, object.reach_m + travel_m + kBoundSlack * slack_m);
}

double least_distance(const Vec3& point, const Aabb& region) {
  const Vec3 out = (region.low - point).cwiseMax(point - region.high).cwiseMax(0);
  return out.norm() * (1 - kBoundSlack);
}

Aabb motion_of(const ObjectInfo& mover, const double* n) {
  Aabb motion;
  motion.extend(Vec3(n[0], n[1], n[2]));
  motion.extend(Vec3(n[7], n[8], n[9]));
  return grown(motion, reach_of(mover) * (1 + kBoundSlack));
}

/// The distance of the last hit of a full answer; infinite if the answer had room for more.
double answered_up_to(const Questions& asked, std::span<const AnswerHit> hits) {
  return hits.size() < asked.max_hits ? kUnlimited : hits.back().distance_m + hits.back().error_m;
}

/// True if an object somewhere within the region could change this answer.
bool could_change(const Questions& asked, const double* n, std::span<const AnswerHit> hits, const Aabb& region) {
  switch (asked.kind) {
    case QuestionKind::ray: {
      const double entry = entry_of(ray_of(n), region);
      if (hits.empty()) return entry < kUnlimited;
      return asked.mode == HitMode::closest && entry < hits[0].distance_m + hits[0].error_m;
    }
    case QuestionKind::sphere: return hits.empty() && overlaps(bounds(sphere_of(n)), region);
    case QuestionKind::inside: return hits.empty() && least_distance(point_of(n), region) <= 0;
    case QuestionKind::box: return hits.empty() && overlaps(bounds(box_of(n)), region);
    case QuestionKind::near: {
      const double distance = least_distance(point_of(n), region);
      return distance <= n[3] && distance < answered_up_to(asked, hits);
    }
    case QuestionKind::sweep: return overlaps(motion_of(*asked.mover, n), region);
    default: return false;
  }
}

}  // namespace

std::optional<Aabb> unknown_region(const Snapshot& snapshot, ObjectId id) {
  for (const StaleObject& object : snapshot.stale_objects) {
    if (object.id == id && object.speed_mps > 0) return region_of(object, snapshot.world_time_ns);
  }
  return std::nullopt;
}

void doubt_where_stale_objects_reach(const Snapshot& snapshot, const Questions& questions, Answers& answers) {
  const std::uint32_t stride = numbers_of(questions.kind);
  for (const StaleObject& object : snapshot.stale_objects) {
    const bool stands_still = object.speed_mps == 0;
    if (stands_still || !may_answer(*snapshot.objects[slot_of(object.id)], questions)) continue;
    const Aabb region = region_of(object, snapshot.world_time_ns);
    std::size_t first_hit = 0;
    for (std::size_t i = 0; i < answers.answers.size(); ++i) {
      const std::span<const AnswerHit> hits = std::span(answers.hits).subspan(first_hit, answers.hit_counts[i]);
      first_hit += hits.size();
      const bool is_claim = answers.answers[i] == Verdict::miss || answers.answers[i] == Verdict::hit;
      const bool is_met =
          std::any_of(hits.begin(), hits.end(), [&](const AnswerHit& hit) { return hit.object == object.id; });
      if (!is_claim || is_met || !could_change(questions, &questions.numbers[i * stride], hits, region)) continue;
      answers.answers[i] = Verdict::undecided;
      answers.reasons[i] = UndecidedReason::stale_object;
    }
  }
}

}  // namespace collided::engine
