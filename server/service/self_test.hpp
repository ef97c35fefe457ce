#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine::service {

struct SelfTestResult {
  std::uint32_t asked = 0;
  std::uint32_t equal = 0;
  std::vector<std::string> differences;  // a few, as sentences with all numbers
};

/// Asks rays, spheres, boxes and nearest points about a state of the world, and audits every answer.
///
/// question_count  of each kind; the same seed asks the same questions
SelfTestResult self_test(const Snapshot& snapshot, std::uint32_t question_count, std::uint64_t seed);

}  // namespace collided::engine::service
