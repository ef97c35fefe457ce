#pragma once

#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// One object of a pair, in the form that walks over pairs need: a part of a scene gets a mesh of its own, indexed
/// here.
struct PairObject {
  ObjectInfo own;
  Placed placed;
  Aabb reach;             // bounds of every pose it may have
  bool is_stale = false;  // its publisher is lost, and its pose within reach is unknown

  /// The object in the snapshot, which must outlive this.
  PairObject(const Snapshot& snapshot, ObjectId id, Deadline& deadline);
  PairObject(const PairObject&) = delete;
  PairObject& operator=(const PairObject&) = delete;

  /// Moves it to another frame, as if placed between two poses. Not for a part of a scene.
  void place_at(const Frame& elsewhere);
};

}  // namespace collided::engine
