#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace collided::engine::bvh {

/// Tells accidents from the bytes that were meant: another mesh, a cut file, a flipped bit (one flip in a megabyte is
/// always seen). Not made against forgers. The same for any number of threads.
std::uint64_t checksum(std::span<const std::byte> bytes, unsigned threads);

/// Of two in order.
std::uint64_t joined_checksum(std::uint64_t first, std::uint64_t second);

}  // namespace collided::engine::bvh
