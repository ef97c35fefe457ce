#include "server/intake/obj_chunk.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/intake/text_cursor.hpp"

namespace collided {
namespace {

/// Words of OBJ that say nothing about where surfaces are, or only more about curves.
constexpr std::string_view kPassedOver[] = {
    "vn",    "vt",       "s",        "mtllib", "vp",     "cstype",     "deg",       "bmat",  "step",
    "parm",  "trim",     "hole",     "scrv",   "sp",     "end",        "con",       "mg",    "lod",
    "bevel", "c_interp", "d_interp", "usemap", "maplib", "shadow_obj", "trace_obj", "ctech", "stech"};

class ChunkParser {
 public:
  ChunkParser(const Reading& reading, ObjChunk& chunk)
      : reading_(reading), chunk_(chunk), cursor_(reading, chunk.text, TextCursor::LineEnd::newline_or_comment, true) {}

  void parse() {
    while (cursor_.find_word()) {
      line_ = cursor_.place();
      const std::string_view keyword = cursor_.word();
      if (keyword == "v") {
        parse_vertex();
      } else if (keyword == "f" || keyword == "fo") {
        parse_face();
      } else {
        parse_rare(keyword);
      }
      cursor_.next_line();
    }
  }

 private:
  void parse_vertex() {
    Vec3 vertex;
    for (int axis = 0; axis < 3; ++axis) {
      vertex[axis] = cursor_.finite_number("vertex coordinate");
    }
    chunk_.vertices.push_back(vertex);
    if (!cursor_.at_line_end()) {
      parse_vertex_extras();
    }
  }

  // After x y z: a weight, a colour, or both.
  void parse_vertex_extras() {
    std::size_t extra_count = 0;
    double first = 1;
    while (!cursor_.at_line_end()) {
      const double extra = cursor_.finite_number("number after the coordinates");
      first = extra_count++ == 0 ? extra : first;
    }
    if (extra_count != 1 && extra_count != 3 && extra_count != 4) {
      refuse_line(reading_, line_, fmt::format("vertex of {} numbers, allowed 3, 4, 6 or 7", 3 + extra_count));
    }
    if (extra_count != 3 && first != 1) {
      ++chunk_.weighted_vertices;
    }
  }

  void parse_face() {
    const std::size_t first_corner = chunk_.corners.size();
    while (!cursor_.at_line_end()) {
      parse_corner();
    }
    const std::size_t corner_count = chunk_.corners.size() - first_corner;
    if (corner_count < 3) {
      chunk_.corners.resize(first_corner);
      ++chunk_.short_faces;
      if (reading_.options.strict) {
        refuse_line(reading_, line_, fmt::format("face of {} corners, at least 3 are needed", corner_count));
      }
      return;
    }
    chunk_.triangle_count += corner_count - 2;
    if (chunk_.triangle_count > reading_.options.max_triangles) {
      check_triangle_count(reading_, chunk_.triangle_count);
    }
    chunk_.face_corner_counts.push_back(static_cast<std::uint32_t>(corner_count));
    chunk_.face_bytes.push_back(static_cast<std::uint32_t>(line_ - chunk_.text.data()));
  }

  // v, v/t, v//n or v/t/n. Texture and normal numbers are read as numbers and not used.
  void parse_corner() {
    const std::int64_t number = cursor_.integer_prefix("vertex number");
    if (number == 0) {
      refuse_line(reading_, line_, "vertex number 0, they begin at 1");
    }
    for (int i = 0; i < 2 && cursor_.skip('/'); ++i) {
      if (!cursor_.at_blank_or_end() && !is_slash_next()) {
        cursor_.integer_prefix("texture or normal number");
      }
    }
    if (!cursor_.at_blank_or_end()) {
      cursor_.complain("corner is not of the form v, v/t, v//n or v/t/n");
    }
    const auto here = static_cast<std::int64_t>(chunk_.vertices.size());
    // Numbers beyond these bounds name no vertex of any file; they are kept as such for the complaint.
    const std::int64_t bounded = std::clamp(number, -kObjRelative / 2, kObjRelative / 2);
    chunk_.corners.push_back(number > 0 ? bounded - 1 : here + bounded - kObjRelative);
  }

  bool is_slash_next() const { return !cursor_.at_file_end() && *cursor_.place() == '/'; }

  void parse_rare(std::string_view keyword) {
    const auto mark = [&](ObjMark::Kind kind) {
      chunk_.marks.push_back({kind, chunk_.face_corner_counts.size(), cursor_.rest_of_line()});
    };
    if (keyword == "o") {
      mark(ObjMark::Kind::object);
    } else if (keyword == "g") {
      mark(ObjMark::Kind::group);
    } else if (keyword == "usemtl") {
      mark(ObjMark::Kind::material);
    } else if (keyword == "p" || keyword == "l") {
      ++chunk_.point_lines;
    } else if (keyword == "curv" || keyword == "curv2" || keyword == "surf") {
      ++chunk_.curve_lines;
    } else if (std::find(std::begin(kPassedOver), std::end(kPassedOver), keyword) == std::end(kPassedOver)) {
      chunk_.first_unknown_line = chunk_.unknown_lines++ == 0 ? line_ : chunk_.first_unknown_line;
    }
  }

  const Reading& reading_;
  ObjChunk& chunk_;
  TextCursor cursor_;
  const char* line_ = nullptr;
};

bool is_joined(std::string_view text, std::size_t newline) {
  std::size_t before = newline;
  if (before > 0 && text[before - 1] == '\r') {
    --before;
  }
  return before > 0 && text[before - 1] == '\\';
}

}  // namespace

std::vector<ObjChunk> split_obj(const Reading& reading) {
  constexpr std::size_t kChunkBytes = std::size_t{2} << 20;
  const std::string_view text(reading.begin(), reading.bytes.size());
  std::vector<ObjChunk> chunks;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t newline = text.find('\n', std::min(begin + kChunkBytes, text.size()));
    while (newline != std::string_view::npos && is_joined(text, newline)) {
      newline = text.find('\n', newline + 1);
    }
    const std::size_t end = newline == std::string_view::npos ? text.size() : newline + 1;
    if (end - begin > kMaxObjChunkBytes) {
      refuse_byte(reading, begin, fmt::format("line of {} bytes, limit {}", end - begin, kMaxObjChunkBytes));
    }
    chunks.push_back({.text = text.substr(begin, end - begin)});
    begin = end;
  }
  return chunks;
}

void parse_obj_chunk(const Reading& reading, ObjChunk& chunk) {
  // A typical line has 25 bytes; half are vertices in clouds, a third in closed meshes.
  chunk.vertices.reserve(chunk.text.size() / 75);
  chunk.corners.reserve(chunk.text.size() / 12);
  ChunkParser(reading, chunk).parse();
}

}  // namespace collided
