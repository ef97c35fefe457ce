// The nearest objects to a point: walks scenes and moving objects near to far, and tests each part exactly.

#include <cmath>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/distance/nearest_filter.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/given/margin.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/part_index.hpp"
#include "server/world/objects/scene_levels.hpp"
#include "server/world/query/question.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/solid_hits.hpp"
#include "server/world/query/underflow.hpp"

namespace collided::engine {
namespace {

/// The nearest objects so far: at most max_hits of them, one entry per object, nearest first.
struct NearWalk {
  Question& question;
  Vec3 point;
  double within_m;
  double limit_m2;                  // squared search radius: square_up(wanted_m + off_by_m)
  std::vector<ObjectId>& doubtful;  // objects for which the simpler form leaves open whether they are within reach
  double wanted_m = within_m;       // parts farther than this cannot change the answer
  double off_by_m = 0;              // how far the walked surface may be from the one that it represents, metres

  bool is_signed() const { return question.asked.mode == HitMode::signed_near; }
  /// True if the deadline has ended the search: every walk stops at a negative limit.
  bool is_over() const { return limit_m2 < 0; }
  void set_limit() { limit_m2 = square_up(wanted_m + off_by_m); }
  /// Tests one part. placing.off_m() bounds how far the part may be from its exact pose, and placing.given() is the
  /// part as given.
  template <class Part, class Placing>
  void test(const Part& part, ObjectId object, std::uint32_t triangle, const Placing& placing);
  /// True if the part is within reach; decided exactly if the bound on its distance leaves it open.
  template <class Part, class Placing>
  bool is_within(const Closest& found, double placed_m, ObjectId object, const Part& part, const Placing& placing);
  /// Whether a solid primitive holds the point; decided for the primitive as given if placing it leaves that open.
  template <class Part, class Placing>
  bool holds_point(const Closest& found, double placed_m, const Part& part, const Placing& placing);
  /// Keeps a solid primitive that holds the point, by its depth.
  void keep_depth(const Contact& found, ObjectId object, double placed_m);
  /// Inserts the hit, replacing a farther one of its object or the farthest of all, and shrinks the search.
  void keep(const AnswerHit& hit);
  void walk_scene(const StaticScene& scene);
  void walk_level(const SceneLevel& level, const StaticScene& scene);
  void walk_object(std::uint32_t slot);
  /// A solid that holds the point is at distance 0, however far its surface is.
  void test_solid(const SolidMesh& solid, const Placed& object);
  /// An open mesh is a surface; inside by winding number the distance is negative.
  void test_winding(const WindingMesh& winding, const Placed& object);
  template <class Test>
  void walk_local(const Bvh& tree, double radius_m, const Frame& frame, Test&& test_one);
  template <class Test>
  void walk_parts(const IndexedParts& parts, const Frame& frame, Test&& test_one);
  void walk_movers(const Grid& grid);
};

/// How far apart the nearest points of two convex sets may be if the sets differ by at most off_m everywhere, as in
/// closest_in_general: every nearest point of the true set lies within this distance.
double within_of(double distance_m, double off_m) {
  return off_m > 0 ? (2 * std::sqrt((distance_m + off_m) * off_m) + off_m) * (1 + kBoundSlack) : 0;
}

/// A scene's triangles are stored in world coordinates.
struct NotPlaced {
  static constexpr bool kIsPlaced = false;
  static double most_off_m() { return 0; }
  static double off_m() { return 0; }
};

/// A part placed in double. most_off_m bounds off_m, for a first test.
template <class OffOf, class GivenOf>
struct PosedPart {
  static constexpr bool kIsPlaced = true;
  double most_m;
  OffOf off_of;
  GivenOf given_of;

