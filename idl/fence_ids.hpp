#pragma once

#include <cstdint>

#include "collided/codes.hpp"

/// What the ids of fences say; collided.idl has the rest.
namespace collided::wire_contract {

using codes::kNearestGoesOn;

/// Whether an id is a fence's.
inline bool is_fence_id(std::uint64_t id) { return (id & codes::kFenceBit) != 0; }

/// Both are set in the id of a fence that is a question for the nearest object.
inline constexpr std::uint64_t kNearestBits = codes::kFenceBit | codes::kNearestBit;

inline bool is_nearest_id(std::uint64_t fence) { return (fence & kNearestBits) == kNearestBits; }

}  // namespace collided::wire_contract
