#include <gmpxx.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "server/world/objects/surface_cover.hpp"
#include "tests/oracle/seed.hpp"

// How far a triangle's points are at most from a surface that lies over it.  // A13
namespace collided::engine {
namespace {

double height_at_most(const TriangleMesh& sheet, const Triangle& table) {
  const std::vector<std::uint32_t> part_of(sheet.triangles.size(), 0);
  const TriangleNeighbours neighbours(sheet, part_of);
  return SheetOverTable(sheet, neighbours).height_at_most(table, 0);
}

// Five triangles at one edge: two of a part, whose corners are equal by place alone, and three of another.
TEST(WorldSurfaceCover, NeighboursAreThePairsOfOnePart) {
  const TriangleMesh fan{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, -1}, {0, 1, 1}, {0, 0, 0}, {1, 0, 0}},
      {{0, 1, 2}, {0, 1, 3}, {8, 7, 4}, {1, 0, 5}, {6, 0, 1}}};
  const auto neighbours_of = [&](std::vector<std::uint32_t> part_of) {
    const TriangleNeighbours neighbours(fan, part_of);
    return std::vector{neighbours.across(0, 0), neighbours.across(1, 0), neighbours.across(2, 0),
                       neighbours.across(3, 0), neighbours.across(4, 1)};
  };
  constexpr std::uint32_t kNone = TriangleNeighbours::kNone;
  EXPECT_EQ(neighbours_of({0, 1, 0, 1, 1}), (std::vector{2u, kNone, 0u, kNone, kNone}));
  EXPECT_EQ(neighbours_of({0, 1, 2, 1, 0}), (std::vector{4u, 3u, kNone, 1u, 0u}));
  EXPECT_EQ(neighbours_of({0, 0, 0, 0, 0}), (std::vector{kNone, kNone, kNone, kNone, kNone}));
}

// Its border runs along the table's own: taken for running over it, nothing would be known.
TEST(WorldSurfaceCover, AnEqualSheetWhoseBorderIsTheTablesCoversIt) {
  const Triangle table{{0.1, 0.2, 0.3}, {3.1, 0.4, 0.5}, {0.7, 2.2, 1.1}};
  const Vec3 middle = (table.a + table.b + table.c) / 3;
  const TriangleMesh sheet{{table.a, table.b, table.c, middle}, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  EXPECT_LE(height_at_most(TriangleMesh{{table.a, table.b, table.c}, {{0, 1, 2}}}, table), 1e-5);
  // Its middle is a corner of all three, which leaves open what covers it: no bound rather than a wrong one.
  EXPECT_EQ(height_at_most(sheet, table), std::numeric_limits<double>::infinity());
}

using Rational3 = std::array<mpq_class, 3>;
Rational3 motion(const Vec3& to, const Vec3& from) {
  return {mpq_class(to[0]) - mpq_class(from[0]), mpq_class(to[1]) - mpq_class(from[1]),
          mpq_class(to[2]) - mpq_class(from[2])};
}
mpq_class dot(const Rational3& a, const Rational3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Square of a point's distance from the plane of a triangle, rounded once.
double square_from_plane_m2(const Vec3& point, const Triangle& t) {
  const Rational3 p = motion(t.b, t.a);
  const Rational3 q = motion(t.c, t.a);
  const Rational3 normal{p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
  const mpq_class height = dot(normal, motion(point, t.a));
  return mpq_class(height * height / dot(normal, normal)).get_d();
}

// Against rationals, where the sheet's corners are farthest from the table's frame.
TEST(WorldSurfaceCover, TheBoundHoldsUnderASheetOfAMillionMillionTimesItsSize) {
  std::mt19937_64 random = oracle::seeded(131);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto any = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  int bound_count = 0;
  for (int i = 0; i < 500; ++i) {
    const Triangle table{any() * 1e-3, any() * 1e-3, any() * 1e-3};
    const Vec3 normal = (table.b - table.a).cross(table.c - table.a).normalized();
    const Vec3 along = (table.b - table.a).normalized() * 1e9;
    const Vec3 across = normal.cross(along);
    // All but parallel to the table, and about it.
    const TriangleMesh sheet{{along + unit(random) * 1e-4 * normal, across - along + unit(random) * 1e-4 * normal,
                              -along - across + unit(random) * 1e-4 * normal},
                             {{0, 1, 2}}};
    const double bound_m = height_at_most(sheet, table);
    if (!std::isfinite(bound_m)) continue;
    ++bound_count;
    for (const Vec3& corner : {table.a, table.b, table.c}) {
      ASSERT_LE(square_from_plane_m2(corner, sheet.triangle(0)), bound_m * bound_m * (1 + 1e-12)) << i;
    }
  }
  EXPECT_GT(bound_count, 100);
}

}  // namespace
}  // namespace collided::engine
