#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/intake/simplify/cross_beyond_shared.hpp"
#include "tests/oracle/mesh_twins.hpp"
#include "tests/oracle/seed.hpp"

// What the guards of simplification and of mending go by.  // A18
namespace collided::engine {
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
  for (const std::uint32_t corner : a)
    if (!shared.contains(corner)) far_a.push_back(mesh.vertices[corner]);
  for (const std::uint32_t corner : b)
    if (!shared.contains(corner)) far_b.push_back(mesh.vertices[corner]);
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
    for (int k = 0; k < 6; ++k)
      mesh.vertices.push_back(far_m + Vec3(coordinate(random), coordinate(random), coordinate(random)));
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
    const TriangleSides sides(v, mesh.triangles[0]);
    ASSERT_EQ(cross_beyond_shared(v, mesh.triangles[0], mesh.triangles[1]), expected) << i;
    ASSERT_EQ(cross_beyond_shared(v, mesh.triangles[1], mesh.triangles[0]), expected) << i;
    ASSERT_EQ(cross_beyond_shared(v, sides, mesh.triangles[1]), expected) << i;
  }
  for (int shared = 0; shared < 3; ++shared) EXPECT_GT(crossing_counts[shared], 1000) << shared;
}

// A corner all but on a side, the other two well beyond it: touching or not by less than plain double can tell.
TEST(IntakeTriangleCrossing, WhatARoundingPutsBeyondASideIsNotKeptApart) {
  std::mt19937_64 random = oracle::seeded(183);
  std::uniform_real_distribution<double> share(0, 1);
  // Of many sizes, so that differences of two are rounded too.
  const auto coordinate = [&](std::mt19937_64& r) { return std::ldexp(share(r) - 0.5, -static_cast<int>(r() % 12)); };
  int touching_count = 0;
  for (int i = 0; i < 2'000; ++i) {
    TriangleMesh mesh{{}, {{0, 1, 2}, {3, 4, 5}}};
    std::vector<Vec3>& v = mesh.vertices;
    for (int k = 0; k < 3; ++k) v.emplace_back(coordinate(random), coordinate(random), 0.1);
    v.push_back(v[0] + share(random) * (v[1] - v[0]));
    for (int k = 0; k < 2; ++k) v.push_back(v[k] + (v[k] - v[2]));
    for (Vec3& vertex : v) vertex[2] = 0.1;
    const bool is_touching = !oracle::self_intersections(mesh).empty();
    touching_count += is_touching ? 1 : 0;
    if (is_touching) { ASSERT_FALSE(TriangleSides(v, mesh.triangles[0]).keep_apart(v, mesh.triangles[1])) << i; }
  }
  EXPECT_GT(touching_count, 300);
}

// What is kept apart by a plane or a side never crosses.
TEST(IntakeTriangleCrossing, WhatSidesKeepApartDoesNotCross) {
  std::mt19937_64 random = oracle::seeded(182);
  int apart_counts[3] = {};
  for (int i = 0; i < 20'000; ++i) {
    const int shared = static_cast<int>(random() % 3);
    const auto coordinate = [&] { return static_cast<double>(random() % 4) * 0.1 + (i % 2 == 0 ? 0 : 1000); };
    TriangleMesh mesh;
    for (int k = 0; k < 6; ++k) mesh.vertices.emplace_back(coordinate(), coordinate(), i % 4 < 2 ? 0.1 : coordinate());
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    for (int k = 0; k < shared; ++k) mesh.triangles[1][(k + i) % 3] = static_cast<std::uint32_t>((k + i / 3) % 3);
    if (!TriangleSides(mesh.vertices, mesh.triangles[0]).keep_apart(mesh.vertices, mesh.triangles[1])) continue;
    ++apart_counts[shared];
    ASSERT_TRUE(oracle::self_intersections(mesh).empty()) << i;
  }
  for (const int count : apart_counts) EXPECT_GT(count, 500);
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
}  // namespace collided::engine
