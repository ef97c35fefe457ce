// What a ray costs as a scene grows: a terrain and a scanned ball, each from 125,000 triangles to 8 million in
// doublings, the same rays through all. growth_bench [MILLIONS] stops earlier. A row: processor time and nodes a ray
// (median of kRepeats interleaved runs), the ratio to Embree's default on the same mesh (above 1: we are faster); below,
// the factor a doubling costs, from the slope of the line through the points on log-log axes.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/closest_hit.hpp"
#ifdef COLLIDED_BENCH_EMBREE
#include "tests/studies/bench/peers/embree_scene.hpp"
#endif
#include "tests/studies/bench/ray_scenes.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr int kRepeats = 5;
constexpr std::size_t kRays = 50'000;

Vec3 in_cube(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

/// Numbers that floats hold, so that Embree gets the same question.
Vec3 in_floats(const Vec3& v) { return v.cast<float>().cast<double>(); }

/// Between random points of the scene's box, grown by a half: no ray has to do with the one before.
std::vector<Ray> chords(const Aabb& bounds, std::mt19937_64& random) {
  const Vec3 middle = (bounds.low + bounds.high) / 2;
  const Vec3 half = 0.75 * (bounds.high - bounds.low);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < kRays; ++i) {
    const Vec3 from = middle + half.cwiseProduct(in_cube(random));
    rays.push_back({in_floats(from), in_floats(middle + half.cwiseProduct(in_cube(random)) - from)});
  }
  return rays;
}

/// Row by row through a picture, as a camera asks.
std::vector<Ray> picture(const Aabb& bounds) {
  const Vec3 middle = (bounds.low + bounds.high) / 2;
  const double size = (bounds.high - bounds.low).maxCoeff();
  const Vec3 eye = middle + size * Vec3(0.55, -0.75, 0.45);
  const Vec3 forward = (middle - eye).normalized();
  const Vec3 right = forward.cross(Vec3::UnitZ()).normalized();
  const auto side = static_cast<int>(std::sqrt(static_cast<double>(kRays)));
  std::vector<Ray> rays;
  for (int i = 0; i < side * side; ++i) {
    const double x = (i % side + 0.5) / side - 0.5;
    const double y = (i / side + 0.5) / side - 0.5;
    rays.push_back({in_floats(eye), in_floats(forward + x * right + y * right.cross(forward))});
  }
  return rays;
}

double median(std::array<double, kRepeats> values) {
  std::sort(values.begin(), values.end());
  return values[kRepeats / 2];
}

#ifdef COLLIDED_BENCH_EMBREE
class Peer {
 public:
  explicit Peer(const TriangleMesh& mesh)
      : device_(rtcNewDevice(nullptr)), scene_(embree_scene(device_, mesh, RTC_SCENE_FLAG_NONE)) {
    rtcCommitScene(scene_);
  }
  ~Peer() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  std::uint32_t closest(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    const Eigen::Vector3f from = ray.origin.cast<float>();
    const Eigen::Vector3f along = ray.direction.cast<float>();
    RTCRayHit hit{};
    hit.ray.org_x = from[0], hit.ray.org_y = from[1], hit.ray.org_z = from[2];
    hit.ray.dir_x = along[0], hit.ray.dir_y = along[1], hit.ray.dir_z = along[2];
    hit.ray.tfar = std::numeric_limits<float>::infinity();
    hit.ray.mask = 0xffffffffu;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &hit);
    return hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? kNoTriangle : hit.hit.primID;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};
#else
struct Peer {
  explicit Peer(const TriangleMesh&) {}
  std::uint32_t closest(const Ray&) const { return kNoTriangle; }
};
#endif

struct Row {
  double triangles = 0;
  double ns = 0;
  double nodes = 0;
  double peer_ns = 0;
};

