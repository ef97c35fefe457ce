#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "idl/glob.hpp"
#include "idl/topics.hpp"
#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/vector.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

using wire_contract::glob_matches;

/// Questions of one kind with what may answer them.
struct Questions {
  wire_contract::QueryKind kind = wire_contract::QueryKind::ray;
  wire_contract::RayMode mode = wire_contract::RayMode::closest;
  std::uint32_t mask = 0xffffffff;
  std::uint32_t max_hits = 1000;
  std::string_view only = {};
  std::string_view skip = {};
  std::int64_t deadline_ns = 0;       // steady clock; 0: none
  double error_m = 0;                 // distances and depths may be off by this much; yes and no are exact anyway
  Level highest = Level::rational;    // of the ladder; below that, what is not decided is undecided
  std::span<const double> numbers;    // as Query.numbers in collided.idl
  const ObjectInfo* mover = nullptr;  // of sweeps: what goes from pose to pose, in its own frame
};

/// Whether the numbers make a question: finite (a length and a reach may be infinite), a direction, sizes not negative, a
/// unit quaternion. Written so that NaN fails.
bool is_question(wire_contract::QueryKind kind, const double* numbers);

/// Layers and name patterns let the object answer.
bool may_answer(const ObjectInfo& info, const Questions& asked);

struct AnswerHit {
  ObjectId object = 0;
  std::uint32_t triangle = wire_contract::kNoTriangle;  // within the object (a part's triangles count from 0)
  std::uint8_t flags = 0;                               // wire_contract::HitFlags
  double distance_m = 0;  // along the ray; depth for overlaps; distance for near
  double error_m = 0;
  double exit_m = 0;
  Vec3 point = Vec3::Zero();
  /// Of rays and near: how far the point may be from the true one. A contact's point is one of many: infinite.
  double point_error_m = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::Zero();
  Vec3 weights = Vec3::Zero();

  /// Exactly 0: nothing can be nearer.
  bool is_at_start() const { return distance_m == 0 && error_m == 0; }
};

/// One answer a question and its hits in question order. Reused between calls so that answering does not allocate.
struct Answers {
  std::vector<wire_contract::Verdict> answers;
  std::vector<wire_contract::UndecidedReason> reasons;
  std::vector<std::uint8_t> levels;
  std::vector<std::uint32_t> hit_counts;
  std::vector<std::uint32_t> nodes;
  std::vector<std::uint32_t> exact_tests;
  std::vector<AnswerHit> hits;
  std::int64_t oldest_pose_ns = -1;  // smallest Snapshot::posed_ns among objects that decided; -1: static only

  void clear();
};

/// Memory that answering needs, one a thread.
struct QueryScratch {
  std::vector<std::uint8_t> allowed;          // by slot, for the filter below
  std::vector<std::uint8_t> open_scenes;      // by scene: every part of it may answer
  std::vector<AnswerHit> found;
  std::vector<std::vector<AnswerHit>> found_by_ray;  // of rays that are answered together
  const ObjectTable* allowed_table = nullptr; // what `allowed` was computed for
  std::uint64_t allowed_version = 0;
  std::string allowed_only, allowed_skip;
  std::uint32_t allowed_mask = 0;
};

/// A question becomes an answer, on one snapshot. Malformed numbers (non-finite, zero direction, negative size) are
/// answered `invalid`, each for itself. Same snapshot + same question = same bits, whatever else is asked.
/// threads  any; one scratch and one Answers a thread
void answer(const Snapshot& snapshot, const Questions& questions, Answers& answers, QueryScratch& scratch);

}  // namespace collided::engine
