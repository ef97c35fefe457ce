#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/intake/readers/polynomial_text.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {

/// The implicit surface of a .surfaces line, NAME implicit POLYNOMIAL [in X Y Z X Y Z], from behind the word 'implicit' to
/// the line's end. Throws a LoadError with the line, and the column from there on.
ImplicitSurface rest_as_implicit_surface(TextCursor& cursor);

/// That of the name in a .surfaces file; nothing where no line has it. Throws a LoadError for a line of that name that is of
/// another kind or no polynomial.
std::optional<ImplicitSurface> find_implicit_surface(const Reading& reading, std::string_view name);

}  // namespace collided::engine
