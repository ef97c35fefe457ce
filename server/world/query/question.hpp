#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/world/objects/scene_touch.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

/// One question at work: what it may see, and what it has met so far. The kinds of questions (ray_question,
/// overlap_question, near_question, sweep_question) fill `found`, ordered, and set the rest.
struct Question {
  const Snapshot& snapshot;
  const Questions& asked;
  const std::vector<std::uint8_t>& allowed;      // by slot
  const std::vector<std::uint8_t>& open_scenes;  // by scene: every part of it may answer
  std::vector<AnswerHit>& found;             // cleared by the kind
  WalkCost walk = {};
  Level level = Level::filter;
  std::uint32_t exact_tests = 0;
  bool undecided = false;
  bool truncated = false;
  bool timed_out = false;

  /// Half of the error asked for is spent on numbers that are not sharpened, half on nearer things that are not looked
  /// for: what lies nearer than the best found by less than this.
  double slack_m() const { return asked.error_m / 2; }
  bool allows(ObjectId id) const { return allowed[slot_of(id)] != 0; }
  bool allows_part(const StaticScene& scene, std::uint32_t part) const { return allows(scene.part_objects[part]); }
  const ObjectInfo& object(std::uint32_t slot) const { return *(*snapshot.objects)[slot]; }
  Placed placed(std::uint32_t slot) const {
    return {.info = &object(slot), .frame = &snapshot.frames[slot], .bounds = snapshot.bounds[slot]};
  }
  std::uint8_t flags_of(ObjectId id) const {
    return snapshot.stale[slot_of(id)] != 0 ? std::uint8_t{kStale} : std::uint8_t{0};
  }
  /// Order of what is equally near or deep: by name, then by triangle, so that it does not depend on what was loaded
  /// first.
  bool precedes(const AnswerHit& a, const AnswerHit& b) const {
    if (a.object == b.object) return a.triangle < b.triangle;
    return object(slot_of(a.object)).name < object(slot_of(b.object)).name;
  }
  /// Order of hits along a ray and of near objects.
  bool nearer_first(const AnswerHit& a, const AnswerHit& b) const {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : precedes(a, b);
  }
  void count(const ExactResult& verdict) {
    ++exact_tests;
    level = std::max(level, verdict.level);
    if (verdict.decision == Decision::undecided) undecided = true;
  }
};

/// Numbers as in Query.numbers; they have been checked.
void ask_ray(Question& question, const double* numbers);
/// Up to kRaysAtOnce rays, their walks through the static scenes in turn; each answer as from ask_ray.
inline constexpr std::size_t kRaysAtOnce = 64;
void ask_rays(std::span<std::optional<Question>> questions, std::span<const double* const> numbers);
void ask_sphere(Question& question, const double* numbers);
void ask_box(Question& question, const double* numbers);
void ask_near(Question& question, const double* numbers);
/// The first contact of asked.mover on its way: one hit, its distance the end of the time bracket, its exit the beginning.
void ask_sweep(Question& question, const double* numbers);

}  // namespace collided::engine
