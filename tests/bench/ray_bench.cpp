// Closest hits along single rays, one thread: our tree beside Embree's default, in turn in one run. A ratio is
// Embree's time over ours, median and range of the repeats; above 1 we are faster. "certainty" is the plain test's time
// over the exact one's in the same walk: what certainty costs.

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <span>

#include "server/broad_phase/bsp_tree.hpp"
#include "server/exact_phase/ray_cast.hpp"
#include "tests/bench/clock.hpp"
#include "tests/bench/obj.hpp"
#include "tests/oracle/plain_ray.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::bench {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr int kRepeats = 5;
constexpr std::size_t kStretch = 8192;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Answer {
  std::uint32_t triangle = kNone;
  double s = kInfinity;
};

/// Of this thread's processor time, so that a busy machine does not count.
double seconds(const std::function<void()>& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

double wall_seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// ---- ours

struct Closest {
  const Ray& ray;
  double direction_m;
  Answer best;
};

/// Every candidate decided exactly, as the product does it.
double keep_closest_exactly(void* context, std::uint32_t triangle, const Triangle& corners, double limit) {
  auto& closest = *static_cast<Closest*>(context);
  RayHit hit;
  if (!cast_ray(closest.ray, corners, hit).yes()) return limit;
  const double s = hit.distance_m / closest.direction_m;
  if (s < closest.best.s) closest.best = {triangle, s};
  return std::min(limit, (hit.distance_m + hit.distance_error_m) / closest.direction_m * (1 + 0x1p-50));
}

/// Every candidate decided in plain double: what the walk alone costs.
double keep_closest(void* context, std::uint32_t triangle, const Triangle& corners, double limit) {
  auto& closest = *static_cast<Closest*>(context);
  const std::optional<double> s = oracle::plain_ray(closest.ray, corners);
  if (!s || *s > limit) return limit;
  if (*s < closest.best.s) closest.best = {triangle, *s};
  return *s;
}

Answer shoot(const BspTree& tree, const TriangleMesh& mesh, const Ray& ray, BspTree::RayTriangle decide,
             WalkCost& cost) {
  Closest closest{ray, ray.direction.norm(), {}};
  tree.walk_ray(ray, kInfinity, 0, mesh, decide, &closest, cost);
  return closest.best;
}

/// A whole stretch at once, its walks in turn.
class Batch {
 public:
  void shoot(const BspTree& tree, const TriangleMesh& mesh, std::span<const Ray> rays, Answer* answers) {
    closest_.clear();
    tasks_.clear();
    closest_.reserve(rays.size());
    for (const Ray& ray : rays) {
      closest_.push_back({ray, ray.direction.norm(), {}});
      tasks_.push_back({&ray, kInfinity, &closest_.back(), &cost_});
    }
    tree.walk_rays(tasks_, mesh, keep_closest_exactly);
    for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = closest_[i].best;
  }

 private:
  std::vector<Closest> closest_;
  std::vector<BspTree::RayTask> tasks_;
  WalkCost cost_;
};

// ---- Embree

class Embree {
 public:
  explicit Embree(const TriangleMesh& mesh) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    for (const Vec3& vertex : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(vertex[axis]);
    }
    auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
    for (const TriangleCorners& triangle : mesh.triangles) corners = std::copy(triangle.begin(), triangle.end(), corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
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

// ---- rays; all coordinates are floats, so that both sides get the same question

Vec3 to_float(const Vec3& v) {
  Vec3 rounded;
  for (int axis = 0; axis < 3; ++axis) rounded[axis] = static_cast<double>(static_cast<float>(v[axis]));
  return rounded;
}

Vec3 on_sphere(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random);
  const double y = normal(random);
  return Vec3(x, y, normal(random)).normalized();
}

Aabb bounds_of(const TriangleMesh& mesh) {
  Aabb bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  return bounds;
}

std::vector<Ray> camera_rays(const TriangleMesh& mesh, int side) {
  const Aabb bounds = bounds_of(mesh);
  const Vec3 center = (bounds.low + bounds.high) / 2;
  const double size = (bounds.high - bounds.low).maxCoeff();
  const Vec3 eye = center + size * Vec3(0.55, -0.75, 0.45);
  const Vec3 forward = (center - eye).normalized();
  const Vec3 right = forward.cross(Vec3::UnitZ()).normalized();
  const Vec3 up = right.cross(forward);
  std::vector<Ray> rays;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double x = (column + 0.5) / side - 0.5;
      const double y = (row + 0.5) / side - 0.5;
      rays.push_back({to_float(eye), to_float(forward + x * right + y * up)});
    }
  }
  return rays;
}

