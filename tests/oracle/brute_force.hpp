#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "server/world/objects/snapshot.hpp"
#include "server/world/query/query.hpp"

namespace collided::oracle {
using namespace engine;

/// Every part of every object, in world coordinates: what the index is an index of.
struct Part {
  ObjectId object = 0;
  std::uint32_t triangle = kNoTriangle;
  std::variant<Sphere, Box, Capsule, Cylinder, Cone, Ellipsoid, Hull, HalfSpace, Triangle> shape;
  std::variant<Triangle, Primitive> own;    // in its object's frame
  std::shared_ptr<const Frame> frame = {};  // null: of a scene
  const Pose* pose = nullptr;               // that the frame was made of; null: of a scene, or none was given

  /// How far it may be from where its pose has it, looked at from the point and so far beyond it.
  double placing_m(const Vec3& point, double beyond_m = 0) const;
};

std::vector<Part> all_parts(const Snapshot& snapshot);

/// The slow and sure twin of answer(): every part is tested, nothing is indexed, nothing is skipped.
/// Filters: the mask only.
void answer(const Snapshot& snapshot, const Questions& questions, Answers& answers);

/// The pairs of objects (lower id first) that touch now and may meet, at least one of them moving.
std::set<std::pair<ObjectId, ObjectId>> touching_pairs(const Snapshot& snapshot);

}  // namespace collided::oracle
