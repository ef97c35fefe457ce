#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::shared_edge_test {
namespace {

/// A closed bumpy ball: an octahedron whose faces are split and pushed out, vertices rounded.
std::vector<Triangle> closed_mesh(int splits) {
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  std::vector<Triangle> mesh;
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 s(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
    mesh.push_back({s[0] * x, s[1] * y, s[2] * z});
  }
  for (int i = 0; i < splits; ++i) {
    std::vector<Triangle> finer;
    for (const Triangle& t : mesh) {
      const Vec3 ab = (t.a + t.b).normalized(), bc = (t.b + t.c).normalized(), ca = (t.c + t.a).normalized();
      finer.insert(finer.end(), {{t.a, ab, ca}, {ab, t.b, bc}, {ca, bc, t.c}, {ab, bc, ca}});
    }
    mesh = finer;
  }
  return mesh;
}

int hits(const Ray& ray, const std::vector<Triangle>& mesh) {
  int count = 0;
  RayHit hit;
  for (const Triangle& t : mesh) count += cast_ray(ray, t, hit).yes();
  return count;
}

const Vec3 kInside(0.25, 0.125, -0.0625);

// A ray from inside a closed surface leaves it, wherever it points: no crack between neighbours.
TEST(ExtremeRaySharedEdge, VerticesAreHitByEveryTriangleAround) {
  const std::vector<Triangle> mesh = closed_mesh(3);
  for (std::size_t i = 0; i < mesh.size(); i += 7) {
    EXPECT_GE(hits({Vec3::Zero(), mesh[i].a}, mesh), 4) << "exactly through vertex a of " << i;
    EXPECT_GE(hits({kInside, mesh[i].b - kInside}, mesh), 1) << "about through vertex b of " << i;
  }
}

TEST(ExtremeRaySharedEdge, EdgesHaveNoCracks) {
  const std::vector<Triangle> mesh = closed_mesh(3);
  std::mt19937_64 generator = oracle::seeded(301);
  std::uniform_real_distribution<double> part(0, 1);
  for (const Triangle& t : mesh) {
    const Vec3 target = t.a + part(generator) * (t.b - t.a);
    EXPECT_GE(hits({kInside, target - kInside}, mesh), 1);
    EXPECT_GE(hits({kInside * 0x1p-30, target}, mesh), 1);
  }
}

}  // namespace
}  // namespace collided::engine::shared_edge_test
