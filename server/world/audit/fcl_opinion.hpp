#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "collided/codes.hpp"
#include "idl/answers/measured.hpp"
#include "server/world/audit/opinion_request.hpp"
#include "server/world/query/pair_report.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

using codes::OpinionVerdict;

/// What FCL says to a pair that has been answered here.
struct Opinion {
  OpinionVerdict verdict = OpinionVerdict::failed;
  std::optional<bool> touches = {};       // FCL's yes or no
  std::optional<double> distance_m = {};  // FCL's, of two that it says are apart
  std::string why = {};                   // failed, unsupported; or why FCL has no distance
};

void count(OpinionVerdict verdict, OpinionCounts& counts);

/// Asks FCL about two objects, as they stand in the snapshot, and compares with our own report of them. FCL runs in
/// collided-opinion, a process of its own with the importer's limits, that is started for this question and ends with it: FCL's
/// asserts end that process, not this one, and are told as `failed`.
///
/// cost     the start of a process, some 10 ms, and FCL's index of each mesh; at most kOpinionSeconds
/// threads  any
Opinion fcl_opinion(const Snapshot& snapshot, ObjectId a, ObjectId b, const PairReport& ours,
                    const std::function<bool()>& cancelled = {});

/// The same about an answer to a question. Spheres and boxes only: whether FCL too says that something is touched, of all parts
/// near enough to be. Rays and distances from a point are unsupported.
Opinion fcl_opinion(const Snapshot& snapshot, const Questions& question, const Answers& given,
                    const std::function<bool()>& cancelled = {});

inline constexpr int kOpinionSeconds = 10;

// Its parts.

/// What collided-opinion printed, not compared yet; failed where it did not end well.
Opinion ask_opinion_program(const OpinionRequest& request, const std::function<bool()>& cancelled);
/// FCL's answer beside ours: agree or differ where both say something. size_m: of the two objects.
Opinion compared(Opinion said, const PairReport& ours, double size_m);

}  // namespace collided::engine