Row measure(const TriangleMesh& mesh, const Bvh& tree, const Peer& peer, const std::vector<Ray>& rays) {
  std::array<double, kRepeats> ours{};
  std::array<double, kRepeats> theirs{};
  WalkCost cost;
  std::size_t equal = 0;
  std::vector<std::uint32_t> answers(rays.size());
  for (std::size_t repeat = 0; repeat < kRepeats; ++repeat) {
    double start = thread_seconds();
    for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = closest_hit(tree, mesh, rays[i], cost).triangle;
    ours[repeat] = thread_seconds() - start;
    equal = 0;
    start = thread_seconds();
    for (std::size_t i = 0; i < rays.size(); ++i) equal += peer.closest(rays[i]) == answers[i] ? 1 : 0;
    theirs[repeat] = thread_seconds() - start;
  }
  const auto count = static_cast<double>(rays.size());
  const Row row{static_cast<double>(mesh.triangles.size()), 1e9 * median(ours) / count, cost.nodes / (count * kRepeats),
                1e9 * median(theirs) / count};
  std::printf("    %8.0f triangles: %6.0f ns and %5.1f nodes a ray", row.triangles, row.ns, row.nodes);
#ifdef COLLIDED_BENCH_EMBREE
  std::printf(", Embree %6.0f ns, ratio %.2f, the same triangle %zu of %zu", row.peer_ns, row.peer_ns / row.ns, equal,
              rays.size());
#endif
  std::printf("\n");
  std::fflush(stdout);
  return row;
}

/// 2 to the slope of the least-squares line through (log triangles, log value).
template <class Value>
double per_doubling(const std::vector<Row>& rows, Value&& value) {
  double x_sum = 0, y_sum = 0, xx_sum = 0, xy_sum = 0;
  for (const Row& row : rows) {
    const double x = std::log2(row.triangles);
    const double y = std::log2(value(row));
    x_sum += x, y_sum += y, xx_sum += x * x, xy_sum += x * y;
  }
  const auto count = static_cast<double>(rows.size());
  return std::exp2((count * xy_sum - x_sum * y_sum) / (count * xx_sum - x_sum * x_sum));
}

void print_growth(const char* name, const std::vector<Row>& rows) {
  double worst = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) worst = std::max(worst, rows[i].ns / rows[i - 1].ns);
  std::printf("  %s: a doubling costs %.3f of the time (slope %.3f, worst step %.2f), %.3f of the nodes", name,
              per_doubling(rows, [](const Row& r) { return r.ns; }),
              std::log2(per_doubling(rows, [](const Row& r) { return r.ns; })), worst,
              per_doubling(rows, [](const Row& r) { return r.nodes; }));
#ifdef COLLIDED_BENCH_EMBREE
  std::printf("; Embree's time %.3f", per_doubling(rows, [](const Row& r) { return r.peer_ns; }));
#endif
  std::printf("\n");
}

template <class Make>
void run(const char* name, double most_triangles, std::mt19937_64& random, Make&& make) {
  std::vector<Row> incoherent;
  std::vector<Row> coherent;
  std::vector<Ray> chord_rays;
  std::vector<Ray> picture_rays;
  for (double triangles = 125'000; triangles <= most_triangles; triangles *= 2) {
    TriangleMesh mesh = make(static_cast<std::uint32_t>(triangles));
    for (Vec3& vertex : mesh.vertices) vertex = in_floats(vertex);
    const Bvh tree = Bvh::build(mesh);
    const Peer peer(mesh);
    if (chord_rays.empty()) {
      chord_rays = chords(tree.bounds(), random);
      picture_rays = picture(tree.bounds());
    }
    const BvhReport& report = tree.report();
    std::printf("  %s: %.0f ms to build, %.1f bytes a triangle, depth %u\n", name, 1e3 * report.build_s,
                static_cast<double>(report.bytes) / static_cast<double>(mesh.triangles.size()), report.depth);
    incoherent.push_back(measure(mesh, tree, peer, chord_rays));
    coherent.push_back(measure(mesh, tree, peer, picture_rays));
  }
  print_growth("incoherent", incoherent);
  print_growth("camera", coherent);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  std::mt19937_64 random = oracle::seeded(20260612);
  const double most = 1e6 * (argc > 1 ? std::atof(argv[1]) : 8);
  bench::run("terrain", most, random, [](std::uint32_t triangles) {
    return scenes::terrain(static_cast<std::uint32_t>(std::sqrt(triangles / 2.0)), 1000, 7);
  });
  bench::run("ball", most, random, [](std::uint32_t triangles) { return bench::scanned_ball(triangles, 7); });
  return 0;
}