  double most_off_m() const { return most_m; }
  double off_m() const { return off_of(); }
  GivenPart given() const { return given_of(); }
};

template <class Part, class Placing>
bool NearWalk::holds_point(const Closest& found, double placed_m, const Part& part, const Placing& placing) {
  const bool is_held = found.distance_m == 0 && found.distance_error_m == 0;
  if constexpr (Placing::kIsPlaced) {
    if (placed_m == 0 || kernel::precision.highest != Level::rational ||
        found.distance_m - found.distance_error_m > placed_m)
      return is_held;
    const ConvexPart own{Primitive(Sphere{.center = point, .radius_m = 0})};
    const ConvexPart other = as_part(part);
    if (is_held && surely_meet(own, other, placed_m)) return true;
    const Decision as_given = overlaps_as_given(own, other, {GivenPart{}, placing.given()});
    question.count({as_given, Level::rational});
    if (as_given != Decision::undecided) return as_given == Decision::yes;
  }
  return is_held;
}

template <class Part, class Placing>
void NearWalk::test(const Part& part, ObjectId object, std::uint32_t triangle, const Placing& placing) {
  if (question.deadline.is_over()) {
    limit_m2 = -1;
    return;
  }
  constexpr bool kIsSurface = std::is_same_v<Part, Triangle>;
  if constexpr (kIsSurface) {
    // Most triangles of a leaf are certainly beyond the limit, and proving that costs less than the distance itself.
    const double most_m2 = Placing::kIsPlaced ? square_up(wanted_m + off_by_m + placing.most_off_m()) : limit_m2;
    if (kernel::quick_square_distance(point, part).low2_m2 > most_m2) {
      ++question.exact_tests;
      return;
    }
  }
  const Closest found = closest(point, part);
  ++question.exact_tests;
  const double placed_m = placing.off_m();
  if (!is_within(found, placed_m, object, part, placing)) return;
  const bool is_held = !kIsSurface && holds_point(found, placed_m, part, placing);
  if constexpr (!kIsSurface) {
    if (is_held && is_signed()) {
      const Sphere here{.center = point, .radius_m = 0};
      const bool is_in_placed = found.distance_m == 0 && found.distance_error_m == 0;
      return keep_depth(is_in_placed ? contact(here, part)
                                     : Contact{.point = found.point,
                                               .normal = -found.normal,
                                               .depth_error_m = found.distance_m + found.distance_error_m},
                        object, placed_m);
    }
  }
  // A part that contains the point is at distance 0 wherever its exact border is.
  const double error_m = is_held ? 0 : found.distance_error_m + placed_m + off_by_m;
  keep({.object = object,
        .triangle = triangle,
        .flags = static_cast<std::uint8_t>(question.flags_of(object) | (is_held ? kHitInside : 0)),
        .distance_m = is_held ? 0 : found.distance_m,
        .error_m = with_underflow(found.distance_m, error_m),
        .point = is_held ? point : found.point,
        // The nearest point of the simpler form may be near another place of the true surface.
        .point_error_m = is_held        ? 0
                         : off_by_m > 0 ? std::numeric_limits<double>::infinity()
                                        : found.point_error_m + within_of(found.distance_m, placed_m),
        .normal = found.normal});
}

void NearWalk::keep_depth(const Contact& found, ObjectId object, double placed_m) {
  keep({.object = object,
        .flags = static_cast<std::uint8_t>(question.flags_of(object) | kHitInside),
        .distance_m = -found.depth_m,
        .error_m = with_underflow(found.depth_m, found.depth_error_m + placed_m),
        .point = found.point,
        .normal = found.normal});
}

template <class Part, class Placing>
bool NearWalk::is_within(const Closest& found, double placed_m, ObjectId object, const Part& part,
                         const Placing& placing) {
  const double error_m = found.distance_error_m + placed_m + off_by_m;
  if (!(found.distance_m - error_m <= within_m)) return false;
  if (found.distance_m + error_m <= within_m) return true;
  if (off_by_m > 0) {
    if (std::find(doubtful.begin(), doubtful.end(), object) == doubtful.end()) doubtful.push_back(object);
    return false;
  }
  // If the bound leaves open whether the part is within reach, an exact test with a ball of that radius decides.
  const Sphere ball{.center = point, .radius_m = within_m};
  if constexpr (Placing::kIsPlaced) {
    if (placed_m > 0 && kernel::precision.highest == Level::rational) {
      const Decision as_given = overlaps_as_given(Primitive(ball), as_part(part), {GivenPart{}, placing.given()});
      question.count({as_given, Level::rational});
      if (as_given != Decision::undecided) return as_given == Decision::yes;
    }
  }
  const ExactResult verdict = overlaps(ball, part);
  question.count(verdict);
  return verdict.yes();
}

void NearWalk::keep(const AnswerHit& hit) {
  std::vector<AnswerHit>& found = question.found;
  const auto same =
      std::find_if(found.begin(), found.end(), [&](const AnswerHit& h) { return h.object == hit.object; });
  if (same != found.end()) {
    if (!question.nearer_first(hit, *same)) return;
    found.erase(same);
  } else if (found.size() == question.asked.max_hits) {
    if (!question.nearer_first(hit, found.back())) return;
    found.pop_back();
  }
  const auto order = [this](const AnswerHit& a, const AnswerHit& b) { return question.nearer_first(a, b); };
  found.insert(std::upper_bound(found.begin(), found.end(), hit, order), hit);
  if (found.size() == question.asked.max_hits) {
    const double farthest_m = std::max(found.back().distance_m - question.slack_m(), 0.0);
    // For an object that holds the point only the depth may be unknown: nothing outside is nearer.
    const bool is_held = (found.back().flags & kHitInside) != 0;
    wanted_m = std::min(wanted_m, is_held ? 0 : farthest_m + found.back().error_m);
    set_limit();
  }
}

void NearWalk::walk_scene(const StaticScene& scene) {
  const auto candidate = [&](std::uint32_t triangle, double) {
    const std::uint32_t part = scene.part_of(triangle);
    const ObjectId object = scene.part_objects[part];
    if (question.allows(object))
      test(scene.mesh.triangle(triangle), object, triangle - scene.parts[part].first_triangle, NotPlaced());
    return limit_m2;
  };
  scene.tree.walk_near(point, limit_m2, 0, candidate, question.walk);
}

void NearWalk::walk_level(const SceneLevel& level, const StaticScene& scene) {
  const auto candidate = [&](std::uint32_t triangle, double) {
    const std::uint32_t part = level.part_of[triangle];
    const ObjectId object = scene.part_objects[part];
    if (question.allows(object)) {
      test(level.mesh.triangle(triangle), object, level.originals[triangle] - scene.parts[part].first_triangle,
           NotPlaced());
    }
    return limit_m2;
  };
  // The simpler form of a surface within reach may be slightly outside, so search farther.
  off_by_m = level.off_by_m;
  set_limit();
  level.tree.walk_near(point, limit_m2, 0, candidate, question.walk);
  off_by_m = 0;
  set_limit();
}

/// Calls test_one(number) for each candidate of an index in the object's frame.
template <class Test>
void NearWalk::walk_local(const Bvh& tree, double radius_m, const Frame& frame, Test&& test_one) {
  const auto candidate = [&](std::uint32_t number, double) {
    test_one(number);
    return limit_m2;
  };
  const Vec3 away = point - frame.position;
  const double slack_m = placement_slack(frame, away.lpNorm<1>() + point.lpNorm<1>(), radius_m);
  tree.walk_near(frame.rotation.transpose() * away, limit_m2, slack_m, candidate, question.walk);
}

/// The tree of primitives knows bounds only, which its box walk uses: searches growing cubes until the nearest hit lies
/// within one, or one contains everything.
template <class Test>
void NearWalk::walk_parts(const IndexedParts& parts, const Frame& frame, Test&& test_one) {
  const double all_m = (point - frame.position).lpNorm<1>() + 2 * parts.radius_m;
  const auto candidate = [&](std::uint32_t number) {
    test_one(number);
    return !is_over();
  };
  double reach_m = parts.radius_m / 64;
  for (bool is_last = false; !is_last && !is_over(); reach_m *= 4) {
    const double known_m = std::sqrt(limit_m2) * (1 + kSearchMargin);
    is_last = !(reach_m < known_m && reach_m < all_m);
    const double half_m = is_last ? std::min(known_m, all_m) : reach_m;
    Aabb cube;
    cube.extend(point);
    parts.tree.walk_box(seen_from(frame, grown(cube, half_m), parts.radius_m), candidate, question.walk);
    is_last = is_last || std::sqrt(limit_m2) < half_m;
  }
}

void NearWalk::test_solid(const SolidMesh& solid, const Placed& object) {
  Aabb here;
  here.extend(point);
  if (is_over() || !overlaps(object.bounds, here)) return;
  const std::optional<NearestSurface> nearest = surface_from_inside(solid, object, point, question);
  if (!nearest) return;
  keep({.object = object.info->id,
        .triangle = nearest->triangle,
        .flags = static_cast<std::uint8_t>(question.flags_of(object.info->id) | kHitInside),
        .distance_m = is_signed() ? -nearest->distance_m : 0,
        .error_m = is_signed() ? nearest->error_m : 0,
        .point = is_signed() ? nearest->point : point,
        .point_error_m = is_signed() ? std::numeric_limits<double>::infinity() : 0,
        .normal = nearest->normal});
}

void NearWalk::test_winding(const WindingMesh& winding, const Placed& object) {
  Aabb here;
  here.extend(point);
  if (!is_signed() || is_over() || !overlaps(object.bounds, here)) return;
  const std::optional<NearestSurface> nearest = surface_from_inside(winding, object, point, question);
  if (!nearest) return;
  keep({.object = object.info->id,
        .triangle = nearest->triangle,
        .flags = static_cast<std::uint8_t>(question.flags_of(object.info->id) | kHitInside | kHitByWinding),
        .distance_m = -nearest->distance_m,
        .error_m = with_underflow(nearest->distance_m, nearest->error_m),
        .point = nearest->point,
        .normal = nearest->normal});
}

void NearWalk::walk_object(std::uint32_t slot) {
  const ObjectInfo& info = question.object(slot);
  if (!question.allows(info.id)) return;
  const Placed placed = question.placed_without_bounds(slot);
  const Frame& frame = placed.frame;
  const auto test_primitive = [&](std::size_t number) {
    const Primitive& any = info.primitives[number];
    const auto off_of = [&] { return placing_error_m(frame, any, (point - frame.position).lpNorm<1>()); };
    const PosedPart placing{0, off_of, [&] { return placed.given(any); }};
    std::visit([&](const auto& own) { test(place(frame, own), info.id, kNoTriangle, placing); }, any);
  };
  if (info.rare->parts) {
    walk_parts(*info.rare->parts, frame, test_primitive);
  } else {
    for (std::size_t i = 0; i < info.primitives.size() && !is_over(); ++i) test_primitive(i);
  }
  if (info.rare->solid) test_solid(*info.rare->solid, question.placed(slot));
  if (info.rare->winding) test_winding(*info.rare->winding, question.placed(slot));
  if (!info.mesh) return;
  const double most_off_m = placing_error_m(frame, info.mesh->radius_m);
  walk_local(info.mesh->tree, info.mesh->radius_m, frame, [&](std::uint32_t triangle) {
    const Triangle own = info.mesh->mesh->triangle(triangle);
    const auto off_of = [&] { return placing_error_m(frame, own); };
    test(place(frame, own), info.id, triangle, PosedPart{most_off_m, off_of, [&] { return placed.given(triangle); }});
  });
}

void NearWalk::walk_movers(const Grid& grid) {
  const auto candidate = [&](std::uint32_t slot, double) {
    walk_object(slot);
    return limit_m2;
  };
  grid.walk_near(point, limit_m2, candidate, question.walk);
}

/// Candidates that are nearer by less than the allowed slack were skipped, so the bounds must include them.
void widen_bounds(Question& question) {
  if (question.found.size() < question.asked.max_hits) return;
  for (AnswerHit& hit : question.found) {
    if (hit.is_at_start() || question.slack_m() == 0) continue;
    hit.error_m += question.slack_m();
    hit.point_error_m = std::numeric_limits<double>::infinity();  // a nearer point may be on another side
  }
}

/// How far a scene's simpler form may be off, and the error then allowed to the distances: a quarter of the requested
/// error goes to the simpler form and a quarter to the numbers, because half is for nearer candidates that the search
/// skips.
double share_of_levels(const Question& question) { return question.asked.error_m / 4; }

/// False if simpler forms leave open which objects are within reach, so the answer needs the full ones.
bool find_nearest(Question& question, const double* n, bool use_levels) {
  // Reused from question to question, so that no answer allocates once it has grown.
  thread_local std::vector<ObjectId> doubtful;
  doubtful.clear();
  question.found.clear();
  NearWalk walk{
      .question = question, .point = point_of(n), .within_m = n[3], .limit_m2 = square_up(n[3]), .doubtful = doubtful};
  Aabb here;
  here.extend(walk.point);
  const SceneList& scenes = question.snapshot.scenes;
  scenes.walk_near(walk.point, walk.limit_m2, question.walk, [&](std::size_t index) {
    const auto& scene = scenes[index];
    visit_solid_parts(*scene, here, question,
                      [&](const SolidPart& part, const Placed& object) { walk.test_solid(*part.solid, object); });
    visit_winding_parts(*scene, here, question, [&](const WindingPart& part, const Placed& object) {
      walk.test_winding(*part.winding, object);
    });
    const SceneLevel* level = use_levels ? coarsest_within(scene->levels, share_of_levels(question)) : nullptr;
    if (level == nullptr) {
      walk.walk_scene(*scene);
      return walk.limit_m2;
    }
    const PrecisionScope blunter({.highest = question.asked.highest, .error_asked_m = question.asked.error_m / 4});
    walk.walk_level(*level, *scene);
    return walk.limit_m2;
  });
  if (question.snapshot.grid) walk.walk_movers(*question.snapshot.grid);
  if (question.found.size() == question.asked.max_hits) return true;
  return std::all_of(doubtful.begin(), doubtful.end(), [&](ObjectId object) {
    return std::any_of(question.found.begin(), question.found.end(),
                       [&](const AnswerHit& hit) { return hit.object == object; });
  });
}

}  // namespace

void ask_near(Question& question, const double* n) {
  question.found.clear();
  if (question.asked.max_hits == 0) return;
  if (!find_nearest(question, n, true)) find_nearest(question, n, false);
  widen_bounds(question);
}

}  // namespace collided::engine
