// Rays: walks the scenes and the grid for candidates, near to far, and decides each exactly.

#include <array>
#include <cmath>
#include <type_traits>

#include "server/exact_phase/given/given_ray.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/stable_length.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/part_index.hpp"
#include "server/world/query/question.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/ray_answer.hpp"
#include "server/world/query/ray_from_inside.hpp"
#include "server/world/query/ray_in_frame.hpp"
#include "server/world/query/scene_walk.hpp"
#include "server/world/query/solid_hits.hpp"

namespace collided::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A ray's walk through the world. Scenes and movers share the limit, so that a near hit in one saves work in the
/// others. Distances along the ray are s * |direction|; the walks use s.
struct RayWalk {
  Question& question;
  Ray ray;
  double limit;             // in s; never below the best hit less half the allowed error; negative: the search is over
  double best_error_m = 0;  // error of the best hit before placing: placed parts are compared with each other
  bool best_is_triangle = false;
  bool is_length_known = true;  // false: the limit does not bound the ray's length
  Triangle best_triangle;       // set if best_is_triangle

  RayWalk(Question& of, const double* numbers);

  bool closest() const { return question.asked.mode == HitMode::closest; }
  bool over() const { return limit < 0; }

  /// Tests one part of a scene, in world coordinates.
  void test(const Triangle& part, ObjectId object, std::uint32_t triangle);
  /// Tests one part of a posed object: off_m bounds how far it is from its exact pose, given() is the part as given,
  /// and placing_m() is the bound at the point of the hit.
  template <class Part, class GivenOf, class PlacingError>
  void test_placed(const Part& part, ObjectId object, std::uint32_t triangle, double off_m, const GivenOf& given,
                   const PlacingError& placing_m);
  template <class Part>
  bool is_skipped(const Part& part, ObjectId object, std::uint32_t triangle);
  /// Takes a hit. False: a nearer one is known.
  bool keep(const RayHit& hit, ObjectId object, std::uint32_t triangle, const Triangle* corners);
  AnswerHit answer_of(const RayHit& hit, ObjectId object, std::uint32_t triangle) const;
  // A clipped split produces a triangle twice, which would tie with itself.
  bool is_best(ObjectId object, std::uint32_t triangle) const {
    const std::vector<AnswerHit>& found = question.found;
    return best_is_triangle && found.front().triangle == triangle && found.front().object == object;
  }
  // Adds the error of placing to the hit just kept.
  void widen(const RayHit& hit, double placing_m, const Triangle* corners);
  bool is_nearer(const RayHit& hit, ObjectId object, std::uint32_t triangle, const Triangle* corners) const;
  // Constraints on the walk of a scene's tree; see Bvh::RayGoal.
  Bvh::RayGoal goal(std::size_t scene) const;
  /// A ray that begins in a solid has met it.
  void begin_in(const SolidMesh& solid, const Placed& object);
  void begin_in_scenes();
  void walk_object(std::uint32_t slot);
  void finish();
  void walk_movers();
  void resume(const PlainRay& after_scenes);
  template <class Test>
  void walk_parts(const IndexedParts& parts, std::size_t count, const Frame& frame, Test&& test_one);
};

inline AnswerHit RayWalk::answer_of(const RayHit& hit, ObjectId object, std::uint32_t triangle) const {
  return answer_hit(hit, object, triangle, question.flags_of(object));
}

/// Decided by intervals that do not overlap; else two triangles are compared exactly; ties go to the lower object, then
/// triangle.
bool RayWalk::is_nearer(const RayHit& hit, ObjectId object, std::uint32_t triangle, const Triangle* corners) const {
  const AnswerHit& best = question.found.front();
  // A ray that begins inside a solid, not on its surface, meets the surface later, though maybe by less than a
  // rounding.
  if ((best.flags & kHitInside) != 0 && best.object == object && question.object(slot_of(object)).rare->solid)
    return false;
  const int order = order_of(hit, best.distance_m, best_error_m);
  if (order != 0) return order < 0;
  if (corners != nullptr && best_is_triangle) {
    const int exact_order = compare_hits(ray, *corners, best_triangle);
    if (exact_order != 0) return exact_order < 0;
  } else if (hit.distance_m != best.distance_m) {
    return hit.distance_m < best.distance_m;
  }
  return question.precedes(answer_of(hit, object, triangle), best);
}

