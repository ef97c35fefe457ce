#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <span>

#include "server/intake/polygons/triangulate.hpp"
#include "server/intake/readers/byte_order.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/readers/text_cursor.hpp"
#include "server/intake/weld.hpp"

namespace collided::engine {
namespace {

constexpr std::size_t kHeaderBytes = 84;     // 80 of anything, then the triangle count
constexpr std::size_t kTriangleBytes = 50;   // normal, three corners, two bytes of anything
constexpr std::size_t kGivenBack = 0x10000;  // triangles after which their bytes are given back

std::uint64_t claimed_triangles(const Reading& reading) {
  return number_at<std::uint32_t>(reading.begin() + 80, std::endian::little);
}

bool is_word(std::string_view word, std::string_view lower) {
  return word.size() == lower.size() && std::equal(word.begin(), word.end(), lower.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == b;
         });
}

// Whether a file is text. Binary files often begin with "solid" too. A size that matches the triangle count to the byte
// means binary; else a text file begins with "solid" and has "facet" or "endsolid" among its next words.
bool is_text(const Reading& reading) {
  if (reading.bytes.size() >= kHeaderBytes &&
      reading.bytes.size() == kHeaderBytes + kTriangleBytes * claimed_triangles(reading)) {
    return false;
  }
  constexpr std::size_t kLookBytes = 4096;
  TextCursor cursor(reading, {reading.begin(), std::min(kLookBytes, reading.bytes.size())},
                    TextCursor::LineEnd::newline, false);
  if (!cursor.find_word() || !is_word(cursor.word(), "solid")) { return false; }
  while (cursor.find_word()) {
    const std::string_view word = cursor.word();
    if (is_word(word, "facet") || is_word(word, "endsolid")) { return true; }
  }
  return reading.bytes.size() < kHeaderBytes;
}

void read_corners(const Reading& reading, std::size_t triangle, std::size_t count, Vec3* corners) {
  const std::size_t byte = kHeaderBytes + kTriangleBytes * triangle + 12;
  for (std::size_t k = 0; k < 9; ++k) {
    const auto value = number_at<float>(reading.begin() + byte + 4 * k, std::endian::little);
    if (!std::isfinite(value)) {
      refuse_byte(reading, byte + 4 * k,
                  fmt::format("triangle {} of {}: coordinate {} is not finite", triangle + 1, count, value));
    }
    corners[k / 3][static_cast<Eigen::Index>(k % 3)] = value;
  }
}

Scene read_binary(const Reading& reading) {
  if (reading.bytes.size() < kHeaderBytes) {
    refuse(reading, fmt::format("{} bytes, a binary STL has at least {}", reading.bytes.size(), kHeaderBytes));
  }
  const std::uint64_t count = claimed_triangles(reading);
  const std::uint64_t room = (reading.bytes.size() - kHeaderBytes) / kTriangleBytes;
  if (count > room) {
    refuse_byte(reading, 80, fmt::format("header claims {} triangles, the file has room for {}", count, room));
  }
  check_triangle_count(reading, count);
  const std::uint64_t surplus = reading.bytes.size() - kHeaderBytes - kTriangleBytes * count;
  if (surplus > 0) {
    reading.report.warnings.push_back(
        fmt::format("{} bytes after the {} triangles that the header counts were not read", surplus, count));
  }
  Scene scene;
  scene.mesh.triangles.resize(count);
  // STL has no vertex numbers: corners with equal coordinates count as one vertex. A closed surface has half as many
  // vertices as triangles.
  Welder welder(scene.mesh.vertices, count / 2 + 16);
  constexpr std::size_t kTriangles = Welder::kBatch / 3;
  static_assert(kGivenBack % kTriangles == 0);
  std::array<Vec3, Welder::kBatch> corners;
  for (std::size_t first = 0; first < count; first += kTriangles) {
    const std::size_t end = std::min(first + kTriangles, std::size_t{count});
    for (std::size_t i = first; i < end; ++i) read_corners(reading, i, count, &corners[3 * (i - first)]);
    welder.number(std::span(corners).first(3 * (end - first)), scene.mesh.triangles[first].data());
    if (first % kGivenBack == 0) {
      if (first > 0 && reading.give_back) {
        reading.give_back(
            reading.bytes.subspan(kHeaderBytes + kTriangleBytes * (first - kGivenBack), kTriangleBytes * kGivenBack));
      }
      tell_progress(reading, 0.5 * static_cast<double>(first) / static_cast<double>(count));
    }
  }
  scene.parts.push_back({.name = {}, .triangle_count = static_cast<std::uint32_t>(count)});
  return scene;
}

/// solid NAME { facet normal . . . outer loop { vertex x y z } endloop endfacet } endsolid, any number of times.
class StlTextReader {
 public:
  explicit StlTextReader(const Reading& reading)
      : reading_(reading),
        cursor_(reading, {reading.begin(), reading.bytes.size()}, TextCursor::LineEnd::newline, false) {}

