#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "collided/codes.hpp"
#include "idl/glob.hpp"
#include "idl/question_rules.hpp"
#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/geometry/vector.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/query/answer_filters.hpp"
#include "server/world/query/plain_ray.hpp"

namespace collided::engine {

using wire_contract::glob_matches;

using codes::HitMode;
using codes::kHitByWinding;
using codes::kHitInside;
using codes::kHitStale;
using codes::QuestionKind;
using codes::UndecidedReason;
using codes::Verdict;

/// The kinds of numbers only; a sweep has a shape as well, a what-if names objects (world/groups).
inline constexpr QuestionKind kPlainQuestions[] = {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box,
                                                   QuestionKind::near};

// A question is a row of this many doubles, in the order of question_columns() in idl/columns.hpp.
using wire_contract::kBoxNumbers;
using wire_contract::kInsideNumbers;
using wire_contract::kNearNumbers;
using wire_contract::kPoseNumbers;
using wire_contract::kRayNumbers;
using wire_contract::kSphereNumbers;
using wire_contract::kSweepNumbers;
using wire_contract::numbers_of;

/// Questions of one kind, and the filter of what may answer them.
struct Questions {
  QuestionKind kind = QuestionKind::ray;
  HitMode mode = HitMode::closest;
  bool with_hits = true;  // false, in mode any: the verdict alone, no hits
  std::uint32_t mask = 0xffffffff;
  std::uint32_t max_hits = 1000;
  // Name patterns: only objects that match the first, and none that match the second; empty: no restriction.
  std::string_view only = {};
  std::string_view skip = {};
  std::int64_t deadline_ns = 0;  // steady clock; 0: none
  // Steady clock; 0: none. Soon after it the remaining questions get no answers, so that other requests have their
  // turn. The first question is always answered.
  std::int64_t pause_ns = 0;
  // Steady clock; 0: none. A question still open then gets no answer, nor do those after it. Ignored for rays walked
  // together: none of them takes long.
  std::int64_t give_up_ns = 0;
  const std::atomic<bool>* called_off = nullptr;  // when another thread sets it, the deadline counts as over
  // allowed error of distances and depths, metres; yes and no are exact regardless
  double error_m = 0;
  Level highest = Level::rational;    // highest level of arithmetic; what it cannot decide is undecided
  std::span<const double> numbers;    // rows in the order of question_columns() in idl/columns.hpp
  const ObjectInfo* mover = nullptr;  // for sweeps: the shape that moves, in its own frame
};

/// True if the numbers of one question satisfy the rules of idl/question_rules.hpp.
bool is_question(QuestionKind kind, const double* numbers);

/// One hit of an answer.
struct AnswerHit {
  ObjectId object = 0;
  std::uint32_t triangle = kNoTriangle;  // within the object (a part's triangles count from 0)
  std::uint8_t flags = 0;                // kHitInside and others
  // along the ray; depth for overlaps and inside; distance for near; 0 for sweeps, which have Answers::brackets
  double distance_m = 0;
  double error_m = 0;
  // For rays: where they leave the solid; if they begin in a closed mesh, where they first meet the surface.
  double exit_m = 0;
  Vec3 point = Vec3::Zero();
  /// For rays and near, metres: how far the point may be from the true one. A contact's point is one of many: infinite.
  double point_error_m = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::Zero();
  // For rays on a triangle: barycentric weights of the point.
  Vec3 weights = Vec3::Zero();

  /// True if exactly 0: no other hit can be nearer.
  bool is_at_start() const { return distance_m == 0 && error_m == 0; }
};

/// Where a question leaves the covered space, on the line from its beginning (a ray's origin, the centre of a ball or
/// box, the first pose of a sweep).
struct Leaving {
  Vec3 point = Vec3::Zero();
  double covered_m = 0;  // for rays: the length that is certainly covered, metres
};

/// The end of the covered space for one question of a batch.
struct NotCovered {
  std::uint32_t question = 0;
  Leaving leaving = {};
};

/// One answer per question up to the pause, and all hits in question order. Reused between calls so that answering does
/// not allocate.
struct Answers {
  std::vector<Verdict> answers;
  std::vector<UndecidedReason> reasons;
  std::vector<std::uint8_t> levels;
  std::vector<std::uint32_t> hit_counts;
  std::vector<std::uint32_t> nodes;
  std::vector<std::uint32_t> exact_tests;
  std::vector<AnswerHit> hits;
  // For sweeps, one per hit, fractions of the motion: no contact up to `low`, contact by `high`. Else empty.
  std::vector<TimeBracket> brackets = {};
  std::vector<NotCovered> not_covered = {};  // at most one per answer with that reason, in question order
  // Oldest Snapshot::posed_ns among the objects hit, reported or not; -1: only static ones.
  std::int64_t oldest_pose_ns = -1;

  /// Clears the hits, and makes room for one answer per question, which the caller writes.
  void reset(std::size_t count) {
    hits.clear();
    brackets.clear();
    not_covered.clear();
    oldest_pose_ns = -1;
    if (exact_tests.size() != count) cut(count);
  }
  /// Drops the answers from `count` on, none of which has been written.
  void cut(std::size_t count);
};

/// Memory that answering needs; one per thread.
struct QueryScratch {
  AnswerFilters filters;
  std::vector<AnswerHit> found;
  std::vector<std::vector<AnswerHit>> found_by_ray;  // for rays walked together
  std::vector<PlainRay> plain_rays;                  // all in progress at once
  std::vector<Bvh::RayTask> ray_tasks;               // tasks of plain_rays

  const AnswerFilter& filter() const { return filters.current(); }
};

/// Answers questions on one snapshot. Each question with malformed numbers (non-finite, zero direction, negative size)
/// gets `invalid`. The same question on the same snapshot has the same answer to the bit, whatever else is in the
/// batch.
/// threads  any; one scratch and one Answers per thread
void answer(const Snapshot& snapshot, const Questions& questions, Answers& answers, QueryScratch& scratch);

}  // namespace collided::engine
