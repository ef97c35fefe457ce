#include <fmt/format.h>

#include <algorithm>

#include "server/intake/limits.hpp"
#include "server/intake/readers/polygons.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {
namespace {

class OffReader {
 public:
  explicit OffReader(const Reading& reading)
      : reading_(reading),
        cursor_(reading, {reading.begin(), reading.bytes.size()}, TextCursor::LineEnd::newline_or_comment, false),
        polygons_(reading) {}

  Scene read() {
    read_header();
    const std::uint64_t vertex_count = read_count("vertex count", 6);  // "0 0 0" and a line end
    const std::uint64_t face_count = read_count("face count", 2);
    check_vertex_count(reading_, vertex_count);
    check_triangle_count(reading_, face_count);
    cursor_.next_line();
    read_vertices(vertex_count);
    read_faces(face_count);
    polygons_.report();
    return polygons_.take_scene();
  }

 private:
  // The header [ST][C][N]OFF. Texture, colour and normal follow a vertex on its line and are ignored.
  void read_header() {
    if (!cursor_.find_word()) { refuse(reading_, "no text of OFF in it"); }
    TextCursor ahead = cursor_;
    std::string_view word = ahead.word();
    if (word[0] >= '0' && word[0] <= '9' && !word.ends_with("OFF")) {
      return;  // the word itself is optional
    }
    const std::string_view whole = word;
    for (const std::string_view prefix : {"ST", "C", "N"}) {
      if (word.starts_with(prefix)) { word.remove_prefix(prefix.size()); }
    }
    if (word != "OFF") {
      cursor_.complain(fmt::format("{} is not OFF, COFF, NOFF, CNOFF or one of these after ST", in_quotes(whole)));
    }
    cursor_ = ahead;
    if (!cursor_.at_line_end()) {
      TextCursor next = cursor_;
      if (next.word() == "BINARY") { cursor_.complain("binary OFF is not read; write it as text"); }
    }
    has_plain_vertices_ = whole == "OFF";
  }

  std::uint64_t read_count(std::string_view what, std::uint64_t least_bytes) {
    if (!cursor_.find_word()) { refuse(reading_, fmt::format("{} is missing", what)); }
    const std::int64_t count = cursor_.integer(what);
    const auto room = reading_.bytes.size() / least_bytes + 1;
    if (count < 0 || static_cast<std::uint64_t>(count) > room) {
      cursor_.complain(fmt::format("{} {}, the file has room for {}", what, count, room));
    }
    return static_cast<std::uint64_t>(count);
  }

  void read_vertices(std::uint64_t vertex_count) {
    std::vector<Vec3>& vertices = polygons_.vertices();
    vertices.reserve(vertex_count);
    std::uint64_t surplus_lines = 0;
    for (std::uint64_t i = 0; i < vertex_count; ++i) {
      if (!cursor_.find_word()) {
        cursor_.complain(fmt::format("the file ends after {} of {} vertices", i, vertex_count));
      }
      Vec3 vertex;
      for (int axis = 0; axis < 3; ++axis) { vertex[axis] = cursor_.finite_number("vertex coordinate"); }
      vertices.push_back(vertex);
      surplus_lines += has_plain_vertices_ && !cursor_.at_line_end() ? 1 : 0;
      cursor_.next_line();
      if (i % 0x10000 == 0) {
        tell_progress(reading_, 0.3 * static_cast<double>(i) / static_cast<double>(vertex_count));
      }
    }
    if (surplus_lines > 0) {
      reading_.report.warnings.push_back(
          fmt::format("{} vertex lines hold more than x y z; the rest of each was not used", surplus_lines));
    }
  }

  void read_faces(std::uint64_t face_count) {
    std::vector<std::uint32_t> corners;
    for (std::uint64_t i = 0; i < face_count; ++i) {
      if (!cursor_.find_word()) { cursor_.complain(fmt::format("the file ends after {} of {} faces", i, face_count)); }
      const char* line = cursor_.place();
      const std::int64_t corner_count = cursor_.integer("corner count");
      if (corner_count < 0) { cursor_.complain(fmt::format("face of {} corners", corner_count)); }
      corners.clear();
      for (std::int64_t k = 0; k < corner_count; ++k) {  // ends with the line at the latest
        corners.push_back(polygons_.vertex_number(cursor_.integer("vertex number"), line));
      }
      polygons_.add(corners, line);
      cursor_.next_line();
      if (i % 0x10000 == 0) {
        tell_progress(reading_, 0.3 + 0.5 * static_cast<double>(i) / static_cast<double>(face_count));
      }
    }
  }

  const Reading& reading_;
  TextCursor cursor_;
  Polygons polygons_;
  bool has_plain_vertices_ = true;
};

}  // namespace

Scene read_off(const Reading& reading) { return OffReader(reading).read(); }

}  // namespace collided::engine
