#pragma once

/// Of two objects: whether one lies wholly within the other's closed mesh.
#pragma GCC visibility push(default)

namespace collided {

enum class Containment { none, a_in_b, b_in_a };

}  // namespace collided

#pragma GCC visibility pop
