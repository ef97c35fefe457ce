#include "server/world/explain/ray_explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <unordered_set>

#include <collided/explanations.hpp>

#include "server/exact_phase/given/given_ray.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/world/explain/ray_misses.hpp"
#include "server/world/query/covered.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/ray_entry.hpp"
#include "server/world/query/stale_reach.hpp"

namespace collided::engine {
namespace {

using std::chrono::nanoseconds;

constexpr double kEndless = std::numeric_limits<double>::infinity();
/// Limit for one ray; each triangle of a mesh counts.
constexpr std::uint32_t kMostHits = 100'000;

const ObjectInfo& info_of(const Snapshot& snapshot, ObjectId id) { return *snapshot.objects[slot_of(id)]; }

/// Finds the primitive of the object that the ray meets first, and which arithmetic decided it.
void find_part(const Ray& ray, const Snapshot& snapshot, const ObjectInfo& info, ExplainedMeeting& meeting) {
  double nearest_m = kEndless;
  for (std::size_t i = 0; i < info.primitives.size(); ++i) {
    RayHit hit;
    const std::uint32_t slot = slot_of(info.id);
    const Frame frame = snapshot.frame(slot);
    const Primitive& own = info.primitives[i];
    const double off_m =
        snapshot.has_given_poses ? placing_error_m(frame, own, (ray.origin - frame.position).lpNorm<1>()) : 0;
    const auto given = [&] { return GivenPart{.own = &own, .pose = &snapshot.poses[slot], .frame = &frame}; };
    const ExactResult verdict = std::visit(
        [&](const auto& part) { return cast_ray_as_given(ray, place(frame, part), off_m, given, hit); }, own);
    if (!verdict.yes() || hit.distance_m >= nearest_m) continue;
    nearest_m = hit.distance_m;
    meeting.rung = static_cast<Rung>(verdict.level);
    meeting.part = static_cast<std::uint32_t>(i);
  }
  if (info.primitives.size() < 2 && !info.mesh) meeting.part.reset();
}

std::optional<Triangle> placed_triangle(const Snapshot& snapshot, const ObjectInfo& info, std::uint32_t triangle) {
  if (info.scene_part == kNoScenePart) {
    if (!info.mesh) return std::nullopt;
    return place(snapshot.frame(slot_of(info.id)), info.mesh->mesh->triangle(triangle));
  }
  for (const auto& scene : snapshot.scenes) {
    if (info.scene_part >= scene->parts.size() || scene->part_objects[info.scene_part] != info.id) continue;
    return scene->mesh.triangle(scene->parts[info.scene_part].first_triangle + triangle);
  }
  return std::nullopt;
}

ExplainedMeeting meeting_of(const Ray& ray, const Snapshot& snapshot, const RayExplanationAsk& ask,
                            const AnswerHit& hit) {
  const ObjectInfo& info = info_of(snapshot, hit.object);
  ExplainedMeeting meeting{.object = info.name,
                           .kind = std::string(kind_of(info)),
                           .distance_m = hit.distance_m,
                           .error_m = hit.error_m,
                           .point = hit.point,
                           .normal = hit.normal,
                           .triangle = info.reported_triangle(hit.triangle),
                           .inside = (hit.flags & kHitInside) != 0,
                           .stale = (hit.flags & kHitStale) != 0,
                           .why_left_out = why_left_out(info, ask)};
  if (const std::int64_t posed_ns = snapshot.posed_ns[slot_of(info.id)]; posed_ns > 0)
    meeting.age = nanoseconds(std::max<std::int64_t>(0, snapshot.world_time_ns - posed_ns));
  if (hit.triangle == kNoTriangle) {
    find_part(ray, snapshot, info, meeting);
  } else if (const std::optional<Triangle> triangle = placed_triangle(snapshot, info, hit.triangle)) {
    RayHit again;
    meeting.rung = static_cast<Rung>(cast_ray(ray, *triangle, again).level);
  }
  return meeting;
}

/// Answers one ray in a mode.
Answers answered(const Snapshot& snapshot, Questions asked, HitMode mode) {
  asked.mode = mode;
  asked.max_hits = kMostHits;
  Answers answers;
  QueryScratch scratch;
  answer(snapshot, asked, answers, scratch);
  doubt_where_not_held(snapshot, asked, answers);
  return answers;
}

/// The first hit of each object, in order.
std::vector<AnswerHit> first_hits(const Answers& answers) {
  std::vector<AnswerHit> first;
  std::unordered_set<ObjectId> seen;
  for (const AnswerHit& hit : answers.hits) {
    if (seen.insert(hit.object).second) first.push_back(hit);
  }
  return first;
}

void tell_answer(const Answers& answers, ExplainedRay& told) {
  told.verdict = static_cast<collided::Verdict>(answers.answers[0]);
  told.reason = static_cast<collided::UndecidedReason>(answers.reasons[0]);
  told.rung = static_cast<Rung>(answers.levels[0]);
  told.nodes = answers.nodes[0];
  told.exact_tests = answers.exact_tests[0];
  if (answers.not_covered.empty()) return;
  const Leaving& leaving = answers.not_covered[0].leaving;
  told.uncovered = {.point = leaving.point, .covered_m = leaving.covered_m};
}

/// Lists what would have come before the answer without the filter.
void tell_left_out(const Ray& ray, const Snapshot& snapshot, const RayExplanationAsk& ask, ExplainedRay& told) {
  Questions all = ask.questions();
  all.mask = 0xffffffff;
  all.only = all.skip = {};
  const double end_m = told.met.empty() ? kEndless : told.met[0].distance_m + told.met[0].error_m;
  for (const AnswerHit& hit : first_hits(answered(snapshot, all, HitMode::all))) {
    if (may_answer(info_of(snapshot, hit.object), ask.questions())) continue;
    if (hit.distance_m - hit.error_m <= end_m || ask.why_not == hit.object)
      told.left_out.push_back(meeting_of(ray, snapshot, ask, hit));
  }
}

void tell_stale(const Ray& ray, const Snapshot& snapshot, const RayExplanationAsk& ask, ExplainedRay& told) {
  for (const StaleObject& object : snapshot.stale_objects) {
    const ObjectInfo& info = info_of(snapshot, object.id);
    if (!may_answer(info, ask.questions())) continue;
    const std::optional<Aabb> region = unknown_region(snapshot, object.id);
    const double from_m = region ? entry_of(ray, *region) : kEndless;
    const nanoseconds age(std::max<std::int64_t>(0, snapshot.world_time_ns - object.posed_ns));
    if (from_m < kEndless) told.stale.push_back({.object = info.name, .age = age, .from_m = from_m});
  }
}

}  // namespace

std::string_view kind_of(const ObjectInfo& info) {
  if (info.scene_part != kNoTriangle) return "part";
  if (info.primitives.size() + (info.mesh ? 1 : 0) != 1) return "compound";
  if (info.mesh) return "mesh";
  constexpr std::string_view kNames[] = {"sphere", "box",       "capsule", "cylinder",
                                         "cone",   "ellipsoid", "hull",    "half_space"};
  return kNames[info.primitives[0].index()];
}

Questions RayExplanationAsk::questions() const {
  return {.kind = QuestionKind::ray, .mask = mask, .only = only, .skip = skip, .numbers = numbers};
}

std::string why_left_out(const ObjectInfo& info, const RayExplanationAsk& ask) {
  if (info.is_unknown) return "it is unknown space, which answers nothing";
  if ((info.filter.layers & ask.mask) == 0)
    return fmt::format("its layers {:#x} are not in the mask {:#x}", info.filter.layers, ask.mask);
  if (!ask.only.empty() && !glob_matches(ask.only, info.name))
    return fmt::format("only '{}' was asked about", ask.only);
  if (!ask.skip.empty() && glob_matches(ask.skip, info.name)) return fmt::format("'{}' was to be skipped", ask.skip);
  return {};
}

ExplainedRay explain_ray(const Snapshot& snapshot, const RayExplanationAsk& ask, PartMeshes& part_meshes,
                         Deadline& deadline) {
  const OwnFloatEnvironment own_floats;
  const Ray ray = ray_of(ask.numbers.data());
  ExplainedRay told;
  tell_answer(answered(snapshot, ask.questions(), HitMode::closest), told);
  const Answers all = answered(snapshot, ask.questions(), HitMode::all);
  told.cut = all.reasons[0] == UndecidedReason::truncated;
  std::unordered_set<ObjectId> met;
  for (const AnswerHit& hit : first_hits(all)) {
    told.met.push_back(meeting_of(ray, snapshot, ask, hit));
    met.insert(hit.object);
  }
  RayMisses misses(snapshot, ask, part_meshes);
  misses.look_at_boxes(met, told);
  if (told.left_out_count > 0) tell_left_out(ray, snapshot, ask, told);
  tell_stale(ray, snapshot, ask, told);
  misses.find(deadline, told);
  told.late = deadline.was_over();
  told.world_time = nanoseconds(snapshot.world_time_ns);
  told.version = snapshot.version;
  return told;
}

}  // namespace collided::engine
