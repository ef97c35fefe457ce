#pragma once

#include <string_view>

#include "server/geometry/implicit_surface.hpp"

namespace collided::engine {

/// Reads the surface on which a polynomial is zero, written as POLYNOMIAL [in X Y Z X Y Z]. The polynomial is in x, y,
/// z, with numbers, + - * ^ and parentheses. The box that bounds it has a lowest and a highest corner; without one the
/// surface is unbounded. Example: "x^2+y^2+z^2-1 in 0 -1 -1 1 1 1".
///
/// An exponent is a whole number from 0 to 8 and binds tighter than a sign: -x^2 is -(x^2). Numbers are read as the
/// nearest doubles; nothing else is rounded.
/// throws  std::invalid_argument with the column, the text found and the text allowed: for wrong syntax, a number
///         beyond the range of double, a degree above 8, more than 1,000 steps, parentheses nested 64 deep, a constant,
///         an empty box
ImplicitSurface read_implicit_surface(std::string_view text);

/// Most bytes of such a text.
inline constexpr std::size_t kMaxPolynomialBytes = 1 << 16;

}  // namespace collided::engine
