#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// One structure of the plan: whether the scene has it, why, and what it saves; sentences for the user.
struct PlanRow {
  std::string structure;
  bool built = false;
  std::string reason;
  std::string saves;
};

/// How the engine decides a pair of kinds of shapes, or that it does not offer the pair.
struct PairRow {
  std::string a;
  std::string b;
  std::string how;
};

/// Lists the structures that this scene built and those that it left out, with reasons.
std::vector<PlanRow> plan_of(const Snapshot& snapshot, bool events_wanted);
/// The plan's row for probes, which depend on the server rather than on a snapshot.
PlanRow plan_of_probes(std::size_t count, bool are_read);
/// The row for searches of fences and of questions for the nearest that ended at their limit; count is at least 1.
PlanRow plan_of_cut_searches(std::uint64_t count);
/// One row for every pair of kinds of shapes.
std::vector<PairRow> pair_table();

}  // namespace collided::engine
