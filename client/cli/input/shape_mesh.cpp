#include "client/cli/input/shape_mesh.hpp"

#include <charconv>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/files_program.hpp"

namespace collided::cli {
namespace {

/// The next word of the text as a number.
template <class Number>
Number take_number(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) throw Failure(Exit::refused, fmt::format("no number: '{}'", text.substr(0, 40)));
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

template <class Number>
std::array<Number, 3> take_three(std::string_view line) {
  std::array<Number, 3> three;
  for (Number& number : three) number = take_number<Number>(line);
  return three;
}

}  // namespace

bool is_mesh_kind(const std::string& kind) { return kind == "mesh" || kind == "hull"; }

MeshShape parse_triangles(std::string_view text) {
  MeshShape mesh;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with("v ")) {
      const std::array<double, 3> at = take_three<double>(line.substr(2));
      mesh.vertices.emplace_back(at[0], at[1], at[2]);
    } else if (line.starts_with("t ")) {
      mesh.triangles.push_back(take_three<std::uint32_t>(line.substr(2)));
    }
  }
  return mesh;
}

ShapePart read_mesh_shape(const std::vector<std::string>& words, const MeshReading& reading, const Io& io) {
  if (words.size() != 2)
    throw bad_use(fmt::format("{} takes a file", words[0]), "collide check FILE says what it holds");
  std::vector<std::string> asked{"triangles", words[1]};
  if (!reading.unit.empty()) asked.insert(asked.end(), {"--unit", reading.unit});
  if (!reading.up.empty()) asked.insert(asked.end(), {"--up", reading.up});
  MeshShape mesh = parse_triangles(files_program_output(io, std::move(asked)));
  if (words[0] == "mesh") return mesh;
  return HullShape{std::move(mesh.vertices)};
}

}  // namespace collided::cli
