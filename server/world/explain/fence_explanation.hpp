#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/world/fences/fences.hpp"
#include "server/world/groups/part_meshes.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// A fence, or a question for the nearest, as the step that is over left it, for use on another thread.
struct FenceLook {
  ObjectId id = 0;
  std::string name;
  FenceRule rule;
  ObjectInfo body;                  // in the world's frame, or its carrier's
  std::vector<OpenContact> inside;  // a: the object; of a question the one that is nearest
  std::uint64_t cut_short = 0;      // of a question: searches that ended at their limit of looks
};

/// Nothing: there is no such fence, or it is a band of a margin.
/// threads  the writer's only
std::optional<FenceLook> look_at_fence(const Fences& fences, std::string_view name);
/// The same for a question for the nearest.
std::optional<FenceLook> look_at_nearest(const Fences& fences, std::string_view name);

/// How an object stands to a fence.
struct FenceStanding {
  ObjectId object = 0;
  Decision is_in = Decision::no;  // where the snapshot has both
  double distance_m = 0;          // apart: of the two; in: less the depth, the shortest way out. inf: not looked at
  double error_m = 0;             // |truth - distance_m| <= error_m
  Vec3 on_fence = Vec3::Zero();   // nearest points of two that are apart
  Vec3 on_object = Vec3::Zero();
  bool is_stale = false;                 // its publisher is lost, and it may have moved on
  std::string why_not_looked_at = {};    // empty: the fence looks at it
  std::optional<OpenContact> told = {};  // that it is in
};

/// Who is in a fence and who is not, and why. Of a question for the nearest: who is nearest, who is not, and who would be
/// but is not looked at.
struct FenceExplanation {
  bool is_carrier_there = true;         // false: it has no place now
  std::size_t looked_at = 0;            // objects
  std::vector<FenceStanding> inside;    // of which it was told that they are in, the deepest first
  std::vector<FenceStanding> outside;   // the nearest of the others that it looks at, nearest first
  std::vector<FenceStanding> left_out;  // moving objects in it, or nearer than the nearest, that it does not look at
  std::optional<FenceStanding> asked_for;
  bool is_late = false;  // the deadline was over: some were not looked at
};

struct FenceExplanationAsk {
  std::size_t most_outside = 3;
  std::size_t most_left_out = 10;
  std::optional<ObjectId> why_not = {};  // told of in any case
};

/// Why the fence, or the question, does not look at the object, a sentence; empty where it does.
std::string why_not_looked_at(const FenceRule& rule, const ObjectInfo& object);

/// cost     a look at each object's box, and a clearance for each that is in or among the nearest
/// threads  any
FenceExplanation explain_fence(const Snapshot& snapshot, const FenceLook& fence, const FenceExplanationAsk& ask,
                               PartMeshes& part_meshes, Deadline& deadline);

}  // namespace collided::engine
