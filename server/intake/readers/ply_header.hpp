#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// The number types of PLY.
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
/// How the rows after the header are written.
enum class PlyFormat { text, little_endian, big_endian };

std::size_t byte_count(PlyType type);

/// A column of an element: a number or a list of numbers in each row.
struct PlyProperty {
  std::string_view name;
  PlyType type;
  std::optional<PlyType> count_type;  // type of a list's length; none: not a list
};

/// A table of the file, such as the vertices or the faces.
struct PlyElement {
  std::string_view name;
  std::uint64_t row_count = 0;
  std::vector<PlyProperty> properties;

  /// The number of the property of that name, or -1.
  int find(std::string_view property_name) const;
};

/// The header's description of the rest of the file. Names point into the reading.
struct PlyHeader {
  PlyFormat format = PlyFormat::text;
  std::vector<PlyElement> elements;
  std::size_t body_byte = 0;  // where the rows begin
};

/// Parses the header. Throws a LoadError if it is not a PLY header, or announces more rows than fit the rest of the
/// file.
PlyHeader parse_ply_header(const Reading& reading);

}  // namespace collided::engine
