#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <collided/client.hpp>

namespace collided::draw {

/// Normals for shading: on a surface those of the triangles about each corner, mixed over the triangle, so that what
/// stands for something round looks round; triangles beyond a crease have no part in it. Elsewhere the hit's own.
/// source  Phong, "Illumination for Computer Generated Pictures", 1975
class ShadingNormals {
 public:
  /// shown  outlives this; surfaces are looked at when one of their triangles is hit first
  ShadingNormals(const ShownObjects& shown, double crease_cosine);

  /// Number in ShownObjects; kNobody: the object came after it.
  static constexpr std::uint32_t kNobody = 0xffffffff;
  std::uint32_t object_of(const Hit& hit) const;

  /// Of unit length, in the world; on either side of the surface.
  Vec3 normal(const Hit& hit);

 private:
  struct Corners {
    std::vector<std::uint32_t> point_of;  // of each vertex the first at its place
    std::vector<std::uint32_t> first;     // of each point its first triangle in `triangles`; one more for the end
    std::vector<std::uint32_t> triangles;
    std::vector<Vec3> normals;  // of each triangle, as long as twice its area
  };
  const Corners& corners_of(const Surface& surface);

  const ShownObjects& shown_;
  double crease_cosine_;
  std::unordered_map<std::uint64_t, std::uint32_t> object_of_id_;
  std::unordered_map<const Surface*, Corners> corners_;
};

}  // namespace collided::draw
