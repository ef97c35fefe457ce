#pragma once

#include <embree3/rtcore.h>

#include <algorithm>

#include "server/geometry/mesh.hpp"

namespace collided::bench {
using namespace engine;

/// A mesh as Embree has it: its own copy in single precision. Not committed.
inline RTCScene embree_scene(RTCDevice device, const TriangleMesh& mesh, RTCSceneFlags flags) {
  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, flags);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
  for (const Vec3& vertex : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(vertex[axis]);
  }
  auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  for (const TriangleCorners& triangle : mesh.triangles) corners = std::copy(triangle.begin(), triangle.end(), corners);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  return scene;
}

}  // namespace collided::bench
