#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/world/groups/part_meshes.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/query/query.hpp"

namespace collided {
struct ExplainedRay;
}

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

/// "sphere", "box", "capsule" and so on for one primitive, "mesh", "compound" for several, or "part" for a run of a
/// scene's triangles.
std::string_view kind_of(const ObjectInfo& info);

/// Why the filter leaves the object out, a sentence; empty where it does not.
std::string why_left_out(const ObjectInfo& info, const RayExplanationAsk& ask);

/// Explains a ray; its numbers keep the rules of rays (is_question()).
///
/// cost     three answers to the ray, a look at each object's box, and a distance for each of the nearest misses; parts
///          of scenes among these are indexed on the calling thread, once
/// threads  any
ExplainedRay explain_ray(const Snapshot& snapshot, const RayExplanationAsk& ask, PartMeshes& part_meshes,
                         Deadline& deadline);

}  // namespace collided::engine
