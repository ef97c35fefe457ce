#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace collided::engine {

/// Replaces the file at the path, or creates it, completely or not at all: the new file is written beside it, brought
/// to the disk and renamed.
///
/// pieces    the bytes, one after the other
/// returns   what went wrong; empty: done
std::string replace_file(const std::string& path, std::span<const std::span<const std::byte>> pieces);

/// Writes to an open file from its current position, and brings it to the disk. Returns as replace_file.
std::string write_file(int file, std::span<const std::span<const std::byte>> pieces);

}  // namespace collided::engine