inline bool RayWalk::keep(const RayHit& hit, ObjectId object, std::uint32_t triangle, const Triangle* corners) {
  std::vector<AnswerHit>& found = question.found;
  if (!closest()) {
    found.push_back(answer_of(hit, object, triangle));
    if (question.asked.mode == HitMode::any) limit = -1;
    return true;
  }
  if (found.empty()) {
    found.push_back(answer_of(hit, object, triangle));
  } else {
    if (!is_nearer(hit, object, triangle, corners)) return false;
    found.front() = answer_of(hit, object, triangle);
  }
  best_error_m = hit.distance_error_m;
  best_is_triangle = corners != nullptr;
  if (best_is_triangle) best_triangle = *corners;
  limit = std::min(limit, reach_of(ray, hit, question.slack_m()));
  return true;
}

/// True if it was tested already, or there is no time left.
template <class Part>
bool RayWalk::is_skipped(const Part&, ObjectId object, std::uint32_t triangle) {
  if constexpr (std::is_same_v<Part, Triangle>) {
    if (is_best(object, triangle)) return true;
  }
  if (question.deadline.is_over()) {
    limit = -1;
    return true;
  }
  return false;
}

inline void RayWalk::test(const Triangle& part, ObjectId object, std::uint32_t triangle) {
  if (is_skipped(part, object, triangle)) return;
  RayHit hit;
  const ExactResult verdict = cast_ray(ray, part, hit);
  question.count(verdict);
  if (verdict.yes()) keep(hit, object, triangle, &part);
}

template <class Part, class GivenOf, class PlacingError>
void RayWalk::test_placed(const Part& part, ObjectId object, std::uint32_t triangle, double off_m, const GivenOf& given,
                          const PlacingError& placing_m) {
  if (is_skipped(part, object, triangle)) return;
  const Triangle* corners = nullptr;
  if constexpr (std::is_same_v<Part, Triangle>) corners = &part;
  RayHit hit;
  const ExactResult verdict = cast_ray_as_given(ray, part, off_m, given, hit);
  question.count(verdict);
  if (verdict.yes() && keep(hit, object, triangle, corners) && hit.distance_m > 0) widen(hit, placing_m(), corners);
}

void RayWalk::widen(const RayHit& hit, double placing_m, const Triangle* corners) {
  AnswerHit& kept = question.found.back();
  const double along_m = placing_error_along(ray, hit, placing_m, corners);
  kept.error_m += along_m;
  kept.point_error_m += along_m;
}

/// The ray's state in the walk through the scenes.
struct QuestionWalker {
  RayWalk* of;

  const Ray& ray() const { return of->ray; }
  double limit() const { return of->limit; }
  WalkCost& cost() const { return of->question.walk; }
  Bvh::RayGoal goal(std::size_t scene) const { return of->goal(scene); }
  bool wants_hits() const { return of->question.asked.with_hits; }
  double offer(const StaticScene& scene, std::uint32_t triangle, const Triangle& corners) const {
    const std::uint32_t part = scene.part_of(triangle);
    const ObjectId object = scene.part_objects[part];
    if (of->question.allows(object)) of->test(corners, object, triangle - scene.parts[part].first_triangle);
    return of->limit;
  }
  void take(const StaticScene& scene, std::uint32_t triangle) const {
    of->keep({}, scene.part_objects[scene.part_of(triangle)], kNoTriangle, nullptr);
  }
};

/// Walks that skip triangles on their own require that every triangle may answer, that the nearest hit is wanted to the
/// last bit, and that certainty in floats implies certainty in doubles.
Bvh::RayGoal RayWalk::goal(std::size_t scene) const {
  const Questions& asked = question.asked;
  const bool is_plain = question.open_scenes[scene] != 0 && asked.highest == Level::rational && is_length_known;
  if (is_plain && asked.mode == HitMode::any) return Bvh::RayGoal::any;
  return is_plain && closest() && question.slack_m() == 0 ? Bvh::RayGoal::nearest : Bvh::RayGoal::every;
}

void RayWalk::begin_in(const SolidMesh& solid, const Placed& object) {
  if (const std::optional<RayHit> hit = hit_from_inside(ray, solid, object, question))
    keep(*hit, object.info->id, kNoTriangle, nullptr);
  if (question.deadline.was_over()) limit = -1;
}

