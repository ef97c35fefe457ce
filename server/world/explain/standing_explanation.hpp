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

/// A region, or a question for the nearest, as the step that is over left it, for use on another thread.
struct StandingLook {
  ObjectId id = 0;
  std::string name;
  FenceRule rule;
  ObjectInfo body;                  // in the world's frame, or its carrier's
  std::vector<OpenContact> inside;  // a: the object; of the nearest the one that is
  std::uint64_t cut_short = 0;      // of the nearest: searches that ended at their limit of looks
};

/// Nothing: there is no such question, or it is one of bands.
/// threads  the writer's only
std::optional<StandingLook> look_at_standing(const Fences& fences, std::string_view name);

struct StandingExplanationAsk {
  std::size_t most_others = 3;
  std::size_t most_left_out = 10;
  std::optional<ObjectId> why_not = {};  // it is explained in any case
};

/// A region or a question for the nearest as lists and explanations describe it.
DefinedStanding defined_standing(const std::string& name, const FenceRule& rule, const ObjectInfo& body);
/// The same for bands.
DefinedStanding defined_standing(const FenceDefinition& margin);

/// Why the question does not look at the object, a sentence; empty where it does.
std::string why_not_looked_at(const FenceRule& rule, const ObjectInfo& object);

/// What a region holds, or what is nearest, what else there is, and why; all but the last events is filled.
///
/// cost     a look at each object's box, and a clearance for each that is held or among the nearest
/// threads  any
ExplainedStanding explain_standing(const Snapshot& snapshot, const StandingLook& standing,
                                   const StandingExplanationAsk& ask, PartMeshes& part_meshes, Deadline& deadline);

}  // namespace collided::engine