  Scene read() {
    while (cursor_.find_word()) {
      const std::string_view word = cursor_.word();
      if (is_word(word, "vertex")) {
        read_vertex();
      } else if (is_word(word, "endloop")) {
        end_loop();
      } else if (is_word(word, "facet")) {
        begin_facet();
      } else if (is_word(word, "solid")) {
        begin_solid();
      } else if (is_word(word, "endsolid")) {
        cursor_.next_line();
      } else if (!is_word(word, "outer") && !is_word(word, "loop") && !is_word(word, "endfacet")) {
        cursor_.complain(fmt::format("{} is no word of STL", in_quotes(word)));
      }
    }
    if (!loop_.empty()) { cursor_.complain("the file ends inside a facet"); }
    return std::move(scene_);
  }

 private:
  void begin_solid() {
    scene_.parts.push_back({.name = std::string(cursor_.rest_of_line()),
                            .first_triangle = static_cast<std::uint32_t>(scene_.mesh.triangles.size())});
  }

  // The normal is skipped: it is often wrong, and the order of the corners gives it.
  void begin_facet() {
    if (!loop_.empty()) { cursor_.complain("facet begins before 'endloop' of the one before"); }
    if (scene_.parts.empty()) { cursor_.complain("facet before 'solid'"); }
    cursor_.next_line();
  }

  void read_vertex() {
    Vec3 vertex;
    for (int axis = 0; axis < 3; ++axis) { vertex[axis] = cursor_.finite_number("vertex coordinate"); }
    loop_.push_back(welder_.number_of(vertex));
    check_vertex_count(reading_, scene_.mesh.vertices.size());
  }

  void end_loop() {
    if (loop_.size() < 3 || scene_.parts.empty()) {
      cursor_.complain(fmt::format("facet of {} corners, at least 3 are needed", loop_.size()));
    }
    const PolygonKind kind = triangulate(loop_, scene_.mesh.vertices, scene_.mesh.triangles);
    if (kind == PolygonKind::crossing || kind == PolygonKind::too_long) {
      cursor_.complain(fmt::format("facet of {} corners crosses itself or is too long to cut", loop_.size()));
    }
    check_triangle_count(reading_, scene_.mesh.triangles.size());
    Part& part = scene_.parts.back();
    part.triangle_count = static_cast<std::uint32_t>(scene_.mesh.triangles.size()) - part.first_triangle;
    loop_.clear();
    if (scene_.mesh.triangles.size() % 0x10000 == 0) {
      tell_progress(reading_, 0.7 * static_cast<double>(cursor_.place() - reading_.begin()) /
                                  static_cast<double>(reading_.bytes.size()));
    }
  }

  const Reading& reading_;
  TextCursor cursor_;
  std::vector<std::uint32_t> loop_;
  Scene scene_;
  Welder welder_{scene_.mesh.vertices};
};

}  // namespace

Scene read_stl(const Reading& reading) {
  return is_text(reading) ? StlTextReader(reading).read() : read_binary(reading);
}

}  // namespace collided::engine