void RayWalk::begin_in_scenes() {
  const Aabb start{.low = ray.origin, .high = ray.origin};
  const SceneList& scenes = question.snapshot.scenes;
  scenes.walk_box(start, question.walk, [&](std::size_t index) {
    visit_solid_parts(*scenes[index], start, question, [&](const SolidPart& part, const Placed& placed) {
      if (!over()) begin_in(*part.solid, placed);
    });
    return !over();
  });
}

/// The tree of primitives knows bounds only, which its box walk uses: the ray is walked in pieces, near to far, and
/// candidates shared with the previous piece are skipped.
template <class Test>
void RayWalk::walk_parts(const IndexedParts& parts, std::size_t count, const Frame& frame, Test&& test_one) {
  constexpr int kPieces = 64;
  const Vec3 away = ray.origin - frame.position;
  const Vec3 origin = frame.rotation.transpose() * away;
  const Vec3 direction = frame.rotation.transpose() * ray.direction;
  const double reach_m = away.lpNorm<1>() + 2 * parts.radius_m;
  const double slack_m = 4 * placement_slack(frame, reach_m + ray.origin.lpNorm<1>(), parts.radius_m);
  // The section on which the ray is within radius_m of the frame's origin, around its nearest point.
  const double middle = -origin.dot(direction) / direction.squaredNorm();
  const double half = (parts.radius_m + slack_m) / direction.stableNorm() * (1 + kSearchMargin);
  const double first = std::max(0.0, middle - half - kSearchMargin * std::abs(middle));
  const double last = std::min(limit * (1 + kSearchMargin), middle + half + kSearchMargin * std::abs(middle));
  const bool is_plain = std::isfinite(first) && std::isfinite(last) && std::isfinite(slack_m) && origin.allFinite();
  if (!is_plain) {
    for (std::size_t i = 0; i < count && !over(); ++i) test_one(i);
    return;
  }
  std::vector<std::uint32_t> before;
  std::vector<std::uint32_t> here;
  const auto collect = [&](std::uint32_t number) {
    here.push_back(number);
    return true;
  };
  for (int piece = 0; piece < kPieces && !over(); ++piece) {
    const double from = first + (last - first) * piece / kPieces;
    const double to = first + (last - first) * (piece + 1) / kPieces;
    if (!(first <= last) || from > limit * (1 + kSearchMargin)) return;
    Aabb box;
    box.extend(origin + from * direction);
    box.extend(origin + to * direction);
    here.clear();
    parts.tree.walk_box(grown(box, slack_m), collect, question.walk);
    std::sort(here.begin(), here.end());
    for (const std::uint32_t number : here) {
      if (over()) return;
      if (!std::binary_search(before.begin(), before.end(), number)) test_one(number);
    }
    std::swap(before, here);
  }
}

void RayWalk::walk_object(std::uint32_t slot) {
  const ObjectInfo& info = question.object(slot);
  if (!question.allows(info.id)) return;
  const Placed object = question.placed_without_bounds(slot);
  const Frame& frame = object.frame;
  const auto test_primitive = [&](std::size_t number) {
    const Primitive& any = info.primitives[number];
    const double away_m = (ray.origin - frame.position).lpNorm<1>();
    const auto placing_m = [&] { return placing_error_m(frame, any, away_m + question.found.back().distance_m); };
    // A shape given without a pose is exact as placed.
    const double off_m = object.pose != nullptr ? placing_error_m(frame, any, away_m) : 0;
    const auto given = [&] { return object.given(any); };
    std::visit([&](const auto& own) { test_placed(place(frame, own), info.id, kNoTriangle, off_m, given, placing_m); },
               any);
  };
  if (info.rare->parts) {
    walk_parts(*info.rare->parts, info.primitives.size(), frame, test_primitive);
  } else {
    for (std::size_t i = 0; i < info.primitives.size() && !over(); ++i) test_primitive(i);
  }
  if (info.rare->solid && !over()) begin_in(*info.rare->solid, question.placed(slot));
  if (!info.mesh || over()) return;
  const TriangleMesh& mesh = *info.mesh->mesh;
  const LocalIndex index{info.mesh->tree, info.mesh->radius_m, mesh.triangles.size()};
  const double off_m = object.pose != nullptr ? placing_error_m(frame, info.mesh->radius_m) : 0;
  walk_ray_in_frame(ray, limit, index, frame, question.walk, [&](std::uint32_t triangle) {
    const Triangle own = mesh.triangle(triangle);
    const auto given = [&] { return object.given(triangle); };
    test_placed(place(frame, own), info.id, triangle, off_m, given, [&] { return placing_error_m(frame, own); });
    return limit;
  });
}