/// From points of the surface into its outer half space: what a bounce or an occlusion test asks.
std::vector<Ray> surface_rays(const TriangleMesh& mesh, int count, std::mt19937_64& random) {
  std::vector<Ray> rays;
  const double offset = 1e-4 * (bounds_of(mesh).high - bounds_of(mesh).low).maxCoeff();
  while (static_cast<int>(rays.size()) < count) {
    const Triangle triangle = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const Vec3 normal = (triangle.b - triangle.a).cross(triangle.c - triangle.a).normalized();
    if (!normal.allFinite()) continue;
    const Vec3 direction = on_sphere(random);
    const Vec3 start = (triangle.a + triangle.b + triangle.c) / 3 + offset * normal;
    rays.push_back({to_float(start), to_float(direction.dot(normal) < 0 ? Vec3(-direction) : direction)});
  }
  return rays;
}

std::vector<Ray> random_rays(const TriangleMesh& mesh, int count, std::mt19937_64& random) {
  const Aabb bounds = bounds_of(mesh);
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const double x = part(random);
    const double y = part(random);
    const Vec3 where(x, y, part(random));
    rays.push_back({to_float(bounds.low + where.cwiseProduct(bounds.high - bounds.low)), to_float(on_sphere(random))});
  }
  return rays;
}

// ---- the comparison

Answer by_force(const TriangleMesh& mesh, const Ray& ray) {
  Answer best;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::optional<double> s = oracle::plain_ray(ray, mesh.triangle(i));
    if (s && *s < best.s) best = {i, *s};
  }
  return best;
}

bool same(const Answer& a, const Answer& b) {
  if (a.triangle == b.triangle) return true;
  return a.triangle != kNone && b.triangle != kNone && std::abs(a.s - b.s) <= 1e-5 * (std::abs(a.s) + std::abs(b.s));
}

struct Agreement {
  std::size_t equal = 0;
  std::size_t ours_right = 0;  // of the unequal ones that were looked at
  std::size_t looked_at = 0;
};

Agreement compare(const TriangleMesh& mesh, const std::vector<Ray>& rays, const std::vector<Answer>& ours,
                  const std::vector<Answer>& theirs) {
  constexpr std::size_t kMostForced = 50;
  Agreement agreement;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (same(ours[i], theirs[i])) {
      ++agreement.equal;
    } else if (agreement.looked_at < kMostForced) {
      ++agreement.looked_at;
      const Answer truth = by_force(mesh, rays[i]);
      agreement.ours_right += truth.triangle == ours[i].triangle || truth.s == ours[i].s ? 1 : 0;
    }
  }
  return agreement;
}

struct Ratio {
  std::array<double, kRepeats> of{};

  void print(const char* name) {
    std::sort(of.begin(), of.end());
    std::printf("%s %.2f [%.2f, %.2f]  ", name, of[kRepeats / 2], of.front(), of.back());
  }
};

