#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// What an object is made of, in its own frame: solid primitives and at most one mesh. One primitive is a plain sphere,
/// box and so on; several make a compound.
struct Shape {
  std::vector<Primitive> primitives;
  std::shared_ptr<const TriangleMesh> mesh;  // may be null
  bool is_unknown = false;                   // what is in it is not known

  bool empty() const { return primitives.empty() && !mesh; }
};

/// Which objects may meet: two are a pair if each one's layers include a bit of the other's mask, unless they share a
/// group other than 0 (the links of one robot, the bones of one body).
struct Filter {
  std::uint32_t layers = 1;
  std::uint32_t mask = 0xffffffff;
  std::uint32_t group = 0;
};

/// Symmetric in a and b.
inline bool may_meet(const Filter& a, const Filter& b) {
  return (a.layers & b.mask) != 0 && (b.layers & a.mask) != 0 && (a.group == 0 || a.group != b.group);
}

}  // namespace collided::engine
