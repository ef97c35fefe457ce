#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyFormat { text, little_endian, big_endian };

std::size_t byte_count(PlyType type);

struct PlyProperty {
  std::string_view name;
  PlyType type;
  std::optional<PlyType> count_type;  // a list has one
};

struct PlyElement {
  std::string_view name;
  std::uint64_t row_count = 0;
  std::vector<PlyProperty> properties;

  /// The number of the property of that name, or -1.
  int find(std::string_view property_name) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::text;
  std::vector<PlyElement> elements;
  std::size_t body_byte = 0;  // where the rows begin
};

/// Refuses what is no PLY header, and counts that the rest of the file has no room for.
PlyHeader parse_ply_header(const Reading& reading);

}  // namespace collided::engine
