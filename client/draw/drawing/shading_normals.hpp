#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <collided/client.hpp>

namespace collided::draw {

/// Normals for shading. On a surface they are interpolated between the corners of a triangle, where each is the mean
/// over the triangles there, except those beyond a crease, so that meshes of round things look round. Elsewhere it is
/// the hit's normal. One thread.
/// source  Phong, "Illumination for Computer Generated Pictures", 1975
class ShadingNormals {
 public:
  /// shown  must outlive this. A surface is prepared when one of its triangles is first hit
  ShadingNormals(const ShownObjects& shown, double crease_cosine);

  /// The index in ShownObjects of the hit object; kNobody: it was added later.
  static constexpr std::uint32_t kNobody = 0xffffffff;
  std::uint32_t object_of(const Hit& hit) const;

  /// The unit normal in the world, on either side of the surface.
  Vec3 normal(const Hit& hit);

 private:
  struct Corners {
    std::vector<std::uint32_t> point_of;  // by vertex: the first vertex at its place
    std::vector<std::uint32_t> first;     // by point: index of its first triangle in `triangles`; one more for the end
    std::vector<std::uint32_t> triangles;
    std::vector<Vec3> normals;  // by triangle: as long as twice its area
  };
  const Corners& corners_of(const Surface& surface);

  const ShownObjects& shown_;
  double crease_cosine_;
  std::unordered_map<std::uint64_t, std::uint32_t> object_of_id_;
  std::unordered_map<const Surface*, Corners> corners_;
};

}  // namespace collided::draw
