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

namespace collided {
struct DefinedStanding;
struct ExplainedStanding;
}  // namespace collided

namespace collided::engine {

/// The state of a region, or of a question for the nearest, after the last step, for use on another thread.
struct StandingLook {
  ObjectId id = 0;
  std::string name;
  FenceRule rule;
  ObjectInfo body;                  // in the world's frame, or its carrier's
  std::vector<OpenContact> inside;  // a: the object inside; for a question for the nearest: the nearest object
  std::uint64_t cut_short = 0;      // for a question for the nearest: searches that ended at their evaluation limit
};

/// Nothing if there is no such question, or if it consists of bands.
/// threads  the writer only
std::optional<StandingLook> look_at_standing(const Fences& fences, std::string_view name);

struct StandingExplanationAsk {
  std::size_t most_others = 3;
  std::size_t most_left_out = 10;
  std::optional<ObjectId> why_not = {};  // explained in any case
};

/// A region or a question for the nearest as lists and explanations describe it.
DefinedStanding defined_standing(const std::string& name, const FenceRule& rule, const ObjectInfo& body);
/// Describes a margin's bands in the same form.
DefinedStanding defined_standing(const FenceDefinition& margin);

/// The reason why the question ignores the object, a sentence; empty if it does not.
std::string why_not_looked_at(const FenceRule& rule, const ObjectInfo& object);

/// What a region holds, or which object is nearest, what else there is, and why; fills everything but the last events.
///
/// cost     a test of each object's box, and a clearance for each object that is held or among the nearest
/// threads  any
ExplainedStanding explain_standing(const Snapshot& snapshot, const StandingLook& standing,
                                   const StandingExplanationAsk& ask, PartMeshes& part_meshes, Deadline& deadline);

}  // namespace collided::engine
