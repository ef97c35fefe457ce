#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "server/geometry/ray.hpp"
#include "tests/studies/bench/peers/embree_scene.hpp"

namespace collided::bench {
using namespace engine;

inline constexpr std::uint32_t kNone = 0xffffffffu;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The nearest triangle that a ray meets, kNone for none, and where along it in lengths of its direction.
struct Answer {
  std::uint32_t triangle = kNone;
  double s = kInfinity;
};

inline double wall_seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// One mesh in Embree, asked a ray, eight or many at a time; rays and answers in float.
class Embree {
 public:
  Embree(const TriangleMesh& mesh, RTCSceneFlags flags)
      : device_(rtcNewDevice(nullptr)), scene_(embree_scene(device_, mesh, flags)) {
    build_s = wall_seconds([&] { rtcCommitScene(scene_); });
  }
  ~Embree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  Answer shoot(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit hit = question(ray);
    rtcIntersect1(scene_, &context, &hit);
    return answer(hit);
  }
  bool occluded(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay asked = question(ray).ray;
    rtcOccluded1(scene_, &context, &asked);
    return asked.tfar < 0;
  }
  /// Eight at a time, told that they are coherent.
  void shoot_packets(std::span<const Ray> rays, Answer* answers) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (std::size_t begin = 0; begin < rays.size(); begin += 8) {
      const std::size_t count = std::min<std::size_t>(8, rays.size() - begin);
      alignas(32) int valid[8] = {};
      alignas(32) RTCRayHit8 packet;
      for (std::size_t i = 0; i < count; ++i) put(question(rays[begin + i]), i, valid, packet);
      rtcIntersect8(valid, scene_, &context, &packet);
      for (std::size_t i = 0; i < count; ++i) {
        const bool is_hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
        answers[begin + i] = is_hit ? Answer{packet.hit.primID[i], static_cast<double>(packet.ray.tfar[i])} : Answer{};
      }
    }
  }
  void shoot_stream(std::span<const Ray> rays, Answer* answers) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    stream_.clear();
    for (const Ray& ray : rays) stream_.push_back(question(ray));
    rtcIntersect1M(scene_, &context, stream_.data(), static_cast<unsigned>(stream_.size()), sizeof(RTCRayHit));
    for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = answer(stream_[i]);
  }

  double build_s = 0;

 private:
  static void put(const RTCRayHit& one, std::size_t i, int* valid, RTCRayHit8& packet) {
    valid[i] = -1;
    packet.ray.org_x[i] = one.ray.org_x;
    packet.ray.org_y[i] = one.ray.org_y;
    packet.ray.org_z[i] = one.ray.org_z;
    packet.ray.dir_x[i] = one.ray.dir_x;
    packet.ray.dir_y[i] = one.ray.dir_y;
    packet.ray.dir_z[i] = one.ray.dir_z;
    packet.ray.tnear[i] = 0;
    packet.ray.tfar[i] = one.ray.tfar;
    packet.ray.time[i] = 0;
    packet.ray.mask[i] = one.ray.mask;
    packet.ray.id[i] = 0;
    packet.ray.flags[i] = 0;
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  static RTCRayHit question(const Ray& ray) {
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
    return hit;
  }
  static Answer answer(const RTCRayHit& hit) {
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {hit.hit.primID, static_cast<double>(hit.ray.tfar)};
  }

  RTCDevice device_;
  RTCScene scene_;
  std::vector<RTCRayHit> stream_;
};

}  // namespace collided::bench
