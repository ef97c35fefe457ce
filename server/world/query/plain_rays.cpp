#include "server/world/query/plain_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "idl/question_rules.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/ray_answer.hpp"
#include "server/world/query/scene_walk.hpp"

namespace collided::engine {
namespace {

/// Which of two triangles comes first in the answer at equal distance: by the names of their objects, then by number.
bool precedes_in_answer(const Snapshot& snapshot, const StaticScene& a_scene, std::uint32_t a,
                        const StaticScene& b_scene, std::uint32_t b) {
  const ObjectId a_object = a_scene.part_objects[a_scene.part_of(a)];
  const ObjectId b_object = b_scene.part_objects[b_scene.part_of(b)];
  // Triangles of one part are ordered by number.
  if (a_object == b_object) return a < b;
  const ObjectTable& objects = snapshot.objects;
  return objects[slot_of(a_object)]->name < objects[slot_of(b_object)]->name;
}

/// A plain ray's state in the walk.
struct PlainWalker {
  // Without default values: a group's members would be written twice.
  PlainRay* of;
  const Snapshot* snapshot;
  bool any;
  bool with_hits;

  const Ray& ray() const { return of->ray; }
  double limit() const { return of->limit; }
  WalkCost& cost() const { return of->walk; }
  Bvh::RayGoal goal(std::size_t) const { return any ? Bvh::RayGoal::any : Bvh::RayGoal::nearest; }
  bool wants_hits() const { return with_hits; }
  double offer(const StaticScene& scene, std::uint32_t triangle, const Triangle& corners) const {
    if (of->met != kNoTriangle) return compare_with_best(scene, triangle, corners);
    if (is_met(corners, of->hit)) keep(scene, triangle);
    return of->limit;
  }
  void take(const StaticScene& scene, std::uint32_t triangle) const {
    of->met = triangle;
    of->scene = &scene;
    of->limit = -1;
  }

 private:
  /// For a candidate after the first hit. A function of its own, since most rays have one candidate.
  [[gnu::noinline]] double compare_with_best(const StaticScene& scene, std::uint32_t triangle,
                                             const Triangle& corners) const {
    // A clipped split produces a triangle twice, which would tie with itself.
    if (of->met == triangle && of->scene == &scene) return of->limit;
    RayHit next;
    if (!is_met(corners, next) || !is_nearer(next, scene, triangle, corners)) return of->limit;
    of->hit = next;
    keep(scene, triangle);
    return of->limit;
  }
  bool is_met(const Triangle& corners, RayHit& hit) const {
    const ExactResult verdict = cast_ray(of->ray, corners, hit);
    ++of->exact_tests;
    of->level = std::max(of->level, verdict.level);
    of->is_undecided = of->is_undecided || verdict.decision == Decision::undecided;
    return verdict.yes();
  }
  /// Takes the triangle of the ray's hit.
  void keep(const StaticScene& scene, std::uint32_t triangle) const {
    if (any) return take(scene, triangle);
    of->met = triangle;
    of->scene = &scene;
    of->limit = std::min(of->limit, reach_of(of->ray, of->hit, 0));
  }
  bool is_nearer(const RayHit& hit, const StaticScene& scene, std::uint32_t triangle, const Triangle& corners) const {
    const int order = order_of(hit, of->hit.distance_m, of->hit.distance_error_m);
    if (order != 0) return order < 0;
    const int exact_order = compare_hits(of->ray, corners, of->scene->mesh.triangle(of->met));
    return exact_order != 0 ? exact_order < 0 : precedes_in_answer(*snapshot, scene, triangle, *of->scene, of->met);
  }
};

inline PlainWalker walker_of(PlainRay& ray, const Snapshot& snapshot, const Questions& asked) {
  return {&ray, &snapshot, asked.mode == HitMode::any, asked.with_hits};
}

/// Converts to a hit inside the answer's storage: a copy of a hit made elsewhere would wait until its numbers have
/// reached the cache.
struct HitInPlace {
  const RayHit& hit;
  ObjectId object;
  std::uint32_t triangle;
  std::uint8_t flags;

