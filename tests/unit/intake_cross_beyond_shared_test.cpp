#include <gtest/gtest.h>

#include <set>

#include "server/exact_phase/overlap.hpp"
#include "server/intake/cross_beyond_shared.hpp"
#include "tests/oracle/seed.hpp"

// What the guards of simplification and of mending go by.  // A18
namespace collided {
namespace {

using Corners = TriangleCorners;

bool segment_meets(const Vec3& p, const Vec3& q, const Triangle& t) { return overlaps(Triangle{p, q, q}, t).yes(); }

int side_of(const Triangle& t, const Vec3& d) {  // of small whole numbers: exact
  const double volume = (t.b - t.a).cross(t.c - t.a).dot(d - t.a);
  return volume > 0 ? 1 : volume < 0 ? -1 : 0;
}

/// By the pairs of the exact phase: sets that share a corner meet beyond it where a far edge meets the other.
bool cross_by_pairs(const TriangleMesh& mesh) {
  const Triangle one = mesh.triangle(0);
  const Triangle other = mesh.triangle(1);
  const Corners& a = mesh.triangles[0];
  const Corners& b = mesh.triangles[1];
  std::set<std::uint32_t> shared;
  for (const std::uint32_t corner : a) {
    if (std::count(b.begin(), b.end(), corner) > 0) shared.insert(corner);
  }
  if (shared.size() == 3) return true;
  if (shared.empty()) return overlaps(one, other).yes();
  std::vector<Vec3> far_a, far_b;
  for (const std::uint32_t corner : a) if (!shared.contains(corner)) far_a.push_back(mesh.vertices[corner]);
  for (const std::uint32_t corner : b) if (!shared.contains(corner)) far_b.push_back(mesh.vertices[corner]);
  if (shared.size() == 1) return segment_meets(far_a[0], far_a[1], other) || segment_meets(far_b[0], far_b[1], one);
  if (side_of(one, far_b[0]) != 0) return false;
  const Vec3& p = mesh.vertices[*shared.begin()];
  const Vec3 edge = mesh.vertices[*shared.rbegin()] - p;
  return edge.cross(far_a[0] - p).dot(edge.cross(far_b[0] - p)) > 0;
}

TEST(IntakeTriangleCrossing, TwoTrianglesOfAMeshOnALatticeCrossExactlyWhenPairsSaySo) {
  std::mt19937_64 random = oracle::seeded(181);
  std::uniform_int_distribution<int> coordinate(0, 3);
  int crossing_counts[4] = {};
  for (int i = 0; i < 200'000; ++i) {
    const int shared = static_cast<int>(random() % 3);
    TriangleMesh mesh;
    const Vec3 far_m = i % 2 == 0 ? Vec3::Zero() : Vec3(1e6, -3e5, 7e6);  // differences stay whole numbers
    for (int k = 0; k < 6; ++k) mesh.vertices.push_back(far_m + Vec3(coordinate(random), coordinate(random), coordinate(random)));
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    for (int k = 0; k < shared; ++k) mesh.triangles[1][(k + i) % 3] = static_cast<std::uint32_t>((k + i / 3) % 3);
    const auto area = [&](std::uint32_t t) {
      const Triangle x = mesh.triangle(t);
      return (x.b - x.a).cross(x.c - x.a).norm();
    };
    if (area(0) == 0 || area(1) == 0) continue;
    const bool expected = cross_by_pairs(mesh);
    crossing_counts[shared] += expected ? 1 : 0;
    const std::vector<Vec3>& v = mesh.vertices;
    const OrientedPlane plane(v[mesh.triangles[0][0]], v[mesh.triangles[0][1]], v[mesh.triangles[0][2]]);
    ASSERT_EQ(cross_beyond_shared(v, mesh.triangles[0], mesh.triangles[1]), expected) << i;
    ASSERT_EQ(cross_beyond_shared(v, mesh.triangles[1], mesh.triangles[0]), expected) << i;
    ASSERT_EQ(cross_beyond_shared(v, mesh.triangles[0], plane, mesh.triangles[1]), expected) << i;
  }
  for (int shared = 0; shared < 3; ++shared) EXPECT_GT(crossing_counts[shared], 1000) << shared;
}

TEST(IntakeTriangleCrossing, OnlyWhatLiesBeyondTheSharedCornersCounts) {
  const std::vector<Vec3> v{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {-1, -1, 0}, {2, 2, 0}, {1, 1, 1}, {1, 1, -1}};
  EXPECT_FALSE(cross_beyond_shared(v, {0, 1, 2}, {1, 4, 2})) << "two halves of a square";
  EXPECT_TRUE(cross_beyond_shared(v, {0, 1, 2}, {1, 2, 3})) << "folded onto itself";
  EXPECT_FALSE(cross_beyond_shared(v, {0, 1, 2}, {0, 3, 5})) << "a corner in common";
  EXPECT_TRUE(cross_beyond_shared(v, {0, 1, 2}, {0, 5, 6})) << "a corner in common, and run through";
  EXPECT_TRUE(cross_beyond_shared(v, {0, 1, 2}, {2, 1, 0})) << "the same corners";
  EXPECT_TRUE(cross_beyond_shared(v, {0, 1, 2}, {3, 5, 6})) << "touching at (1, 1, 0)";
}

}  // namespace
}  // namespace collided
