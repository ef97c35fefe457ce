// What becoming triangles costs: polygons cut by ears and by the sweep with the slopes of their times, a million triangles
// simplified and proved, surfaces cut by error, bounding volumes a vertex. Processor time of this thread, but for the proof,
// which takes all cores and is timed by the wall.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <random>

#include "server/geometry/bounding_volumes.hpp"
#include "server/intake/mesh/tessellate.hpp"
#include "server/intake/polygons/sweep_triangulation.hpp"
#include "server/intake/polygons/triangulate.hpp"
#include "server/intake/simplify/simplify.hpp"
#include "server/world/objects/surface_distance.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/clock.hpp"

namespace collided::bench {
using namespace engine;
namespace {

template <class Work>
double seconds(const Work& work) {
  const double begin = thread_seconds();
  work();
  return thread_seconds() - begin;
}

/// A ring with teeth of random length: half of its corners are reflex.
std::vector<PlanePoint> toothed_ring(std::size_t count, double low, double high, const PlanePoint& center,
                                     std::mt19937_64& random) {
  std::uniform_real_distribution<double> radius(low, high);
  std::vector<PlanePoint> ring;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    const double r = radius(random);
    ring.push_back({center[0] + r * std::cos(angle), center[1] + r * std::sin(angle)});
  }
  return ring;
}

/// Least squares of log time over log size.
double slope(const std::vector<double>& sizes, const std::vector<double>& times) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double x = std::log(sizes[i]), y = std::log(times[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

// A2: 100 to 10,000 corners by ears (the readable form), as a polygon that touches itself has them cut.
void time_ears() {
  std::mt19937_64 random = oracle::seeded(21);
  std::vector<double> sizes, times;
  for (const std::size_t count : {300, 1000, 3000, 10000}) {
    const std::vector<PlanePoint> ring = toothed_ring(count, 0.6, 1, {0, 0}, random);
    std::vector<Vec3> vertices;
    for (const PlanePoint& p : ring) vertices.emplace_back(p[0], p[1], 0);
    vertices.push_back(vertices[0]);  // the ring's first corner a second time, beside the last: it touches itself
    std::vector<std::uint32_t> corners(vertices.size());
    std::iota(corners.begin(), corners.end(), 0u);
    std::vector<TriangleCorners> triangles;
    times.push_back(seconds([&] { triangulate(corners, vertices, triangles); }));
    sizes.push_back(static_cast<double>(count));
    std::printf("  ears    %9zu corners %10.3f ms\n", count, 1e3 * times.back());
  }
  std::printf("  ears    slope %.2f (asked: at most 2.1)\n", slope(sizes, times));
}

void time_sweep() {
  std::mt19937_64 random = oracle::seeded(22);
  std::vector<double> sizes, times;
  for (const std::size_t count : {1000, 10'000, 100'000, 1'000'000}) {
    std::vector<PlanePoint> points = toothed_ring(count, 0.9, 1, {0, 0}, random);
    std::vector<std::uint32_t> ends{static_cast<std::uint32_t>(points.size())};
    const auto side =
        static_cast<std::size_t>(std::sqrt(static_cast<double>(count) / 100));  // holes of 10 corners: a tenth of all
    for (std::size_t hole = 0; hole < side * side; ++hole) {
      const double cell = 1.2 / static_cast<double>(side);
      const PlanePoint center{-0.6 + cell * (0.5 + static_cast<double>(hole % side)),
                              -0.6 + cell * (0.5 + static_cast<double>(hole / side))};
      const std::vector<PlanePoint> ring = toothed_ring(10, 0.2 * cell, 0.4 * cell, center, random);
      points.insert(points.end(), ring.begin(), ring.end());
      ends.push_back(static_cast<std::uint32_t>(points.size()));
    }
    std::vector<TriangleCorners> triangles;
    times.push_back(seconds([&] { triangulate_by_sweep(points, ends, triangles); }));
    sizes.push_back(static_cast<double>(points.size()));
    std::printf("  sweep   %9zu corners %10.3f ms, %zu holes, %zu triangles of %zu\n", points.size(),
                1e3 * times.back(), ends.size() - 1, triangles.size(), points.size() + 2 * (ends.size() - 1) - 2);
  }
  std::printf("  sweep   slope %.2f (asked: below 1.2)\n", slope(sizes, times));
}

void time_simplification(std::uint32_t cells) {
  const TriangleMesh mesh = scenes::terrain(cells, 100, 7);
  const Bvh tree = Bvh::build(mesh);
  const std::vector<std::uint32_t> part_of(mesh.triangles.size(), 0);
  for (const auto& [cost, name] :
       {std::pair{CollapseCost::quadric, "quadric"}, {CollapseCost::edge_length, "length"}}) {
    SimplifyReport report;
    CollapseOrder order;
    const std::size_t target = mesh.triangles.size() / 10;
    const double simplify_s =
        seconds([&] { order = simplify(mesh, {.cost = cost, .triangles_at_most = target}, report); });
    const TriangleMesh level = compact_mesh(mesh, level_with(mesh, order, target));
    const Bvh level_tree = Bvh::build(level);
    const std::vector<std::uint32_t> level_part_of(level.triangles.size(), 0);
    const auto begin = std::chrono::steady_clock::now();
    const double off_by_m = surface_distance({mesh, tree, part_of}, {level, level_tree, level_part_of});
    const double proof_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::printf(
        "  %-8s %zu to %zu triangles in %.2f s, within %.4g m, proved in %.2f s; refused %llu flips, %llu crossings\n",
        name, mesh.triangles.size(), level.triangles.size(), simplify_s, off_by_m, proof_s,
        static_cast<unsigned long long>(report.flip_refusals),
        static_cast<unsigned long long>(report.crossing_refusals));
  }
}

void time_volumes() {
  const TriangleMesh mesh = scenes::icosphere(6, 1);
  const double per_vertex_ns = 1e9 / static_cast<double>(mesh.vertices.size());
  const auto print = [&](const char* name, double s) {
    std::printf("  %-28s %8.2f ns a vertex\n", name, per_vertex_ns * s);
  };
  double sink = 0;
  print("box along the axes", seconds([&] { sink += volume(bounding_aabb(mesh.vertices)); }));
  for (const int sides : {6, 14, 18, 26}) {
    const std::string name = "k-DOP of " + std::to_string(sides) + " sides";
    print(name.c_str(), seconds([&] { sink += bounding_kdop(mesh.vertices, kdop_normals(sides)).high[0]; }));
  }
  print("box along the mesh", seconds([&] { sink += volume(bounding_obb(mesh.vertices)); }));
  print("sphere, half the diagonal", seconds([&] { sink += diagonal_sphere(mesh.vertices).radius_m; }));
  print("sphere, farthest vertex", seconds([&] { sink += farthest_point_sphere(mesh.vertices).radius_m; }));
  print("sphere, smallest", seconds([&] { sink += smallest_sphere(mesh.vertices).radius_m; }));
  if (sink == 0) std::printf("nothing was measured\n");
}

void time_surfaces() {
  for (const double error_m : {1e-2, 1e-3, 1e-4}) {
    const Tessellation ball = tessellate_sphere(1, {.error_m = error_m});
    const Tessellation ring = tessellate_torus(2, 0.5, {.error_m = error_m});
    std::printf("  within %g m: sphere %zu triangles (%.3g m proved), torus %zu (%.3g m)\n", error_m,
                ball.mesh.triangles.size(), ball.off_by_m, ring.mesh.triangles.size(), ring.off_by_m);
  }
}

}  // namespace
}  // namespace collided::bench

int main(int argument_count, char** arguments) {
  using namespace collided::bench;
  const bool is_quick = argument_count > 1 && std::string(arguments[1]) == "--quick";
  std::printf("polygons into triangles\n");
  time_ears();
  time_sweep();
  std::printf("simplification to a tenth\n");
  time_simplification(is_quick ? 200 : 707);
  std::printf("curved surfaces\n");
  time_surfaces();
  std::printf("bounding volumes\n");
  time_volumes();
  return 0;
}
