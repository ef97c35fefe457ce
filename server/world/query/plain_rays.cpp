#include "server/world/query/plain_rays.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "server/geometry/tolerance.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/ray_answer.hpp"

namespace collided::engine {
namespace {

/// Of two triangles met, what the answer says of equal distances: by the names of their objects, then by their numbers.
bool precedes_in_answer(const Snapshot& snapshot, const StaticScene& a_scene, std::uint32_t a,
                        const StaticScene& b_scene, std::uint32_t b) {
  const ObjectId a_object = a_scene.part_objects[a_scene.part_of(a)];
  const ObjectId b_object = b_scene.part_objects[b_scene.part_of(b)];
  // Triangles of one part stand in the order of their numbers.
  if (a_object == b_object) return a < b;
  const ObjectTable& objects = snapshot.objects;
  return objects[slot_of(a_object)]->name < objects[slot_of(b_object)]->name;
}

/// Takes the candidates of one scene's walk.
struct PlainCandidate {
  // Without values of their own: a group's would be written twice.
  PlainRay* of;
  const StaticScene* scene;
  const Snapshot* snapshot;
  bool any;
  bool with_hits;

  double operator()(std::uint32_t triangle, const Triangle& corners, double) const {
    PlainRay& ray = *of;
    if (ray.met != kNoTriangle) return compare_with_best(triangle, corners);
    if (is_met(corners, ray.hit)) keep(triangle);
    return ray.limit;
  }
  /// The same where there is one already. Apart from it, since most rays have one candidate.
  [[gnu::noinline]] double compare_with_best(std::uint32_t triangle, const Triangle& corners) const {
    PlainRay& ray = *of;
    // A clipped split tells a triangle twice, and then it would tie with itself.
    if (ray.met == triangle && ray.scene == scene) return ray.limit;
    RayHit next;
    if (!is_met(corners, next) || !is_nearer(next, triangle, corners)) return ray.limit;
    ray.hit = next;
    keep(triangle);
    return ray.limit;
  }
  bool is_met(const Triangle& corners, RayHit& hit) const {
    PlainRay& ray = *of;
    const ExactResult verdict = cast_ray(ray.ray, corners, hit);
    ++ray.exact_tests;
    ray.level = std::max(ray.level, verdict.level);
    ray.is_undecided = ray.is_undecided || verdict.decision == Decision::undecided;
    return verdict.yes();
  }
  /// Takes the triangle of the ray's hit.
  void keep(std::uint32_t triangle) const {
    PlainRay& ray = *of;
    ray.met = triangle;
    ray.scene = scene;
    if (any) {
      ray.limit = -1;
      return;
    }
    const double direction_m = length_of_direction(&ray.ray.direction[0]);
    const double reach = (ray.hit.distance_m + ray.hit.distance_error_m) / direction_m * (1 + kFewSlack);
    if (reach < ray.limit) ray.limit = reach;
  }
  /// Intervals that do not overlap decide; else the two triangles are compared exactly.
  bool is_nearer(const RayHit& hit, std::uint32_t triangle, const Triangle& corners) const {
    const RayHit& best = of->hit;
    if (hit.distance_m + hit.distance_error_m < best.distance_m - best.distance_error_m) return true;
    if (best.distance_m + best.distance_error_m < hit.distance_m - hit.distance_error_m) return false;
    const int order = compare_hits(of->ray, corners, of->scene->mesh.triangle(of->met));
    return order != 0 ? order < 0 : precedes_in_answer(*snapshot, *scene, triangle, *of->scene, of->met);
  }
  /// Takes the triangle that a walk for any hit ended at, unless it was offered as a candidate already. It is surely met,
  /// so that only what a hit tells is left to be worked out.
  void meet(std::uint32_t triangle, const Triangle& corners) const {
    if (triangle == Bvh::kNoTriangle || of->limit < 0) return;
    if (with_hits) {
      (*this)(triangle, corners, of->limit);
      return;
    }
    of->met = triangle;
    of->scene = scene;
    of->limit = -1;
  }
};

/// Walks the rays through one scene together.
void walk_scene_of_plain(const Snapshot& snapshot, const StaticScene& scene, const Questions& asked,
                         std::span<PlainRay*> rays, std::span<Bvh::RayTask> tasks) {
  std::array<PlainCandidate, kPlainRaysAtOnce> candidates;
  const bool any = asked.mode == HitMode::any;
  std::size_t count = 0;
  for (PlainRay* ray : rays) {
    if (ray->limit < 0) continue;
    candidates[count] = {ray, &scene, &snapshot, any, asked.with_hits};
    Bvh::RayTask& task = tasks[count];
    task.ray = &ray->ray;
    task.limit = ray->limit;
    task.candidate = candidates[count];
    task.cost = &ray->walk;
    task.met = Bvh::kNoTriangle;
    ++count;
  }
  scene.tree.walk_rays(tasks.first(count), scene.mesh, any ? Bvh::RayGoal::any : Bvh::RayGoal::nearest);
  if (!any) return;
  for (std::size_t i = 0; i < count; ++i) candidates[i].meet(tasks[i].met, tasks[i].corners);
}

/// Converted where the answer keeps it, a hit is made there: a copy of one made elsewhere waits until its numbers have
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
  const auto flags = static_cast<std::uint8_t>(snapshot.stale[slot] != 0 ? kStale : 0);
  answers.hits.emplace_back(HitInPlace{ray.hit, object, ray.met - scene.parts[part].first_triangle, flags});
  const std::int64_t posed_ns = snapshot.posed_ns[slot];
  if (posed_ns == 0) return;
  answers.oldest_pose_ns = answers.oldest_pose_ns < 0 ? posed_ns : std::min(answers.oldest_pose_ns, posed_ns);
}

/// Walks one scene.
inline void walk_scene(const Snapshot& snapshot, const StaticScene& scene, const Questions& asked, PlainRay& ray) {
  const bool any = asked.mode == HitMode::any;
  const PlainCandidate candidate{&ray, &scene, &snapshot, any, asked.with_hits};
  if (!any) return scene.tree.walk_ray_nearest(ray.ray, ray.limit, scene.mesh, candidate, ray.walk);
  Triangle corners;
  candidate.meet(scene.tree.meet_ray(ray.ray, ray.limit, scene.mesh, candidate, ray.walk, corners), corners);
}

[[gnu::noinline]] void walk_many(const Snapshot& snapshot, const Questions& asked, PlainRay& ray) {
  snapshot.scenes.walk_ray(ray.ray, ray.limit, ray.walk, [&](std::size_t index) {
    walk_scene(snapshot, *snapshot.scenes[index], asked, ray);
    return ray.limit;
  });
}

inline void walk(const Snapshot& snapshot, const Questions& asked, PlainRay& ray) {
  if (snapshot.scenes.are_many()) return walk_many(snapshot, asked, ray);
  for (const auto& scene : snapshot.scenes) {
    walk_scene(snapshot, *scene, asked, ray);
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

inline bool start(const double* numbers, PlainRay& ray) {
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  const double length_m = numbers[6];
  ray.ray = ray_of(numbers);
  ray.limit = length_m == kNoEnd ? length_m : length_m / length_of_direction(numbers + 3) * (1 + kFewSlack);
  ray.walk = {};
  ray.exact_tests = 0;
  ray.level = Level::filter;
  ray.is_undecided = false;
  ray.met = kNoTriangle;
  // A length divided by a denormal direction may overflow.
  return length_m == kNoEnd || ray.limit <= std::numeric_limits<double>::max();
}

/// A miss needs every test to have said no; where any hit will do, one that is certain is enough.
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
  if (snapshot.scenes.are_many()) {
    for (PlainRay* ray : rays) walk(snapshot, asked, *ray);
    return;
  }
  for (const auto& scene : snapshot.scenes) walk_scene_of_plain(snapshot, *scene, asked, rays, tasks);
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
