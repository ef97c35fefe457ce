#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/world/groups/part_meshes.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

/// A ray that is to be explained, and what may answer it: as Questions has them.
struct RayExplanationAsk {
  std::array<double, kRayNumbers> numbers{};  // as question_columns() in idl/columns.hpp has them
  std::uint32_t mask = 0xffffffff;
  std::string only;
  std::string skip;
  std::size_t most_misses = 3;
  std::optional<ObjectId> why_not = {};  // told of in any case

  /// Refers to this.
  Questions questions() const;
};

/// An object that the ray meets.
struct RayMeeting {
  static constexpr std::uint32_t kNoPart = 0xffffffff;

  AnswerHit hit;
  std::uint32_t part = kNoPart;  // number of the primitive that decided, of an object with several
  Level level = Level::filter;   // the rung of the arithmetic that the yes needed
};

/// An object that the ray does not meet: |truth - distance_m| <= error_m.
struct RayMiss {
  ObjectId object = 0;
  Decision meets = Decision::no;  // undecided: it may meet it
  double distance_m = 0;          // the least of any two points of ray and object
  double error_m = 0;
  double along_m = 0;  // where on the ray that is, about
  Vec3 on_ray = Vec3::Zero();
  Vec3 on_object = Vec3::Zero();
  double point_error_m = 0;  // of both points
  std::uint32_t triangle = kNoTriangle;
  bool is_box_met = false;    // the ray met the object's box, so that its parts were candidates
  bool is_left_out = false;   // the filter leaves it out
  bool is_at_start = false;   // no point of the ray is nearer than its origin: the object lies beside or behind it
  bool is_at_length = false;  // the ray ends there, by its length
};

/// An object whose publisher is lost and that may be anywhere within a region by now.
struct StaleInTheWay {
  ObjectId object = 0;
  std::int64_t age_ns = 0;  // of its last pose, at the state's time
  double from_m = 0;        // where along the ray that region begins, at the earliest
};

/// Why a ray met what it met, and not another object.
struct RayExplanation {
  Verdict verdict = Verdict::miss;
  UndecidedReason reason = UndecidedReason::none;
  Level level = Level::filter;    // the highest that the whole answer needed
  std::uint32_t node_count = 0;   // boxes of the indexes that the search opened
  std::uint32_t exact_tests = 0;  // of parts
  std::uint32_t object_count = 0;
  std::uint32_t left_out_count = 0;       // by the filter
  std::uint32_t boxes_met = 0;            // of objects that may answer
  std::vector<RayMeeting> met;            // each object once, in order along the ray; the first is the answer
  std::vector<RayMeeting> left_out;       // that the filter leaves out and that would have come before the answer
  std::vector<RayMiss> misses;            // of objects that may answer, nearest first; then the one asked for
  std::vector<StaleInTheWay> stale;       // that may answer, and may be in the ray's way
  std::vector<ObjectId> unknown;          // unknown space whose box the ray met
  std::optional<Leaving> leaves_covered;  // where the answer is not covered
  bool is_cut = false;                    // there were more hits than are looked at: `met` lacks some
  bool is_late = false;                   // the deadline was over: misses may lack nearer ones
};

/// Why the filter leaves the object out, a sentence; empty where it does not.
std::string why_left_out(const ObjectInfo& info, const RayExplanationAsk& ask);

/// Explains a ray; its numbers keep the rules of rays (is_question()).
///
/// cost     three answers to the ray, a look at each object's box, and a distance for each of the nearest misses; parts
///          of scenes among these are indexed on the calling thread, once
/// threads  any
RayExplanation explain_ray(const Snapshot& snapshot, const RayExplanationAsk& ask, PartMeshes& part_meshes,
                           Deadline& deadline);

}  // namespace collided::engine