/// Orders several hits, drops duplicates (a split that clips triangles may produce one twice), and cuts at max_hits.
void finish_all(Question& question) {
  std::vector<AnswerHit>& found = question.found;
  std::sort(found.begin(), found.end(),
            [&](const AnswerHit& a, const AnswerHit& b) { return question.nearer_first(a, b); });
  const auto same = [](const AnswerHit& a, const AnswerHit& b) {
    return a.object == b.object && a.triangle == b.triangle && a.distance_m == b.distance_m &&
           a.triangle != kNoTriangle;
  };
  found.erase(std::unique(found.begin(), found.end(), same), found.end());
  if (found.size() > question.asked.max_hits) {
    found.resize(question.asked.max_hits);
    question.truncated = true;
  }
}

inline RayWalk::RayWalk(Question& of, const double* numbers)
    : question(of), ray(ray_of(numbers)), limit(limit_of(ray)) {
  question.found.clear();
  is_length_known = is_limit_known(ray, limit);
  if (!is_length_known) limit = kInfinity;
}

void RayWalk::walk_movers() {
  const auto candidate = [&](std::uint32_t slot, double) {
    walk_object(slot);
    return limit;
  };
  question.snapshot.grid->walk_ray(ray, limit, candidate, question.walk);
}

/// Takes over a plain ray's findings in the scenes.
void RayWalk::resume(const PlainRay& after_scenes) {
  question.walk = after_scenes.walk;
  question.level = after_scenes.level;
  question.exact_tests = after_scenes.exact_tests;
  question.undecided = after_scenes.is_undecided;
  limit = after_scenes.limit;
  if (after_scenes.met == kNoTriangle) return;
  const StaticScene& scene = *after_scenes.scene;
  const std::uint32_t part = scene.part_of(after_scenes.met);
  const std::uint32_t triangle = after_scenes.met - scene.parts[part].first_triangle;
  question.found.push_back(answer_of(after_scenes.hit, scene.part_objects[part], triangle));
  best_error_m = after_scenes.hit.distance_error_m;
  best_is_triangle = true;
  best_triangle = scene.mesh.triangle(after_scenes.met);
}

inline void RayWalk::finish() {
  if (!over() && question.snapshot.grid && question.snapshot.grid->size() > 0) walk_movers();
  if (question.asked.mode == HitMode::all) finish_all(question);
  if (closest() && !question.found.empty() && !question.found.front().is_at_start()) {
    question.found.front().error_m += question.slack_m();
    question.found.front().point_error_m += question.slack_m();
  }
}

}  // namespace

void ask_ray(Question& question, const double* n) {
  RayWalk walk(question, n);
  walk.begin_in_scenes();
  walk_scenes(QuestionWalker{&walk}, question.snapshot.scenes);
  walk.finish();
}

void ask_ray_of_movers(Question& question, const double* n, const PlainRay& after_scenes) {
  RayWalk walk(question, n);
  walk.resume(after_scenes);
  walk.finish();
}

void ask_rays(std::span<std::optional<Question>> questions, std::span<const double* const> numbers) {
  std::array<std::optional<RayWalk>, kRaysAtOnce> walks;
  std::array<QuestionWalker, kRaysAtOnce> walkers;
  std::array<Bvh::RayTask, kRaysAtOnce> tasks;
  const std::size_t count = questions.size();
  for (std::size_t i = 0; i < count; ++i) {
    walks[i].emplace(*questions[i], numbers[i]).begin_in_scenes();
    walkers[i].of = &*walks[i];
  }
  walk_scenes_together(std::span<const QuestionWalker>(walkers).first(count), questions.front()->snapshot.scenes,
                       tasks);
  for (std::size_t i = 0; i < count; ++i) walks[i]->finish();
}

}  // namespace collided::engine
