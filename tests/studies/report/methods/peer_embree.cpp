// Embree answers rays: peer_embree PROBLEM ANSWERS default|robust
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "tests/studies/report/methods/peer.hpp"

namespace {

using namespace collided::engine;
using namespace collided;

RTCScene scene_of(RTCDevice device, const TriangleMesh& mesh, bool robust) {
  const RTCScene scene = rtcNewScene(device);
  if (robust) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
  for (const Vec3& vertex : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(vertex[axis]);
  }
  auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), mesh.triangles.size()));
  for (const TriangleCorners& t : mesh.triangles) corners = std::copy(t.begin(), t.end(), corners);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

report::PeerAnswer shoot(RTCScene scene, const double* q) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit hit{};
  float* numbers[] = {&hit.ray.org_x, &hit.ray.org_y, &hit.ray.org_z, &hit.ray.dir_x, &hit.ray.dir_y, &hit.ray.dir_z};
  for (int i = 0; i < 6; ++i) *numbers[i] = static_cast<float>(q[i]);
  hit.ray.tfar = std::numeric_limits<float>::infinity();
  hit.ray.mask = 0xffffffffu;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {1, static_cast<double>(hit.ray.tfar) * std::sqrt(q[3] * q[3] + q[4] * q[4] + q[5] * q[5])};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const report::PeerProblem problem = report::read_problem(argv[1]);
  if (problem.kind != "ray") return 3;
  const RTCDevice device = rtcNewDevice("threads=1");
  const RTCScene scene = scene_of(device, problem.mesh, std::strcmp(argv[3], "robust") == 0);
  return report::serve_peer(problem, argv[2], [scene](const double* q) { return shoot(scene, q); });
}
