#pragma once

#include <string>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

struct PlanRow {
  std::string structure;
  bool built = false;
  std::string reason;
  std::string saves;
};

/// How a pair of kinds is decided, or that it is not offered.
struct PairRow {
  std::string a;
  std::string b;
  std::string how;
};

/// What this scene built and what it left out, with reasons.
std::vector<PlanRow> plan_of(const Snapshot& snapshot, bool events_wanted);
/// The probes' row, which hangs on no snapshot: they are the server's.
PlanRow plan_of_probes(std::size_t count, bool are_read);
std::vector<PairRow> pair_table();

}  // namespace collided::engine
