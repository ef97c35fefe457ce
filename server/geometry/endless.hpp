#pragma once

#include <algorithm>
#include <variant>

#include "server/geometry/shape.hpp"

namespace collided::engine {

/// True if a part of the shape is infinite: a half-space. Such a shape cannot move.
inline bool is_endless(const Shape& shape) {
  return std::any_of(shape.primitives.begin(), shape.primitives.end(),
                     [](const Primitive& primitive) { return std::holds_alternative<HalfSpace>(primitive); });
}

}  // namespace collided::engine
