// A million points on ten closed meshes: sides by the solid's tree, by rays, by CGAL with exact predicates, and of some of
// them by rays in rationals. Ends with 1 where two differ.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>

#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/solids/solid.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/solid_oracle.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"
#include "tests/studies/bench/obj.hpp"
#include "tests/studies/bench/peers/solid_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
};

TriangleMesh turned_over(TriangleMesh mesh) {
  for (TriangleCorners& corners : mesh.triangles) std::swap(corners[1], corners[2]);
  return mesh;
}

TriangleMesh together(std::initializer_list<TriangleMesh> shells) {
  TriangleMesh all;
  for (const TriangleMesh& shell : shells) scenes::append(all, shell);
  return all;
}

TriangleMesh torus(std::uint32_t around, std::uint32_t across) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t k = 0; k < across; ++k) {
      const double u = 2 * M_PI * i / around;
      const double v = 2 * M_PI * k / across;
      const double radius = 1 + 0.4 * std::cos(v);
      mesh.vertices.push_back({radius * std::cos(u), radius * std::sin(u), 0.4 * std::sin(v)});
      const auto at = [&](std::uint32_t a, std::uint32_t b) { return (a % around) * across + b % across; };
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return mesh;
}

/// A union of unit cubes whose heights fall along x and y: many faces in one plane, and no edge with four faces.
TriangleMesh stacked_cubes(int size, std::mt19937_64& random) {
  std::vector<std::vector<int>> height(static_cast<std::size_t>(size) + 2,
                                       std::vector<int>(static_cast<std::size_t>(size) + 2, 0));
  for (int x = size; x >= 1; --x) {
    for (int y = size; y >= 1; --y) {
      auto& h = height[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)];
      h = std::max(height[static_cast<std::size_t>(x) + 1][static_cast<std::size_t>(y)],
                   height[static_cast<std::size_t>(x)][static_cast<std::size_t>(y) + 1]) +
          static_cast<int>(random() % 2);
      h = std::max(h, 1);
    }
  }
  const auto is_in = [&](const Eigen::Vector3i& c) {
    if (c.x() < 1 || c.y() < 1 || c.x() > size || c.y() > size || c.z() < 0) return false;
    return c.z() < height[static_cast<std::size_t>(c.x())][static_cast<std::size_t>(c.y())];
  };
  TriangleMesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  const auto vertex = [&](const Eigen::Vector3i& at) {
    const auto [known, is_new] =
        numbers.try_emplace({at.x(), at.y(), at.z()}, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(at.cast<double>());
    return known->second;
  };
  for (int x = 1; x <= size; ++x) {
    for (int y = 1; y <= size; ++y) {
      for (int z = 0; z <= 2 * size; ++z) {
        const Eigen::Vector3i cube(x, y, z);
        if (!is_in(cube)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          for (const int sign : {1, -1}) {
            Eigen::Vector3i out = Eigen::Vector3i::Zero();
            out[axis] = sign;
            if (is_in(cube + out)) continue;
            Eigen::Vector3i u = Eigen::Vector3i::Zero();
            Eigen::Vector3i v = Eigen::Vector3i::Zero();
            u[(axis + (sign > 0 ? 1 : 2)) % 3] = 1;
            v[(axis + (sign > 0 ? 2 : 1)) % 3] = 1;
            const Eigen::Vector3i corner = sign > 0 ? Eigen::Vector3i(cube + out) : cube;
            const std::uint32_t q[4] = {vertex(corner), vertex(corner + u), vertex(corner + u + v), vertex(corner + v)};
            mesh.triangles.push_back({q[0], q[1], q[2]});
            mesh.triangles.push_back({q[0], q[2], q[3]});
          }
        }
      }
    }
  }
  return mesh;
}

TriangleMesh spire(std::uint32_t count) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 100}, {0, 0, 0}};
  for (std::uint32_t i = 0; i < count; ++i) {
    const double turn = 2 * M_PI * i / count;
    const double radius = i % 2 == 0 ? 1 : 0.5;
    mesh.vertices.push_back({radius * std::cos(turn), radius * std::sin(turn), 0});
    mesh.triangles.push_back({0, 2 + i, 2 + (i + 1) % count});
    mesh.triangles.push_back({1, 2 + (i + 1) % count, 2 + i});
  }
  return mesh;
}

