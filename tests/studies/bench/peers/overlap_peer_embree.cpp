#include <cmath>

#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/peers/embree_scene.hpp"
#include "tests/studies/bench/peers/overlap_peers.hpp"
#include "tests/studies/bench/plain_triangle.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using Float3 = Three<float>;

Float3 single(const Vec3& v) { return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])}; }

/// Its point query, with the triangle tests in its callback, as its tutorial has it.
class Embree final : public OverlapPeer {
 public:
  explicit Embree(const TriangleMesh& mesh)
      : mesh_(mesh), device_(rtcNewDevice(nullptr)), scene_(embree_scene(device_, mesh, RTC_SCENE_FLAG_NONE)) {
    for (const Vec3& vertex : mesh.vertices) vertices_.push_back(single(vertex));
    const double start = thread_seconds();
    rtcCommitScene(scene_);
    build_s = thread_seconds() - start;
  }
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  std::string name() const override { return "Embree point query"; }

  long sphere(const Vec3& center, double radius_m, bool any) override {
    Ask ask{*this, single(center), {}, static_cast<float>(radius_m * radius_m), any, 0};
    query(ask, static_cast<float>(radius_m), [](RTCPointQueryFunctionArguments* at) {
      auto& a = *static_cast<Ask*>(at->userPtr);
      return a.met(at, a.square_to(at->primID) <= a.limit2);
    });
    return ask.count;
  }
  long box(const Vec3& center, const Vec3& half_m, bool any) override {
    Ask ask{*this, single(center), single(half_m), 0, any, 0};
    query(ask, static_cast<float>(half_m.norm()) * (1 + 1e-6f), [](RTCPointQueryFunctionArguments* at) {
      auto& a = *static_cast<Ask*>(at->userPtr);
      const auto [p, q, r] = a.corners(at->primID);
      return a.met(at, box_meets(a.center, a.half, p, q, r));
    });
    return ask.count;
  }
  double closest_m(const Vec3& point) override {
    Ask ask{*this, single(point), {}, std::numeric_limits<float>::infinity(), false, 0};
    query(ask, std::numeric_limits<float>::infinity(), [](RTCPointQueryFunctionArguments* at) {
      auto& a = *static_cast<Ask*>(at->userPtr);
      const float square = a.square_to(at->primID);
      if (square >= a.limit2) return false;
      a.limit2 = square;
      at->query->radius = std::sqrt(square);
      return true;
    });
    return std::sqrt(static_cast<double>(ask.limit2));
  }

 private:
  struct Ask {
    Embree& owner;
    Float3 center;
    Float3 half;
    float limit2;
    bool any;
    long count;

    std::array<Float3, 3> corners(unsigned triangle) const {
      const TriangleCorners& t = owner.mesh_.triangles[triangle];
      return {owner.vertices_[t[0]], owner.vertices_[t[1]], owner.vertices_[t[2]]};
    }
    float square_to(unsigned triangle) const {
      const auto [a, b, c] = corners(triangle);
      return squared_distance(center, a, b, c);
    }
    /// True: the radius has changed; 0 ends the search but for what holds the very centre.
    bool met(RTCPointQueryFunctionArguments* at, bool yes) {
      if (!yes || (any && count > 0)) return false;
      ++count;
      if (!any) return false;
      at->query->radius = 0;
      return true;
    }
  };
  void query(Ask& ask, float radius, RTCPointQueryFunction visit) {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery asked{ask.center.x, ask.center.y, ask.center.z, 0, radius};
    rtcPointQuery(scene_, &asked, &context, visit, &ask);
  }

  const TriangleMesh& mesh_;
  std::vector<Float3> vertices_;
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

std::unique_ptr<OverlapPeer> embree_peer(const TriangleMesh& mesh) { return std::make_unique<Embree>(mesh); }

}  // namespace collided::bench
