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

/// A ray to explain, and the filter of what may answer it, as in Questions.
struct RayExplanationAsk {
  std::array<double, kRayNumbers> numbers{};  // in the order of question_columns() in idl/columns.hpp
  std::uint32_t mask = 0xffffffff;
  std::string only;
  std::string skip;
  std::size_t most_misses = 3;
  std::optional<ObjectId> why_not = {};  // always explained

  /// The result refers to this object.
  Questions questions() const;
};

/// "sphere", "box", "capsule" and so on for one primitive, "mesh", "compound" for several, or "part" for a run of a
/// scene's triangles.
std::string_view kind_of(const ObjectInfo& info);

/// The reason why the filter excludes the object, a sentence; empty if it does not.
std::string why_left_out(const ObjectInfo& info, const RayExplanationAsk& ask);

/// Explains a ray; its numbers must satisfy the rules of rays (is_question()).
///
/// cost     three answers to the ray, a test of each object's box, and a distance for each of the nearest misses; parts
///          of scenes among these are indexed on the calling thread, once
/// threads  any
ExplainedRay explain_ray(const Snapshot& snapshot, const RayExplanationAsk& ask, PartMeshes& part_meshes,
                         Deadline& deadline);

}  // namespace collided::engine
