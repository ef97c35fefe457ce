#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/overlap/neighbours.hpp"
#include "server/exact_phase/overlap/parted_in_projection.hpp"
#include "server/world/objects/self_intersections.hpp"
#include "tests/oracle/mesh_twins.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

// Neighbours in one plane, decided without exact arithmetic.  A24
namespace collided::engine::parted_in_projection_test {
namespace {

int turn_by_rationals(const Vec3& o, const Vec3& p, const Vec3& q, int u, int v) {
  const auto displacement = [&](const Vec3& to, int k) { return mpq_class(mpq_class(to[k]) - mpq_class(o[k])); };
  return sgn(mpq_class(displacement(p, u) * displacement(q, v) - displacement(p, v) * displacement(q, u)));
}

TEST(ExactPartedInProjection, ATurnThatIsSaidIsThatOfRationals) {
  std::mt19937_64 random = oracle::seeded(241);
  std::size_t said_count = 0;
  std::size_t zero_count = 0;
  constexpr int kRounds = 200'000;
  for (int round = 0; round < kRounds; ++round) {
    // Small multiples of a step that no double is, near and far from the origin, and now and then near the ends of the range.
    const double step = round % 3 == 0 ? 0.1 : round % 3 == 1 ? 100.0 / 708 : 0.25;
    const double far = round % 2 == 0 ? 0 : 1e5;
    const double scale = round % 7 == 0 ? 0x1p-530 : round % 11 == 0 ? 0x1p-300 : round % 13 == 0 ? 0x1p505 : 1;
    const auto coordinate = [&] { return scale * (far + static_cast<double>(random() % 7) * step); };
    const Vec3 o(coordinate(), coordinate(), 0);
    const Vec3 p(coordinate(), coordinate(), 0);
    Vec3 q(coordinate(), coordinate(), 0);
    if (round % 5 == 0) q = o + 2 * (p - o);
    if (round % 10 == 0) q[1] = std::nextafter(q[1], 1e9);
    const int told = sure_turn(o, p, q, 0, 1);
    if (told == kTurnUnsure) continue;
    ++said_count;
    zero_count += told == 0 ? 1 : 0;
    ASSERT_EQ(told, turn_by_rationals(o, p, q, 0, 1)) << round;
  }
  EXPECT_GT(said_count, kRounds * 7 / 10);
  EXPECT_GT(zero_count, kRounds / 20);
}

/// The plane z = x + 2 y over a lattice: exact, and no axis is square to it.
Vec3 in_plane(int x, int y) { return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(x + 2 * y)}; }

bool has_area(const TriangleCorners& t, const std::vector<Vec3>& v) {
  return (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]).norm() > 0;
}

TEST(ExactPartedInProjection, TwoTrianglesOfOnePlaneArePartedExactlyWhenTheyAreApart) {
  std::mt19937_64 random = oracle::seeded(242);
  int apart_counts[3] = {};
  int meeting_counts[3] = {};
  for (int round = 0; round < 6'000; ++round) {
    const int shared = round % 3;
    TriangleMesh mesh;
    for (int i = 0; i < 6; ++i)
      mesh.vertices.push_back(in_plane(static_cast<int>(random() % 6), static_cast<int>(random() % 6)));
    for (int i = 0; i < shared; ++i) mesh.vertices[3 + i] = mesh.vertices[i];
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    if (!has_area(mesh.triangles[0], mesh.vertices) || !has_area(mesh.triangles[1], mesh.vertices)) continue;
    std::size_t equal_count = 0;
    for (int i = 0; i < 3; ++i)
      equal_count +=
          static_cast<std::size_t>(std::count(mesh.vertices.begin() + 3, mesh.vertices.end(), mesh.vertices[i]));
    if (equal_count != static_cast<std::size_t>(shared)) continue;
    const bool meets = !oracle::self_intersections(mesh).empty();
    ++(meets ? meeting_counts : apart_counts)[shared];
    const Triangle a = mesh.triangle(0);
    const Triangle b = mesh.triangle(1);
    const auto parted = [shared](const Triangle& x, const Triangle& y) {
      return shared == 0   ? parted_in_projection(x, y)
             : shared == 1 ? parted_but_for_corner(x, y)
                           : parted_but_for_edge(x, y);
    };
    ASSERT_EQ(parted(a, b), !meets) << shared << " shared, round " << round;
    ASSERT_EQ(parted(b, a), !meets) << shared << " shared, round " << round;
  }
  for (int shared = 0; shared < 3; ++shared) {
    EXPECT_GT(apart_counts[shared], 100) << shared;
    EXPECT_GT(meeting_counts[shared], 100) << shared;
  }
}

