#include "tests/accuracy/leaks/peers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "tests/accuracy/census/table.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/random_shapes.hpp"

#ifdef COLLIDED_EMBREE
#include <embree3/rtcore.h>
#endif
#ifdef COLLIDED_FCL
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#include <fcl/narrowphase/distance.h>
#pragma GCC diagnostic pop
#endif

namespace collided::census {
using namespace engine;

#ifdef COLLIDED_EMBREE
namespace {

class EmbreeMesh {
 public:
  EmbreeMesh(const TriangleMesh& mesh, bool robust) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    if (robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
    for (const Vec3& v : mesh.vertices) {
      for (int k = 0; k < 3; ++k) *vertex++ = static_cast<float>(v[k]);
    }
    auto* corner = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
    for (const TriangleCorners& t : mesh.triangles) corner = std::copy(t.begin(), t.end(), corner);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~EmbreeMesh() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeMesh(const EmbreeMesh&) = delete;
  EmbreeMesh& operator=(const EmbreeMesh&) = delete;

  bool meets(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit hit{};
    hit.ray.org_x = static_cast<float>(ray.origin[0]);
    hit.ray.org_y = static_cast<float>(ray.origin[1]);
    hit.ray.org_z = static_cast<float>(ray.origin[2]);
    hit.ray.dir_x = static_cast<float>(ray.direction[0]);
    hit.ray.dir_y = static_cast<float>(ray.direction[1]);
    hit.ray.dir_z = static_cast<float>(ray.direction[2]);
    hit.ray.tfar = std::numeric_limits<float>::infinity();
    hit.ray.mask = 0xffffffffu;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &hit);
    return hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

std::vector<Peer> closed_mesh_peers(const TriangleMesh& mesh) {
  const auto plain = std::make_shared<EmbreeMesh>(mesh, false);
  const auto robust = std::make_shared<EmbreeMesh>(mesh, true);
  return {{"embree", [plain](const Ray& ray) { return plain->meets(ray); }},
          {"embree_robust", [robust](const Ray& ray) { return robust->meets(ray); }}};
}
#else
std::vector<Peer> closed_mesh_peers(const TriangleMesh&) { return {}; }
#endif

#ifdef COLLIDED_FCL
namespace {

fcl::Transform3d placed(const Box& box) {
  fcl::Transform3d at = fcl::Transform3d::Identity();
  at.linear() = box.axes;
  at.translation() = box.center;
  return at;
}

double fcl_distance(const Box& a, const Box& b) {
  const fcl::Boxd shape_a(2 * a.half_m);
  const fcl::Boxd shape_b(2 * b.half_m);
  fcl::DistanceRequestd request;
  request.enable_signed_distance = false;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::DistanceResultd result;
  return fcl::distance(&shape_a, placed(a), &shape_b, placed(b), request, result);
}

}  // namespace

void count_fcl_distances(Table& table, int count, std::mt19937_64& random) {
  oracle::RandomShapes shapes(random, oracle::Family::random);
  Row& row = table.row("distance_box_box", "micrometre", "fcl");
  const std::size_t index = table.rows().size() - 1;
  while (row.count < static_cast<std::uint64_t>(count)) {
    Box a = shapes.box();
    Box b = shapes.box();
    for (Box* box : {&a, &b}) {
      box->center *= 2e-6;
      box->half_m *= 1e-6;
    }
    const double truth = static_cast<double>(oracle::distance(oracle::figure(a), oracle::figure(b)));
    if (truth <= 0) continue;
    ++row.count;
    row.missed += std::abs(fcl_distance(a, b) - truth) > 0.01 * truth;
  }
  table.print(index);
}
#else
void count_fcl_distances(Table&, int, std::mt19937_64&) {}
#endif

}  // namespace collided::census
