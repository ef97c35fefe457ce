#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/accuracy/census/table.hpp"
#include "tests/accuracy/leaks/peers.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::census {
using namespace engine;
namespace {

/// A cube of cells x cells squares a side, every corner on the grid.
TriangleMesh lattice_cube(std::uint32_t cells) {
  TriangleMesh mesh;
  const auto side = static_cast<double>(cells);
  for (int axis = 0; axis < 3; ++axis) {
    for (int end = 0; end < 2; ++end) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (std::uint32_t row = 0; row <= cells; ++row) {
        for (std::uint32_t column = 0; column <= cells; ++column) {
          Vec3 p;
          p[axis] = end * side - side / 2;
          p[(axis + 1) % 3] = row - side / 2;
          p[(axis + 2) % 3] = column - side / 2;
          mesh.vertices.push_back(p);
        }
      }
      const std::uint32_t stride = cells + 1;
      for (std::uint32_t row = 0; row < cells; ++row) {
        for (std::uint32_t column = 0; column < cells; ++column) {
          const std::uint32_t a = first + row * stride + column;
          mesh.triangles.push_back({a, a + 1, a + stride});
          mesh.triangles.push_back({a + 1, a + stride + 1, a + stride});
        }
      }
    }
  }
  return mesh;
}

/// A37: from a point well inside a closed mesh: every ray meets it, whatever its direction.
struct InsideRay {
  Ray ray;
  bool meets = true;
};

enum class Aim { vertex, edge, anywhere };

InsideRay aimed(const TriangleMesh& mesh, const Vec3& center, double inside_m, Aim aim, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(-1, 1);
  const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
  InsideRay asked;
  // Half of them from the centre itself, so that directions to vertices are exact where the mesh stands at the origin.
  const bool from_center = random() % 2 == 0;
  asked.ray.origin = from_center ? center : Vec3(center + inside_m * Vec3(part(random), part(random), part(random)));
  const Vec3 edge = t.a + (part(random) + 1) / 2 * (t.b - t.a);
  const Vec3 target = aim == Aim::vertex ? t.a
                      : aim == Aim::edge ? edge
                                         : Vec3(center + Vec3(part(random), part(random), part(random)));
  asked.ray.direction = target - asked.ray.origin;
  if (asked.ray.direction.isZero(0)) asked.ray.direction = {1, 0, 0};
  return asked;
}

Decision leaks_not(const Bvh& tree, const TriangleMesh& mesh, const Ray& ray) {
  Decision answer = Decision::no;
  WalkCost cost;
  const auto candidate = [&](std::uint32_t, const Triangle& corners, double limit) {
    RayHit hit;
    const Decision decision = cast_ray(ray, corners, hit).decision;
    if (decision == Decision::no) return limit;
    answer = decision;
    return decision == Decision::yes ? -1.0 : limit;
  };
  tree.walk_ray(ray, std::numeric_limits<double>::infinity(), 0, mesh, candidate, cost);
  return answer;
}

struct Scene {
  const char* name;
  TriangleMesh mesh;
  Vec3 center = Vec3::Zero();
  double inside_m = 0.25;
};

void count_leaks(Table& table, const Scene& scene, std::uint64_t count, std::uint64_t peer_count,
                 std::mt19937_64& random) {
  const Bvh tree = Bvh::build(scene.mesh);
  std::vector<Method<InsideRay>> methods;
  methods.push_back(method<InsideRay>(kOurs, [&](const InsideRay& c) { return leaks_not(tree, scene.mesh, c.ray); }));
  for (const Peer& peer : closed_mesh_peers(scene.mesh)) {
    methods.push_back(method<InsideRay>(
        peer.name, [meets = peer.meets](const InsideRay& c) { return meets(c.ray) ? Decision::yes : Decision::no; },
        peer_count));
  }
  for (const auto& [aim, label] :
       {std::pair{Aim::vertex, "vertex"}, {Aim::edge, "edge"}, {Aim::anywhere, "anywhere"}}) {
    const std::string query = std::string("closed_") + scene.name;
    take<InsideRay>(
        table, query, label, aim == Aim::anywhere ? count / 8 : count,
        [&] { return aimed(scene.mesh, scene.center, scene.inside_m, aim, random); }, methods);
  }
}

int run(int argc, char** argv) {
  std::mt19937_64 random = oracle::seeded(20261122);
  double part = 0.001;
  std::string csv;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--long") == 0) part = 1;
    else if (std::strcmp(argv[i], "--part") == 0 && i + 1 < argc) part = std::atof(argv[++i]);
    else if (std::strcmp(argv[i], "--csv") == 0 && i + 1 < argc) csv = argv[++i];
    else return std::fprintf(stderr, "usage: leaks [--long | --part P] [--csv FILE]\n"), 2;
  }
  // Altogether 1e8 at edges and vertices.
  const auto count = static_cast<std::uint64_t>(part * 12'500'000);
  const std::uint64_t peer_count = part == 1 ? 1'000'000 : 10'000;
  Table table;
  count_leaks(table, {"icosphere6", scenes::icosphere(6, 1)}, count, peer_count, random);
  count_leaks(table, {"icosphere3_far", scenes::icosphere(3, 1000, Vec3(1e6, 1e6, 1e6)), Vec3(1e6, 1e6, 1e6), 100},
              count, peer_count, random);
  count_leaks(table, {"cube16", lattice_cube(16)}, count, peer_count, random);
  count_leaks(table, {"icosphere4_tiny", scenes::icosphere(4, 0x1p-40), Vec3::Zero(), 0x1p-43}, count, peer_count,
              random);
  count_fcl_distances(table, part == 1 ? 300 : 8, random);
  if (!csv.empty() && !table.write(csv)) return std::fprintf(stderr, "cannot write %s\n", csv.c_str()), 2;
  std::uint64_t rays = 0, wrong = 0;
  for (const Row& row : table.rows()) {
    if (row.method != kOurs) continue;
    wrong += row.wrong();
    if (row.family != "anywhere") rays += row.count;
  }
  std::printf("closed meshes: %llu of %llu rays at edges and vertices leak\n", static_cast<unsigned long long>(wrong),
              static_cast<unsigned long long>(rays));
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace collided::census

/// Rays from inside closed meshes through the index and the exact test: 0 exit when none leaks.
int main(int argc, char** argv) { return collided::census::run(argc, argv); }
