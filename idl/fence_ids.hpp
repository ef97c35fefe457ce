#pragma once

#include <cstdint>

/// What the messages of fences say in numbers; collided.idl has the rest.
namespace collided::wire_contract {

/// Whether an id is a fence's, whose slots are others than those of objects.
inline bool is_fence_id(std::uint64_t id) { return (id >> 63) != 0; }

/// Both are set in the id of a fence that is a question for the nearest object.
inline constexpr std::uint64_t kNearestBits = std::uint64_t{3} << 62;
/// In b_triangles of the end of who was nearest: another one is at once, which the next event says.
inline constexpr std::uint32_t kNearestGoesOn = 1;

inline bool is_nearest_id(std::uint64_t fence) { return (fence & kNearestBits) == kNearestBits; }

}  // namespace collided::wire_contract
