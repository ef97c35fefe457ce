#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// The geometry of an object, in its own frame: solid primitives and at most one mesh. One primitive is a plain sphere,
/// box and so on; several form a compound.
struct Shape {
  std::vector<Primitive> primitives;
  std::shared_ptr<const TriangleMesh> mesh;  // may be null
  bool is_unknown = false;                   // its content is unknown

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

/// Two numbers in either order.
struct NumberPair {
  std::uint32_t low;
  std::uint32_t high;

  NumberPair(std::uint32_t a, std::uint32_t b) : low(std::min(a, b)), high(std::max(a, b)) {}
  auto operator<=>(const NumberPair&) const = default;
};

/// Pairs of one scene's objects that may touch, by the objects' numbers: their contacts are ignored. It belongs to one
/// loading of a scene, so the same robot loaded twice collides with itself. Immutable.
class AllowedPairs {
 public:
  /// Allows every pair.
  AllowedPairs() : is_every_pair_(true) {}
  explicit AllowedPairs(std::vector<NumberPair> pairs) : pairs_(std::move(pairs)) {
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  }

  bool is_every_pair() const { return is_every_pair_; }
  const std::vector<NumberPair>& pairs() const { return pairs_; }
  bool contains(std::uint32_t a, std::uint32_t b) const {
    return is_every_pair_ || std::binary_search(pairs_.begin(), pairs_.end(), NumberPair(a, b));
  }

 private:
  bool is_every_pair_ = false;
  std::vector<NumberPair> pairs_;  // ascending, each once
};

}  // namespace collided::engine
