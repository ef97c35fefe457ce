#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/objects/scene_touch.hpp"
#include "server/world/query/plain_ray.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

/// One question being answered: its limits, and its findings so far. The kinds of questions (ray_question,
/// overlap_question, near_question, inside_question, sweep_question) fill `found`, in order, and set the rest.
struct Question {
  const Snapshot& snapshot;
  const Questions& asked;
  const std::vector<std::uint8_t>& allowed;      // by slot
  const std::vector<std::uint8_t>& open_scenes;  // by scene: every part of it may answer
  std::vector<AnswerHit>& found;                 // each kind clears it first
  Deadline deadline = {};                        // each kind checks it at every test
  std::optional<TimeBracket> bracket = {};       // for the hit of a sweep
  WalkCost walk = {};
  Level level = Level::filter;
  std::uint32_t exact_tests = 0;
  bool undecided = false;
  // There were more hits than max_hits.
  bool truncated = false;

  /// Half of the requested error goes to distances that are not refined, half to candidates that are not tested: those
  /// nearer than the best hit by less than this, metres.
  double slack_m() const { return asked.error_m / 2; }
  bool allows(ObjectId id) const { return allowed[slot_of(id)] != 0; }
  bool allows_part(const StaticScene& scene, std::uint32_t part) const { return allows(scene.part_objects[part]); }
  const ObjectInfo& object(std::uint32_t slot) const { return *snapshot.objects[slot]; }
  Placed placed(std::uint32_t slot) const {
    Placed object = placed_without_bounds(slot);
    object.bounds = snapshot.bounds(slot);
    return object;
  }
  /// For tests of a bounded shape that do not need its bounds, which take as long to compute as the test.
  Placed placed_without_bounds(std::uint32_t slot) const {
    return {.info = &object(slot),
            .frame = snapshot.frame(slot),
            .bounds = {},
            .pose = snapshot.has_given_poses ? &snapshot.poses[slot] : nullptr};
  }
  std::uint8_t flags_of(ObjectId id) const {
    return snapshot.stale[slot_of(id)] != 0 ? std::uint8_t{kHitStale} : std::uint8_t{0};
  }
  /// Orders equally near or deep hits by name, then by triangle, so that the order does not depend on what was loaded
  /// first.
  bool precedes(const AnswerHit& a, const AnswerHit& b) const {
    if (a.object == b.object) return a.triangle < b.triangle;
    return object(slot_of(a.object)).name < object(slot_of(b.object)).name;
  }
  /// Orders hits along a ray and near objects.
  bool nearer_first(const AnswerHit& a, const AnswerHit& b) const {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : precedes(a, b);
  }
  void count(const ExactResult& verdict) {
    ++exact_tests;
    level = std::max(level, verdict.level);
    if (verdict.decision == Decision::undecided) undecided = true;
  }
};

/// Each function answers one question; numbers as Questions::numbers, already validated.
void ask_ray(Question& question, const double* numbers);
/// Tests the ray against moving objects, after the scenes were walked.
void ask_ray_of_movers(Question& question, const double* numbers, const PlainRay& after_scenes);
/// Answers up to kRaysAtOnce rays (scene_walk.hpp), walking them through each static scene together; each answer equals
/// that of ask_ray().
void ask_rays(std::span<std::optional<Question>> questions, std::span<const double* const> numbers);
void ask_sphere(Question& question, const double* numbers);
void ask_box(Question& question, const double* numbers);
void ask_near(Question& question, const double* numbers);
void ask_inside(Question& question, const double* numbers);
/// The first contact of asked.mover during its motion: one hit, and its bracket.
void ask_sweep(Question& question, const double* numbers);

}  // namespace collided::engine
