#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "collided/client.hpp"

namespace collided::client {

/// What the server tells viewers, from bytes of anybody: structure is verified, then every number and every reference
/// is checked. Each returns nothing, with a word in `flaw`, where something does not hold. Memory: a small multiple of
/// the bytes. Pure.

/// The fields of idl/geometry.fbs.
struct Page {
  std::uint64_t transfer = 0;
  std::uint64_t total = 0;
  std::uint64_t first = 0;
  std::string_view bytes;  // into the text that was read
};
std::optional<Page> decode_page(std::string_view text, std::string& flaw);

/// A run by its surface's number, which is not here yet.
struct NumberedRun {
  std::uint64_t surface = 0;
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  bool is_hull = false;
};
struct DecodedObjects {
  ShownObjects shown;                          // without runs
  std::vector<std::vector<NumberedRun>> runs;  // of each object
};
std::optional<DecodedObjects> decode_objects(std::string_view text, std::string& flaw);

std::optional<Surface> decode_surface(std::string_view text, std::string& flaw);
std::optional<Poses> decode_poses(std::string_view text, std::string& flaw);

}  // namespace collided::client
