#include "server/intake/readers/obj_chunk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "server/intake/limits.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {
namespace {

/// Keywords of OBJ that are irrelevant for surfaces, or only add to curves.
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
    for (int axis = 0; axis < 3; ++axis) { vertex[axis] = cursor_.finite_number("vertex coordinate"); }
    chunk_.vertices.push_back(vertex);
    if (!cursor_.at_line_end()) { parse_vertex_extras(); }
  }

  // After x y z there may be a weight, a colour, or both.
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
    if (extra_count != 3 && first != 1) { ++chunk_.weighted_vertices; }
  }

  void parse_face() {
    const std::size_t first_corner = chunk_.corners.size();
    const std::uint32_t first_line = cursor_.lines_passed();
    while (!cursor_.at_line_end()) { parse_corner(); }
    const std::size_t corner_count = chunk_.corners.size() - first_corner;
    if (corner_count < 3) {
      chunk_.corners.resize(first_corner);
      if (!chunk_.is_relative.empty()) chunk_.is_relative.resize(first_corner);
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
    chunk_.face_lines.push_back(first_line);
  }

  // v, v/t, v//n or v/t/n. Texture and normal numbers are read as numbers and ignored.
  void parse_corner() {
    const std::int64_t number = cursor_.integer_prefix("vertex number");
    if (number == 0) { refuse_line(reading_, line_, "vertex number 0, they begin at 1"); }
    for (int i = 0; i < 2 && cursor_.skip('/'); ++i) {
      if (!cursor_.at_blank_or_end() && !is_slash_next()) { cursor_.integer_prefix("texture or normal number"); }
    }
    if (!cursor_.at_blank_or_end()) { cursor_.complain("corner is not of the form v, v/t, v//n or v/t/n"); }
    if (number > 0) {
      add_absolute(number - 1);
    } else {
      add_relative(number);
    }
  }

  void add_absolute(std::int64_t index) {
    if (index > static_cast<std::int64_t>(kMaxVertices)) {
      refuse_line(reading_, line_, fmt::format("vertex number {}, limit {}", index + 1, kMaxVertices));
    }
    chunk_.corners.push_back(static_cast<std::uint32_t>(index));
    if (!chunk_.is_relative.empty()) chunk_.is_relative.push_back(false);
  }

  /// Adds a corner that counts back from the last vertex. It is stored relative to the chunk's first vertex, until the
  /// number of vertices before the chunk is known.
  void add_relative(std::int64_t number) {
    const auto here = static_cast<std::int64_t>(chunk_.vertices.size());
    if (number < -std::int64_t{std::numeric_limits<std::int32_t>::max()}) {
      refuse_line(reading_, line_,
                  fmt::format("vertex number {}, limit {}", number, -std::numeric_limits<std::int32_t>::max()));
    }
    chunk_.is_relative.resize(chunk_.corners.size(), false);
    chunk_.is_relative.push_back(true);
    chunk_.corners.push_back(static_cast<std::uint32_t>(static_cast<std::int32_t>(here + number)));
  }

  bool is_slash_next() const { return !cursor_.at_file_end() && *cursor_.place() == '/'; }

  void parse_rare(std::string_view keyword) {
    const auto mark = [&](ObjMark::Kind kind) {
      chunk_.marks.push_back({kind, chunk_.face_corner_counts.size(), std::string(cursor_.rest_of_line())});
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
      if (chunk_.unknown_lines++ == 0) chunk_.first_unknown_line = 1 + chunk_.lines_before + cursor_.lines_passed();
    }
  }

  const Reading& reading_;
  ObjChunk& chunk_;
  TextCursor cursor_;
  const char* line_ = nullptr;
};

bool is_joined(std::string_view text, std::size_t newline) {
  const std::string_view before = text.substr(0, newline);
  return before.ends_with("\\") || before.ends_with("\\\r");
}

}  // namespace

void ObjSplitter::fetch(std::size_t end) {
  fetched_ = std::min(end, text_.size());
  if (reading_.fetch) reading_.fetch(text_.data() + fetched_);
}

/// The place after the first line end from there on that no backslash continues; else the end of the text.
std::size_t ObjSplitter::line_end_from(std::size_t place) {
  while (true) {
    const std::size_t newline = text_.substr(0, fetched_).find('\n', place);
    if (newline == std::string_view::npos) {
      if (fetched_ == text_.size()) return fetched_;
      place = fetched_;
      fetch(fetched_ + kChunkBytes);
    } else if (!is_joined(text_, newline)) {
      return newline + 1;
    } else {
      place = newline + 1;
    }
  }
}

ObjChunk ObjSplitter::next() {
  if (begin_ == text_.size()) return {};
  // A little more than the chunk is fetched, since the line at its end usually ends soon after.
  constexpr std::size_t kLineBytes = 4096;
  fetch(std::max(fetched_, begin_ + kChunkBytes + kLineBytes));
  const std::size_t end = line_end_from(std::min(begin_ + kChunkBytes, text_.size()));
  if (end - begin_ > kMaxObjChunkBytes) {
    refuse_byte(reading_, begin_, fmt::format("line of {} bytes, limit {}", end - begin_, kMaxObjChunkBytes));
  }
  ObjChunk chunk{.text = text_.substr(begin_, end - begin_), .lines_before = lines_before_};
  lines_before_ += std::count(chunk.text.begin(), chunk.text.end(), '\n');
  begin_ = end;
  return chunk;
}

void parse_obj_chunk(const Reading& reading, ObjChunk& chunk) {
  const Reading piece{.file = reading.file,
                      .bytes = chunk.text,
                      .options = reading.options,
                      .report = reading.report,
                      .lines_before = chunk.lines_before};
  // A typical line has 25 bytes; half are vertices in clouds, a third in closed meshes.
  chunk.vertices.reserve(chunk.text.size() / 75);
  chunk.corners.reserve(chunk.text.size() / 12);
  ChunkParser(piece, chunk).parse();
  chunk.vertices.shrink_to_fit();
  chunk.corners.shrink_to_fit();
  chunk.face_corner_counts.shrink_to_fit();
  chunk.face_lines.shrink_to_fit();
  if (reading.give_back) reading.give_back(chunk.text);
  chunk.text = {};
}

}  // namespace collided::engine
