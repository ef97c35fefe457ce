#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/intake/readers/polynomial_text.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {

/// Reads the rest of a .surfaces line, NAME implicit POLYNOMIAL [in X Y Z X Y Z], after the word 'implicit'. Throws a
/// LoadError that names the line, and the column within the rest.
ImplicitSurface rest_as_implicit_surface(TextCursor& cursor);

/// The implicit surface with a given name in a .surfaces file; nothing if no line has that name. Throws a LoadError if
/// the line of that name is of another kind or has no valid polynomial.
std::optional<ImplicitSurface> find_implicit_surface(const Reading& reading, std::string_view name);

}  // namespace collided::engine