void run(const char* kind, const BspTree& tree, Embree& embree, const TriangleMesh& mesh,
         const std::vector<Ray>& rays) {
  std::vector<Answer> ours(rays.size());
  std::vector<Answer> plain(rays.size());
  std::vector<Answer> theirs(rays.size());
  Ratio exact_ratio;
  Ratio plain_ratio;
  Ratio certainty_ratio;
  Ratio batch_ratio;
  Ratio stream_ratio;
  Batch batch;
  std::vector<Answer> batched(rays.size());
  double our_best = kInfinity;
  double their_best = kInfinity;
  WalkCost cost;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    cost = {};
    WalkCost unread;
    double our_s = 0;
    double plain_s = 0;
    double their_s = 0;
    double batch_s = 0;
    double stream_s = 0;
    // In turn in short stretches, so that whatever else the machine does falls on all.
    for (std::size_t begin = 0; begin < rays.size(); begin += kStretch) {
      const std::size_t end = std::min(begin + kStretch, rays.size());
      our_s += seconds([&] {
        for (std::size_t i = begin; i < end; ++i) ours[i] = shoot(tree, mesh, rays[i], keep_closest_exactly, cost);
      });
      their_s += seconds([&] {
        for (std::size_t i = begin; i < end; ++i) theirs[i] = embree.shoot(rays[i]);
      });
      plain_s += seconds([&] {
        for (std::size_t i = begin; i < end; ++i) plain[i] = shoot(tree, mesh, rays[i], keep_closest, unread);
      });
      const std::span<const Ray> stretch = std::span(rays).subspan(begin, end - begin);
      batch_s += seconds([&] { batch.shoot(tree, mesh, stretch, &batched[begin]); });
      stream_s += seconds([&] { embree.shoot_stream(stretch, &plain[begin]); });
    }
    exact_ratio.of[repeat] = their_s / our_s;
    plain_ratio.of[repeat] = their_s / plain_s;
    certainty_ratio.of[repeat] = plain_s / our_s;
    batch_ratio.of[repeat] = their_s / batch_s;
    stream_ratio.of[repeat] = stream_s / batch_s;
    if (!std::equal(ours.begin(), ours.end(), batched.begin(), [](const Answer& a, const Answer& b) {
          return a.triangle == b.triangle && a.s == b.s;
        })) {
      std::printf("  THE BATCH ANSWERS OTHERWISE\n");
    }
    our_best = std::min(our_best, our_s);
    their_best = std::min(their_best, their_s);
  }
  const auto count = static_cast<double>(rays.size());
  const Agreement agreement = compare(mesh, rays, ours, theirs);
  std::printf("  %-8s ", kind);
  exact_ratio.print("exact");
  plain_ratio.print("plain");
  certainty_ratio.print("certainty");
  batch_ratio.print("batch");
  stream_ratio.print("batch to stream");
  std::printf(
      "exact %.2f Mrays/s, Embree %.2f   nodes %.1f candidates %.2f a ray   answers equal %zu of %zu (of the others, "
      "ours confirmed by force: %zu of %zu)\n",
      count / our_best / 1e6, count / their_best / 1e6, cost.nodes / count, cost.candidates / count, agreement.equal,
      rays.size(), agreement.ours_right, agreement.looked_at);
}

void run_scene(const char* name, const TriangleMesh& mesh, int side, std::mt19937_64& random) {
  if (mesh.triangles.empty()) {
    std::printf("%s: not here, left out\n", name);
    return;
  }
  const BspTree tree = BspTree::build(mesh);
  Embree embree(mesh);
  const BspReport& report = tree.report();
  const auto count = static_cast<double>(mesh.triangles.size());
  const double mesh_bytes = static_cast<double>(mesh.vertices.size() * sizeof(Vec3)) / count + sizeof(TriangleCorners);
  std::printf("%s: %zu triangles, build %.2f s (Embree %.2f), %.1f bytes a triangle + mesh %.1f, depth %u, %.2f a leaf\n",
              name, mesh.triangles.size(), report.build_s, embree.build_s, static_cast<double>(report.bytes) / count,
              mesh_bytes, report.depth, static_cast<double>(report.references) / report.leaves);
  run("camera", tree, embree, mesh, camera_rays(mesh, side));
  run("surface", tree, embree, mesh, surface_rays(mesh, side * side, random));
  run("random", tree, embree, mesh, random_rays(mesh, side * side, random));
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  std::mt19937_64 random = oracle::seeded(20240607);
  const int side = argc > 1 ? std::atoi(argv[1]) : 512;
  TriangleMesh bunny = bench::read_obj("/usr/share/glmark2/models/bunny.obj");
  TriangleMesh terrain = scenes::terrain(707, 1000, random());
  // Both sides get coordinates that are floats.
  for (Vec3& vertex : terrain.vertices) vertex = bench::to_float(vertex);
  for (Vec3& vertex : bunny.vertices) vertex = bench::to_float(vertex);
  bench::run_scene("bunny", bunny, side, random);
  bench::run_scene("terrain", terrain, side, random);
  return 0;
}
