#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "collided/client.hpp"

/// The answers to the questions of pages (page_question.hpp), as JSON, with the members that `collide VERB --json`
/// prints and the page's number of the question. Refusals become refused_text.
namespace collided::view {

/// {type "answer", id, ask "ray", answer, reason, origin, direction, object, distance, error, point, normal, triangle,
///  point_error, cost {nodes, exact_tests, compute (s, on the server)}, age (s, of the poses that decided)}
std::string ray_answer_text(double id, const RayQuestion& asked, const Result<Answers>& answers);

/// {type "answer", id, ask, answer, reason, hits [{object, distance, error, point, normal, triangle, point_error,
/// inside}], left_out, cost, age}: at most 100 hits, left_out counts the others; those of a sweep have time_low and
/// time_high.
///
/// ask  sphere, box, near or sweep
std::string hits_answer_text(double id, std::string_view ask, const Result<Answers>& answers);

/// {type "answer", id, ask "nearest", answer, reason, name, other, clearance (m), error, on_a, on_b, late, tested}: the
/// object nearest to another; without `other` if there is none, or if time was over before any was found.
std::string nearest_answer_text(double id, const std::string& name, const Result<ClearanceAnswer>& answer);

/// {type "answer", id, ask "pair", a, b, answer, distance or depth, error, on_a, on_b}.
std::string pair_answer_text(double id, const std::string& a, const std::string& b, const Result<PairAnswer>& answer);

/// {type "answer", id, ask "object", name, kind, moving, scene, publisher, layers, mask, group, triangles, stale,
/// solid, pose [7], bounds [low, high], age (s), contacts [names]}; pose and age only where there are any.
std::string object_answer_text(double id, const Result<ObjectDetails>& object);

/// {type "answer", id, ask "owners", owners [{publisher, slots []}], left_out}: the moving objects by their publishers;
/// "" is the publisher of those that a client added.
std::string owners_answer_text(double id, const Result<ObjectList>& moving);

/// {type "answer", id, ask "memory", path}: the path of the server's memory, as a run (RunWriter).
std::string memory_answer_text(double id, const Result<std::uint64_t>& number);

/// {type "answer", id, ask "sampled", questions, since}: in the format of the command `sampled` (idl/commands.hpp).
std::string sampled_answer_text(double id, const Result<std::string>& told);

/// {type "refused", id, why}
std::string refused_text(double id, std::string_view why);

}  // namespace collided::view
