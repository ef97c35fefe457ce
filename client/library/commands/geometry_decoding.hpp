#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "collided/client.hpp"
#include "collided/snapshot.hpp"

namespace collided::format {
struct Mesh;
struct Shape;
}  // namespace collided::format

namespace collided::client {

// Decoding of the answers to the commands of viewers, from untrusted bytes: the structure is verified, then every
// number and reference is checked. Each function returns nothing if the data is invalid, with the reason in `flaw`.
// They are pure, and their memory is a small multiple of the bytes.

/// A page of an answer, with the fields of table Page in idl/geometry.fbs.
struct Page {
  std::uint64_t transfer = 0;
  std::uint64_t total = 0;
  std::uint64_t first = 0;
  std::string_view bytes;  // points into the decoded text
};
std::optional<Page> decode_page(std::string_view text, std::string& flaw);

/// A run whose surface is known only by its number so far.
struct NumberedRun {
  std::uint64_t surface = 0;
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  bool is_hull = false;
};
/// Objects whose surfaces have not been fetched yet.
struct DecodedObjects {
  ShownObjects shown;                          // without runs
  std::vector<std::vector<NumberedRun>> runs;  // by object
};
std::optional<DecodedObjects> decode_objects(std::string_view text, std::string& flaw);

/// What a snapshot's file says of itself.
std::optional<WrittenSnapshot> decode_snapshot(std::string_view text, std::string& flaw);

std::optional<Surface> decode_surface(std::string_view text, std::string& flaw);
std::optional<Poses> decode_poses(std::string_view text, std::string& flaw);

/// The primitives of a verified shape, not scaled; nothing if a number is invalid. Other parts are left out.
///
/// byte_budget  bounds the memory, since tables of a damaged buffer may share numbers
std::optional<Shape> decode_primitives(const format::Shape& from, std::size_t byte_budget);
/// Decodes a verified mesh; nothing if a number or a corner is invalid.
std::optional<Surface> decode_mesh(const format::Mesh& from);

}  // namespace collided::client
