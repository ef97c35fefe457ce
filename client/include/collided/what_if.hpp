#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <collided/clearance.hpp>

/// What-if questions: whether configurations of objects would be free, without changing the world.
#pragma GCC visibility push(default)

namespace collided {

/// Configurations of the same objects; each configuration has a pose for every object.
struct WhatIfConfigurations {
  std::vector<std::string> objects;  // 1 to 1,000 names; parts of static scenes are not allowed
  std::vector<Pose> poses;           // for the first configuration, in the order of the objects, then for the next
};

/// What configurations are tested against, and how.
struct WhatIfOptions {
  std::string against =
      {};                 // an object, a scene or a glob; empty: everything else. Moved objects also against each other
  std::string skip = {};  // glob of objects to leave out, also among the moved ones; empty: none
  std::uint32_t mask = 0xffffffff;  // layers; an object of `against` must have one of them
  /// Also compute the least clearance, or the greatest depth of a contact. Without it the first contact found ends a
  /// configuration, which is faster.
  bool with_clearance = false;
  double nearer_m = std::numeric_limits<double>::infinity();  // with_clearance: ignore pairs certainly farther apart
  bool with_filtered = false;                                 // also test pairs that masks and groups exclude
  /// Attached objects: the first of each pair keeps its pose, as in the world, relative to the second.
  std::vector<std::pair<std::string, std::string>> attached = {};
  Instant as_of = {};  // instant for the objects that are not moved
  Importance importance = Importance::normal;
  bool fresh = false;                    // answer after this client's own last write
  std::chrono::nanoseconds deadline{0};  // on the server, from its receipt of them; later configurations are undecided
  std::chrono::nanoseconds timeout{60'000'000'000};  // for all answers
};

/// One configuration's answer.
struct ConfigurationAnswer {
  Verdict verdict = Verdict::miss;  // miss: free. hit: in contact
  UndecidedReason reason = UndecidedReason::none;
  /// A pair that touches, the moved object first. With WhatIfOptions::with_clearance: the pair with the least
  /// clearance, even if none touches, unless all are farther apart than requested. Without it, only the names are set.
  std::optional<ClearancePair> nearest;
};

/// The answers to all configurations, on one state of the world.
struct WhatIfAnswers {
  std::uint64_t version = 0;                        // of that state
  std::chrono::nanoseconds world_time{0};           // of that state, since 1970, by the publishers' clocks
  std::chrono::nanoseconds compute{0};              // on the server, summed over messages
  std::vector<ConfigurationAnswer> configurations;  // in order
};

}  // namespace collided

#pragma GCC visibility pop
