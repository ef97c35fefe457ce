#pragma once

#include "collided/shapes.hpp"

namespace collided::client {

/// How far an object reaches from the origin of its frame, however it is turned: metres, at least the truth, infinite for a
/// half-space.
///
/// scale    as in ObjectOptions
/// threads  pure
double reach_of(const Shape& shape, const Vec3& scale);

}  // namespace collided::client
