#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"
#include "tests/oracle/moeller.hpp"

namespace collided::oracle {
using namespace engine;

/// Two objects that meet, lower number first, and their triangles that do.
struct MeetingPair {
  std::array<std::uint32_t, 2> object;
  std::vector<std::array<std::uint32_t, 2>> triangles;
};

/// The homework's simple prototype, a baseline: every pair of objects by bounding spheres (met where the centres are
/// nearer than the sum of radii), then every pair of their triangles by Moeller's test in doubles. No index, nothing kept.
class SimplePrototype {
 public:
  explicit SimplePrototype(double epsilon = 0) : test_(epsilon) {}

  void add(std::shared_ptr<const TriangleMesh> mesh);
  void move(std::size_t object, const Frame& frame) { objects_[object].frame = frame; }
  /// Ordered by objects and triangles.
  std::vector<MeetingPair> collide();
  std::size_t object_candidates() const { return object_candidates_; }
  std::size_t triangle_candidates() const { return triangle_candidates_; }

 private:
  using Corners = Moeller<double>::Corners;
  struct Object {
    std::shared_ptr<const TriangleMesh> mesh;
    double radius_m = 0;  // about its own origin
    Frame frame;
    std::vector<Corners> placed;  // in this frame of the scene, once it was needed
    bool is_placed = false;
  };
  const std::vector<Corners>& placed(Object& object) const;

  Moeller<double> test_;
  std::vector<Object> objects_;
  std::size_t object_candidates_ = 0;
  std::size_t triangle_candidates_ = 0;
};

}  // namespace collided::oracle
