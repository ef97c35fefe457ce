#pragma once

#include <string_view>

#include "server/geometry/implicit_surface.hpp"

namespace collided::engine {

/// A surface as its author writes it: POLYNOMIAL [in X Y Z X Y Z], the polynomial in x, y, z with numbers, + - * ^ and
/// parentheses, the box by its lowest and highest corner; without a box it has no end. "x^2+y^2+z^2-1 in 0 -1 -1 1 1 1".
///
/// ^ takes a whole number from 0 to 8 and binds tighter than a sign: -x^2 is -(x^2). Numbers are read as the nearest
/// doubles; of those, nothing is rounded any more.
/// error  std::invalid_argument with the column, what was found there and what is allowed: syntax, a number beyond the
///        doubles, degree above 8, more than 1,000 steps, 64 parentheses deep, a constant, an empty box
ImplicitSurface read_implicit_surface(std::string_view text);

/// Bytes of such a text.
inline constexpr std::size_t kMaxPolynomialBytes = 1 << 16;

}  // namespace collided::engine
