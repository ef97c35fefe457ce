#include "server/intake/readers/implicit_lines.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace collided::engine {

ImplicitSurface rest_as_implicit_surface(TextCursor& cursor) {
  cursor.at_line_end();  // steps over the blanks
  const char* const begin = cursor.place();
  const char* end = begin;
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) end = word.data() + word.size();
  try {
    return read_implicit_surface({begin, static_cast<std::size_t>(end - begin)});
  } catch (const std::invalid_argument& wrong) { cursor.complain(fmt::format("polynomial, {}", wrong.what())); }
}

std::optional<ImplicitSurface> find_implicit_surface(const Reading& reading, std::string_view name) {
  TextCursor cursor(reading, {reading.begin(), reading.bytes.size()}, TextCursor::LineEnd::newline_or_comment, true);
  for (; cursor.find_word(); cursor.next_line()) {
    if (cursor.word() != name) continue;
    const std::string_view kind = cursor.word();
    if (kind == "implicit") return rest_as_implicit_surface(cursor);
    cursor.complain(fmt::format("{} is of kind {}, not implicit", in_quotes(name), in_quotes(kind)));
  }
  return std::nullopt;
}

}  // namespace collided::engine
