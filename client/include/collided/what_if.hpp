#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <collided/clearance.hpp>

/// Objects thought elsewhere: for each of many configurations whether it is free. The world stays as it is.
#pragma GCC visibility push(default)

namespace collided {

/// Configurations of the same objects: in each, every one of them is at a pose of its own.
struct WhatIfConfigurations {
  std::vector<std::string> objects;  // 1 to 1,000 names; none is a part of a scene that does not move
  std::vector<Pose> poses;           // of the first configuration, in the order of the objects, then of the next
};

/// Against what configurations are judged, and how.
struct WhatIfOptions {
  std::string against =
      {};                 // an object, a scene or a glob; empty: everything else. The moved ones against each other too
  std::string skip = {};  // glob of objects that are left out, also of the moved ones; empty: none
  std::uint32_t mask = 0xffffffff;  // layers of which an object of `against` must have one
  /// Also the least clearance, or of a contact the greatest depth. Without it the first contact found ends a
  /// configuration, which is faster.
  bool with_clearance = false;
  double nearer_m = std::numeric_limits<double>::infinity();  // with_clearance: pairs surely farther apart do not count
  bool with_filtered = false;  // also pairs that masks and groups let pass through each other
  /// What moves along, and with what: the first keeps its place relative to the second as it is in the world.
  std::vector<std::pair<std::string, std::string>> attached = {};
  Instant as_of = {};  // of the objects that are not moved
  Importance importance = Importance::normal;
  bool fresh = false;                    // answer after this client's own last write
  std::chrono::nanoseconds deadline{0};  // on the server, from when it takes them; later configurations are undecided
  std::chrono::nanoseconds timeout{60'000'000'000};  // for all answers
};

/// One configuration's answer.
struct ConfigurationAnswer {
  Verdict verdict = Verdict::miss;  // miss: it is free. hit: something touches
  UndecidedReason reason = UndecidedReason::none;
  /// The pair that touches: a moved object first. WhatIfOptions::with_clearance: the one with the least clearance, also
  /// where none touches, unless all are farther apart than asked for. Without it, only the names count.
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