// In space a line that parts what is seen is a plane that parts what is there.
TEST(ExactPartedInProjection, WhatIsPartedInSpaceHasNothingMoreInCommon) {
  std::mt19937_64 random = oracle::seeded(243);
  int parted_counts[3] = {};
  for (int round = 0; round < 6'000; ++round) {
    const int shared = round % 3;
    const auto coordinate = [&] { return static_cast<double>(random() % 4) * 0.1; };
    TriangleMesh mesh;
    for (int i = 0; i < 6; ++i) mesh.vertices.emplace_back(coordinate(), coordinate(), coordinate());
    for (int i = 0; i < shared; ++i) mesh.vertices[3 + i] = mesh.vertices[i];
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    const Triangle a = mesh.triangle(0);
    const Triangle b = mesh.triangle(1);
    const bool parted = shared == 0   ? parted_in_projection(a, b)
                        : shared == 1 ? parted_but_for_corner(a, b)
                                      : parted_but_for_edge(a, b);
    if (!parted) continue;
    ++parted_counts[shared];
    ASSERT_TRUE(oracle::self_intersections(mesh).empty()) << shared << " shared, round " << round;
  }
  for (const int count : parted_counts) EXPECT_GT(count, 100);
}

/// A flat grid of cells x cells squares, tilted so that no axis is square to it.
TriangleMesh flat_grid(std::uint32_t cells, double slope) {
  TriangleMesh grid = scenes::terrain(cells, 100, 7);
  for (Vec3& v : grid.vertices) v[2] = slope * (v[0] + 2 * v[1]);
  return grid;
}

std::uint64_t exact_questions_of(const TriangleMesh& mesh) {
  const Bvh tree = Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}});
  const std::uint64_t before = kernel::rungs.uncertain;
  EXPECT_TRUE(self_intersections(mesh, tree).pairs.empty());
  return kernel::rungs.uncertain - before;
}

// A million such triangles took 4.8 s, most of it for expansions; the questions are counted, since clocks are not sure.
TEST(ExactPartedInProjection, AFlatGridIsCheckedWithHardlyAnyExactArithmetic) {
  for (const double slope : {0.0, 0.25}) {
    const TriangleMesh grid = flat_grid(177, slope);
    EXPECT_LE(exact_questions_of(grid), grid.triangles.size() / 100) << "slope " << slope;
  }
}

TEST(ExactPartedInProjection, OverlapsPlantedInAFlatGridAreFound) {
  std::mt19937_64 random = oracle::seeded(244);
  constexpr std::uint32_t kCells = 6;
  for (const double slope : {0.0, 0.25}) {
    for (int round = 0; round < 5; ++round) {
      TriangleMesh grid = flat_grid(kCells, slope);
      // An inner vertex moved over its neighbours folds the triangles about it onto others.
      const auto inner = [&] { return 1 + static_cast<std::uint32_t>(random() % (kCells - 1)); };
      Vec3& moved = grid.vertices[inner() * (kCells + 1) + inner()];
      const auto shift_m = [&] {
        return (random() % 2 == 0 ? 1 : -1) * (1.25 + 0.125 * static_cast<double>(random() % 4)) * 100 / kCells;
      };
      moved += Vec3(shift_m(), shift_m(), 0);
      moved[2] = slope * (moved[0] + 2 * moved[1]);
      const std::vector<TrianglePair> told = self_intersections(grid, Bvh::build(grid)).pairs;
      EXPECT_FALSE(told.empty()) << "slope " << slope << ", round " << round;
      ASSERT_EQ(told, oracle::self_intersections(grid)) << "slope " << slope << ", round " << round;
    }
  }
}

}  // namespace
}  // namespace collided::engine::parted_in_projection_test
