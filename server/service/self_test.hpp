#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine::service {

/// How many answers were checked, and how many of them equalled brute force.
struct SelfTestResult {
  std::uint32_t asked = 0;
  std::uint32_t equal = 0;
  std::vector<std::string> differences;  // the first few, as sentences with all numbers
};

/// Asks random rays, spheres, boxes and nearest points about a state of the world, and audits every answer.
///
/// question_count  of each kind; the same seed asks the same questions
SelfTestResult self_test(const Snapshot& snapshot, std::uint32_t question_count, std::uint64_t seed);

}  // namespace collided::engine::service
