#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace collided::engine::bvh {

/// Detects accidents: another mesh, a truncated file, a flipped bit (one flip in a megabyte is always detected). Not
/// secure against forgery. Independent of the number of threads.
std::uint64_t checksum(std::span<const std::byte> bytes, unsigned threads);

/// The checksum of two checksums in order.
std::uint64_t joined_checksum(std::uint64_t first, std::uint64_t second);

}  // namespace collided::engine::bvh