std::vector<NamedMesh> closed_meshes(std::mt19937_64& random) {
  const TriangleMesh rough = scenes::rough_sphere(4, random);
  TriangleMesh far_off = rough;
  for (Vec3& vertex : far_off.vertices) vertex += Vec3(1e6 + 0.1, -3e6, 7e5);
  std::vector<NamedMesh> meshes{
      {"box", scenes::box({1, 2, 3})},
      {"sphere", scenes::icosphere(4, 1)},
      {"stone", scenes::rough_sphere(6, random)},
      {"stone far off", far_off},
      {"torus", torus(96, 48)},
      {"hollow box", together({scenes::box({1, 1, 1}), turned_over(scenes::box({0.25, 0.5, 0.75}))})},
      {"nested shells",
       together({scenes::icosphere(3, 1), turned_over(scenes::icosphere(3, 0.75)), scenes::icosphere(2, 0.5)})},
      {"stacked cubes", stacked_cubes(12, random)},
      {"spire", spire(200)}};
  const char* data = std::getenv("COLLIDED_DATA");
  TriangleMesh spot = data != nullptr ? read_obj(std::string(data) + "/meshes/spot.obj") : TriangleMesh{};
  if (!spot.triangles.empty()) meshes.push_back({"spot", std::move(spot)});
  else meshes.push_back({"thin torus", torus(400, 12)});
  return meshes;
}

/// Corners, edges and faces as near as doubles come, coordinates of several corners, and the neighbours of all those.
class HardPoints {
 public:
  HardPoints(const TriangleMesh& mesh, std::mt19937_64& random) : mesh_(mesh), random_(random) {
    for (const Vec3& vertex : mesh.vertices) box_.extend(vertex);
  }
  Vec3 next() {
    Vec3 point = of_kind(static_cast<int>(random_() % 6));
    for (double& x : point) {
      const auto by = random_() % 5;
      if (by < 2) x = std::nextafter(x, by == 0 ? -INFINITY : INFINITY);
    }
    return point;
  }

 private:
  double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  const Vec3& any_vertex() { return mesh_.vertices[random_() % mesh_.vertices.size()]; }
  Vec3 of_kind(int kind) {
    const Triangle t = mesh_.triangle(static_cast<std::uint32_t>(random_() % mesh_.triangles.size()));
    const double a = share();
    const double b = share() * (1 - a);
    switch (kind) {
      case 0: return t.a;
      case 1: return t.a / 2 + t.b / 2;
      case 2: return t.a + a * (t.b - t.a);
      case 3: return (t.a + a * (t.b - t.a)) + b * (t.c - t.a);
      case 4: return {any_vertex().x(), any_vertex().y(), any_vertex().z()};
      default: return box_.low + Vec3(share(), share(), share()).cwiseProduct(box_.high - box_.low);
    }
  }

  const TriangleMesh& mesh_;
  std::mt19937_64& random_;
  Aabb box_;
};

/// How many points have another side by the tree or the ray than by CGAL or, of some, by rationals.
std::size_t compare(const NamedMesh& named, std::size_t count, std::mt19937_64& random) {
  const auto shared = std::make_shared<const TriangleMesh>(named.mesh);
  const auto surface = indexed_mesh(shared, Bvh::build(*shared, {.threads = 1, .progress = {}, .cancelled = {}}));
  SolidFindings findings;
  const auto solid = solid_within(surface, findings);
  if (!solid || !findings.warning.empty()) {
    std::printf("%s is no plain solid: %s%s\n", named.name.c_str(), findings.refusal.c_str(), findings.warning.c_str());
    return 1;
  }
  const oracle::SolidOracle exact(named.mesh);
  const std::unique_ptr<SolidPeer> peer = cgal_solid_peer(named.mesh);
  HardPoints points(named.mesh, random);
  const std::size_t judged = std::min<std::size_t>(1000, 4'000'000 / named.mesh.triangles.size());
  std::size_t sides[3] = {};
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 point = points.next();
    WalkCost cost;
    const SolidSide by_ray = side_by_ray(*surface, point, cost).side;
    const SolidSide by_tree = side_of(*solid, point, cost).side;
    const SolidSide by_peer = peer->side(point);
    ++sides[static_cast<int>(by_tree)];
    const bool is_equal = by_ray == by_tree && by_tree == by_peer;
    if (is_equal && i >= judged) continue;
    const SolidSide truth = exact.side(oracle::rational(point), random);
    if (is_equal && truth == by_tree) continue;
    ++wrong;
    std::printf("%s at %a %a %a: tree %d, ray %d, CGAL %d, rationals %d\n", named.name.c_str(), point[0], point[1],
                point[2], static_cast<int>(by_tree), static_cast<int>(by_ray), static_cast<int>(by_peer),
                static_cast<int>(truth));
  }
  std::printf("%-14s %6zu triangles  %s  %zu points: %zu out, %zu on, %zu in; %zu by rationals too; %zu wrong\n",
              named.name.c_str(), named.mesh.triangles.size(), solid->tree ? "tree" : "ray ", count, sides[0], sides[1],
              sides[2], judged, wrong);
  return wrong;
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const std::size_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000;
  std::mt19937_64 random = oracle::seeded(64);
  std::size_t wrong = 0;
  std::size_t meshes = 0;
  for (const bench::NamedMesh& named : bench::closed_meshes(random)) {
    wrong += bench::compare(named, count, random);
    ++meshes;
  }
  std::printf("%zu points on %zu meshes, %zu wrong\n", meshes * count, meshes, wrong);
  return wrong == 0 ? 0 : 1;
}
