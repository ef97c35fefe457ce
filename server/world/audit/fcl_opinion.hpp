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

/// FCL's answer for a pair that has been answered here.
struct Opinion {
  OpinionVerdict verdict = OpinionVerdict::failed;
  std::optional<bool> touches = {};       // FCL's yes or no
  std::optional<double> distance_m = {};  // FCL's distance of two that it finds apart
  std::string why = {};                   // failed, unsupported; or the reason why FCL has no distance
};

void count(OpinionVerdict verdict, OpinionCounts& counts);

/// Runs FCL on two objects in the snapshot, and compares with our own report on them. FCL runs in collided-opinion, a
/// process of its own with the importer's limits, started for this question: FCL's asserts end that process, not this
/// one, and are reported as `failed`.
///
/// cost     the start of a process, some 10 ms, and FCL's index of each mesh; at most kOpinionSeconds
/// threads  any
Opinion fcl_opinion(const Snapshot& snapshot, ObjectId a, ObjectId b, const PairReport& ours,
                    const std::function<bool()>& cancelled = {});

/// Compares an answer to a question. Spheres and boxes only: whether FCL also finds a contact, over all parts near
/// enough. Rays and distances from a point are unsupported.
Opinion fcl_opinion(const Snapshot& snapshot, const Questions& question, const Answers& given,
                    const std::function<bool()>& cancelled = {});

inline constexpr int kOpinionSeconds = 10;

// Steps of the above.

/// The output of collided-opinion, not compared yet; failed if it did not end well.
Opinion ask_opinion_program(const OpinionRequest& request, const std::function<bool()>& cancelled);
/// FCL's answer with ours: agree or differ if both decide. size_m: of the two objects.
Opinion compared(Opinion said, const PairReport& ours, double size_m);

}  // namespace collided::engine
