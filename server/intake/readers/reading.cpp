#include "server/intake/readers/reading.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/intake/limits.hpp"

namespace collided::engine {

void refuse(const Reading& reading, const std::string& what) {
  throw LoadError(fmt::format("{}: {}. Nothing was loaded.", reading.file, what));
}

void refuse_line(const Reading& reading, const char* place, const std::string& what) {
  const auto line =
      1 + reading.lines_before + std::count(reading.begin(), std::clamp(place, reading.begin(), reading.end()), '\n');
  refuse(reading, fmt::format("line {}: {}", line, what));
}

void refuse_byte(const Reading& reading, std::size_t byte, const std::string& what) {
  refuse(reading, fmt::format("byte {}: {}", byte, what));
}

std::string in_quotes(std::string_view piece, std::size_t shown) {
  std::string text = "'";
  for (const char c : piece.substr(0, shown)) { text += c >= ' ' && c <= '~' ? c : '?'; }
  return text + (piece.size() > shown ? "...'" : "'");
}

void tell_progress(const Reading& reading, double fraction) {
  if (reading.options.cancelled && reading.options.cancelled()) {
    refuse(reading, fmt::format("cancelled after {:.0f} %", 100 * fraction));
  }
  if (reading.options.progress) { reading.options.progress(fraction); }
}

void check_triangle_count(const Reading& reading, std::uint64_t triangle_count) {
  const std::uint64_t limit = std::min(reading.options.max_triangles, kMaxVertices);
  if (triangle_count > limit) { refuse(reading, fmt::format("{} triangles, limit {}", triangle_count, limit)); }
}

void check_vertex_count(const Reading& reading, std::uint64_t vertex_count) {
  if (vertex_count > kMaxVertices) {
    refuse(reading, fmt::format("{} vertices, limit {}", vertex_count, kMaxVertices));
  }
}

}  // namespace collided::engine