  // NOLINTNEXTLINE(google-explicit-constructor): emplace_back converts.
  operator AnswerHit() const { return answer_hit(hit, object, triangle, flags); }
};

inline void append_hit(const Snapshot& snapshot, const PlainRay& ray, Answers& answers) {
  const StaticScene& scene = *ray.scene;
  const std::uint32_t part = scene.part_of(ray.met);
  const ObjectId object = scene.part_objects[part];
  const std::uint32_t slot = slot_of(object);
  const auto flags = static_cast<std::uint8_t>(snapshot.stale[slot] != 0 ? kHitStale : 0);
  answers.hits.emplace_back(HitInPlace{ray.hit, object, ray.met - scene.parts[part].first_triangle, flags});
  const std::int64_t posed_ns = snapshot.posed_ns[slot];
  if (posed_ns == 0) return;
  answers.oldest_pose_ns = answers.oldest_pose_ns < 0 ? posed_ns : std::min(answers.oldest_pose_ns, posed_ns);
}

[[gnu::noinline]] void walk_many(const PlainWalker& walker, const SceneList& scenes) { walk_scenes(walker, scenes); }

inline void walk(const Snapshot& snapshot, const Questions& asked, PlainRay& ray) {
  const PlainWalker walker = walker_of(ray, snapshot, asked);
  if (snapshot.scenes.are_many()) return walk_many(walker, snapshot.scenes);
  for (const auto& scene : snapshot.scenes) {
    walk_scene(walker, *scene, walker.goal(0));
    if (ray.limit < 0) return;
  }
}

inline bool reaches(const Snapshot& snapshot, const std::vector<std::uint8_t>& allowed, PlainRay& ray) {
  if (ray.limit < 0 || !snapshot.grid || snapshot.grid->size() == 0) return false;
  bool reaches = false;
  WalkCost cost = ray.walk;
  const auto candidate = [&](std::uint32_t slot, double limit) {
    reaches = allowed[slot] != 0;
    return reaches ? -1 : limit;
  };
  snapshot.grid->walk_ray(ray.ray, ray.limit, candidate, cost);
  if (!reaches) ray.walk = cost;
  return reaches;
}

[[gnu::noinline]] bool keeps_rules_one_by_one(const double* ray) {
  return wire_contract::keeps_rules<wire_contract::kRayFields>(ray);
}

/// Checking the rules number by number costs more than a node of the tree. If the sum of magnitudes is within the
/// limit, each is; a larger sum decides nothing.
[[gnu::always_inline]] inline bool keeps_ray_rules(const double* numbers) {
  const double direction = std::abs(numbers[3]) + std::abs(numbers[4]) + std::abs(numbers[5]);
  const double sum = std::abs(numbers[0]) + std::abs(numbers[1]) + std::abs(numbers[2]) + direction;
  const bool is_usual = direction > 0 && sum <= wire_contract::kMostCoordinate && numbers[6] >= 0;
  return is_usual || keeps_rules_one_by_one(numbers);
}

inline bool start(const double* numbers, PlainRay& ray) {
  if (!keeps_ray_rules(numbers)) return false;
  ray.ray = ray_of(numbers);
  ray.limit = limit_of(ray.ray);
  ray.walk = {};
  ray.exact_tests = 0;
  ray.level = Level::filter;
  ray.is_undecided = false;
  ray.met = kNoTriangle;
  return is_limit_known(ray.ray, ray.limit);
}

/// A miss needs a no from every test; in mode `any` one certain hit is enough.
inline void write(const Snapshot& snapshot, const Questions& asked, const PlainRay& ray, std::size_t place,
                  Answers& answers) {
  const bool is_hit = ray.met != kNoTriangle;
  const bool is_told = is_hit && asked.with_hits;
  const bool is_open = ray.is_undecided && !(is_hit && asked.mode == HitMode::any);
  const Verdict plain = is_hit ? Verdict::hit : Verdict::miss;
  answers.answers[place] = is_open ? Verdict::undecided : plain;
  answers.reasons[place] = is_open ? UndecidedReason::numeric : UndecidedReason::none;
  answers.levels[place] = static_cast<std::uint8_t>(ray.level);
  answers.hit_counts[place] = is_told ? 1 : 0;
  answers.nodes[place] = ray.walk.nodes;
  answers.exact_tests[place] = ray.exact_tests;
  if (is_told) append_hit(snapshot, ray, answers);
}

}  // namespace

void walk_plain_rays(const Snapshot& snapshot, const Questions& asked, std::span<PlainRay*> rays,
                     std::span<Bvh::RayTask> tasks) {
  std::array<PlainWalker, kRaysAtOnce> walkers;
  for (std::size_t i = 0; i < rays.size(); ++i) walkers[i] = walker_of(*rays[i], snapshot, asked);
  walk_scenes_together(std::span<const PlainWalker>(walkers).first(rays.size()), snapshot.scenes, tasks);
}

bool start_plain_ray(const double* numbers, PlainRay& ray) { return start(numbers, ray); }

bool reaches_movers(const Snapshot& snapshot, const std::vector<std::uint8_t>& allowed, PlainRay& ray) {
  return reaches(snapshot, allowed, ray);
}

void write_plain_ray(const Snapshot& snapshot, const Questions& asked, const PlainRay& ray, std::size_t place,
                     Answers& answers) {
  write(snapshot, asked, ray, place, answers);
}

PlainOutcome answer_plain_ray(const Snapshot& snapshot, const Questions& asked, const double* numbers,
                              const std::vector<std::uint8_t>& allowed, PlainRay& ray, std::size_t place,
                              Answers& answers) {
  if (!start(numbers, ray)) return PlainOutcome::not_plain;
  walk(snapshot, asked, ray);
  if (reaches(snapshot, allowed, ray)) return PlainOutcome::reaches_movers;
  write(snapshot, asked, ray, place, answers);
  return PlainOutcome::answered;
}

}  // namespace collided::engine
