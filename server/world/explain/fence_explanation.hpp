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
struct ExplainedFence;
}

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

struct FenceExplanationAsk {
  std::size_t most_outside = 3;
  std::size_t most_left_out = 10;
  std::optional<ObjectId> why_not = {};  // told of in any case
};

/// Why the fence, or the question, does not look at the object, a sentence; empty where it does.
std::string why_not_looked_at(const FenceRule& rule, const ObjectInfo& object);

/// Who is in a fence and who is not, and why; all but the last events is filled. Of a question for the
/// nearest: `inside` is nearest, `outside` the others, `left_out` would be nearer but is not looked at.
///
/// cost     a look at each object's box, and a clearance for each that is in or among the nearest
/// threads  any
ExplainedFence explain_fence(const Snapshot& snapshot, const FenceLook& fence, const FenceExplanationAsk& ask,
                             PartMeshes& part_meshes, Deadline& deadline);

}  // namespace collided::engine
