#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace collided::engine {

/// Puts a file in place of what is at the path, whole or not at all: written beside it, brought to the disk, renamed.
/// pieces    the bytes, one after the other
/// returns   what went wrong, or nothing
std::string replace_file(const std::string& path, std::span<const std::span<const std::byte>> pieces);

/// Writes to a file that is open already, from where it stands, and brings it to the disk.
std::string write_file(int file, std::span<const std::span<const std::byte>> pieces);

}  // namespace collided::engine
