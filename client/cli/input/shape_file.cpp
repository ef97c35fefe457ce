#include "client/cli/input/shape_file.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/line_reader.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/shape_mesh.hpp"
#include "client/cli/input/shape_text.hpp"

namespace collided::cli {
namespace {

using Row = std::vector<double>;

std::vector<std::string> words_of(const std::string& line) {
  constexpr const char* kBlanks = " \t\r,;";
  std::vector<std::string> words;
  const std::string text = line.substr(0, line.find('#'));
  for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string::npos;) {
    const std::size_t end = text.find_first_of(kBlanks, at);
    words.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(kBlanks, end);
  }
  return words;
}

/// Reads rows with equal counts of finite numbers.
std::vector<Row> read_rows(const std::string& path, int in) {
  const InputFile file(path, in);
  LineReader reader(file.descriptor());
  std::vector<Row> rows;
  std::string line;
  while (reader.next(line)) {
    const std::vector<std::string> words = words_of(line);
    if (words.empty()) continue;
    Row row;
    try {
      for (const std::string& word : words) row.push_back(parse_finite(word, Measure::length));
    } catch (const Failure& failure) {
      throw bad_use(fmt::format("{}: line {}: {}", file.name(), reader.line_number(), failure.what()), failure.hint);
    }
    if (!rows.empty() && row.size() != rows.front().size()) {
      throw bad_use(fmt::format("{}: line {}: {} numbers; the lines before have {}", file.name(), reader.line_number(),
                                row.size(), rows.front().size()));
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw bad_use(fmt::format("{}: no numbers", file.name()));
  return rows;
}

std::vector<Vec3> read_points(const std::string& path, int in) {
  std::vector<Vec3> points;
  for (const Row& row : read_rows(path, in)) {
    if (row.size() != 3) throw bad_use(fmt::format("{}: {} numbers a line; a point takes 3", path, row.size()));
    points.emplace_back(row[0], row[1], row[2]);
  }
  return points;
}

HeightFieldShape read_heights(const std::string& path, double dx, double dy, int in) {
  HeightFieldShape field;
  field.spacing_x_m = dx;
  field.spacing_y_m = dy;
  for (const Row& row : read_rows(path, in)) {
    field.columns = static_cast<std::uint32_t>(row.size());
    field.heights_m.insert(field.heights_m.end(), row.begin(), row.end());
  }
  return field;
}

/// Whether this kind of shape is read from a file of numbers.
bool is_numbers_kind(const std::string& kind) { return kind == "points" || kind == "polyline" || kind == "heights"; }

ShapePart read_numbers_shape(const std::vector<std::string>& words, int in) {
  const std::string& kind = words[0];
  const bool heights = kind == "heights";
  const std::size_t most = heights ? 4 : 3;
  if (words.size() < 3 || words.size() > most) {
    throw bad_use(
        fmt::format("{} takes {}", kind, heights ? "FILE and the spacings DX and DY (DX)" : "FILE and a radius"));
  }
  std::vector<double> numbers;
  for (std::size_t i = 2; i < words.size(); ++i) {
    numbers.push_back(parse_finite(words[i], Measure::length));
    if (numbers.back() < 0) throw bad_use(fmt::format("{} {}: must not be below 0", kind, words[i]));
  }
  if (heights) return read_heights(words[1], numbers[0], numbers.back(), in);
  if (kind == "points") return CloudShape{.points = read_points(words[1], in), .radius_m = numbers[0]};
  return PolylineShape{.points = read_points(words[1], in), .radius_m = numbers[0]};
}

}  // namespace

ShapePart shape_of_words(std::vector<std::string> words, const Io& io, const MeshReading& reading) {
  if (const std::size_t colon = words[0].find(':'); colon != std::string::npos) {
    words.insert(words.begin() + 1, words[0].substr(colon + 1));
    words[0].resize(colon);
  }
  const bool is_asked = !reading.unit.empty() || !reading.up.empty();
  if (is_asked && !is_mesh_kind(words[0])) throw bad_use("--unit and --up are for mesh FILE and hull FILE");
  if (is_numbers_kind(words[0])) return read_numbers_shape(words, io.in);
  if (is_mesh_kind(words[0])) return read_mesh_shape(words, reading, io);
  return make_shape(words[0], parse_numbers({words.begin() + 1, words.end()}, Measure::length));
}

ShapePart shape_of_text(const std::string& text, const Io& io) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  if (colon == std::string::npos || !(is_numbers_kind(kind) || is_mesh_kind(kind))) return parse_shape(text);
  std::vector<std::string> words{kind};
  for (std::size_t begin = colon + 1; begin <= text.size();) {
    const std::size_t comma = is_mesh_kind(kind) ? text.size() : std::min(text.find(',', begin), text.size());
    words.push_back(text.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return shape_of_words(words, io);
}

}  // namespace collided::cli
