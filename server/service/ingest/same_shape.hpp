#pragma once

#include "server/geometry/shape.hpp"

namespace collided::engine::service {

/// Whether two shapes are the same to the last bit, part by part in the same order. A mesh is compared by its vertices
/// and triangles, at any address.
bool is_same_shape(const Shape& a, const Shape& b);

}  // namespace collided::engine::service
