#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <numeric>
#include <random>

#include "server/intake/limits.hpp"
#include "server/intake/planar.hpp"
#include "server/intake/triangulate.hpp"

namespace collided {
namespace {

__extension__ using Wide = __int128;

struct GridPoint {
  std::int64_t x;
  std::int64_t y;
};

Wide twice_area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return Wide{b.x - a.x} * (c.y - a.y) - Wide{b.y - a.y} * (c.x - a.x);
}

Wide twice_area(const std::vector<GridPoint>& polygon) {
  Wide sum = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    sum += twice_area(polygon[0], polygon[i - 1], polygon[i]);
  }
  return sum;
}

/// The plane z = 2 x - 3 y, with the axes renamed: everything stays a whole number.
Vec3 lifted(const GridPoint& p, int renaming) {
  const auto x = static_cast<double>(p.x);
  const auto y = static_cast<double>(p.y);
  const double z = 2 * x - 3 * y;
  return renaming % 3 == 0 ? Vec3(x, y, z) : renaming % 3 == 1 ? Vec3(y, z, x) : Vec3(z, x, y);
}

/// Triangles that all turn the polygon's way and whose areas sum to the polygon's cover it once: no gap, no overlap.
void expect_exact_cover(const std::vector<GridPoint>& polygon, int renaming) {
  std::vector<Vec3> vertices;
  for (const GridPoint& p : polygon) {
    vertices.push_back(lifted(p, renaming));
  }
  std::vector<std::uint32_t> corners(polygon.size());
  std::iota(corners.begin(), corners.end(), 0u);
  std::vector<TriangleCorners> triangles;
  const PolygonKind kind = triangulate(corners, vertices, triangles);
  ASSERT_TRUE(kind == PolygonKind::convex || kind == PolygonKind::concave);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  const Wide whole = twice_area(polygon);
  Wide sum = 0;
  for (const TriangleCorners& t : triangles) {
    const Wide area = twice_area(polygon[t[0]], polygon[t[1]], polygon[t[2]]);
    EXPECT_TRUE(whole > 0 ? area >= 0 : area <= 0);
    sum += area;
  }
  EXPECT_TRUE(sum == whole);
}

bool crosses(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  const auto side = [](const GridPoint& p, const GridPoint& q, const GridPoint& r) {
    const Wide area = twice_area(p, q, r);
    return area > 0 ? 1 : (area < 0 ? -1 : 0);
  };
  return side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0;
}

/// Random points, joined, then untangled: of two edges that cross, the path between is turned round.
std::vector<GridPoint> random_simple_polygon(std::mt19937_64& random, std::size_t count) {
  std::uniform_int_distribution<std::int64_t> coordinate(-1'000'000, 1'000'000);
  std::vector<GridPoint> p(count);
  for (GridPoint& point : p) {
    point = {coordinate(random), coordinate(random)};
  }
  for (bool is_tangled = true; is_tangled;) {
    is_tangled = false;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 2; j < count; ++j) {
        if ((j + 1) % count != i && crosses(p[i], p[i + 1], p[j], p[(j + 1) % count])) {
          std::reverse(p.begin() + static_cast<std::ptrdiff_t>(i) + 1, p.begin() + static_cast<std::ptrdiff_t>(j) + 1);
          is_tangled = true;
        }
      }
    }
  }
  return p;
}

TEST(IntakeTriangulate, RandomSimplePolygonsAreCoveredExactlyOnce) {
  const char* given = std::getenv("COLLIDED_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (int i = 0; i < 1000; ++i) {
    std::vector<GridPoint> polygon = random_simple_polygon(random, 4 + random() % 30);
    expect_exact_cover(polygon, i);
    std::reverse(polygon.begin(), polygon.end());
    expect_exact_cover(polygon, i);
    if (HasFailure()) {
      FAIL() << "seed " << seed << ", polygon " << i;
    }
  }
}

TEST(IntakeTriangulate, CornersOnStraightEdgesAreKept) {
  expect_exact_cover({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 2}, {0, 2}}, 0);
  expect_exact_cover({{0, 0}, {2, 0}, {4, 0}, {4, 4}, {2, 4}, {2, 2}, {2, 1}, {0, 1}}, 1);
}

TEST(IntakeTriangulate, AHoleJoinedByADoubledEdgeIsCovered) {
  expect_exact_cover({{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {2, 2}, {2, 4}, {4, 4}, {4, 2}, {2, 2}}, 0);
}

TEST(IntakeTriangulate, CombsAndSpiralsAreCovered) {
  std::vector<GridPoint> comb = {{0, -10}};
  for (std::int64_t i = 0; i < 500; ++i) {
    comb.push_back({-2 * i, 100 + i % 7});
    comb.push_back({-2 * i - 1, 0});
  }
  comb.push_back({-999, -10});
  expect_exact_cover(comb, 2);
  std::vector<GridPoint> spiral;
  for (std::int64_t i = 1; i < 200; ++i) {  // outward along the outer side, back along the inner one
    const std::int64_t r = 4 * i;
    spiral.push_back(i % 4 == 0   ? GridPoint{r, -r}
                     : i % 4 == 1 ? GridPoint{r, r}
                     : i % 4 == 2 ? GridPoint{-r, r}
                                  : GridPoint{-r, -r});
  }
  for (std::int64_t i = 199; i > 1; --i) {
    const std::int64_t r = 4 * i - 5;
    spiral.push_back(i % 4 == 0   ? GridPoint{r, -r}
                     : i % 4 == 1 ? GridPoint{r, r}
                     : i % 4 == 2 ? GridPoint{-r, r}
                                  : GridPoint{-r, -r});
  }
  expect_exact_cover(spiral, 1);
}

TEST(IntakeTriangulate, ABowtieIsCalledCrossing) {
  const std::vector<Vec3> vertices = {{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}};
  const std::vector<std::uint32_t> corners = {0, 1, 2, 3};
  std::vector<TriangleCorners> triangles;
  EXPECT_EQ(triangulate(corners, vertices, triangles), PolygonKind::crossing);
  EXPECT_EQ(triangles.size(), 2u);
}

TEST(IntakeTriangulate, AStarThatTurnsOneWayTwiceRoundIsCalledCrossing) {
  const std::vector<Vec3> vertices = {{0, 100, 0}, {-59, -81, 0}, {95, 31, 0}, {-95, 31, 0}, {59, -81, 0}};
  const std::vector<std::uint32_t> corners = {0, 1, 2, 3, 4};
  std::vector<TriangleCorners> triangles;
  EXPECT_EQ(triangulate(corners, vertices, triangles), PolygonKind::crossing);
}

TEST(IntakeTriangulate, OnlyConcavePolygonsHaveALimit) {
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i <= kMaxConcaveCorners; ++i) {
    const auto x = static_cast<double>(i);
    vertices.emplace_back(x, x * x, 0);
  }
  std::vector<std::uint32_t> corners(vertices.size());
  std::iota(corners.begin(), corners.end(), 0u);
  std::vector<TriangleCorners> triangles;
  EXPECT_EQ(triangulate(corners, vertices, triangles), PolygonKind::convex);
  vertices[5][1] += 7;
  triangles.clear();
  EXPECT_EQ(triangulate(corners, vertices, triangles), PolygonKind::too_long);
  EXPECT_TRUE(triangles.empty());
}

// The grid of Kettner et al., "Classroom examples of robustness problems", 2008, where the plain determinant fails.
TEST(IntakePlanar, NearlyStraightTurnsAreExact) {
  const double step = std::ldexp(1.0, -53);
  int plain_failures = 0;
  for (std::int64_t i = 0; i < 256; ++i) {
    for (std::int64_t j = 0; j < 256; ++j) {
      const PlanePoint p = {0.5 + static_cast<double>(i) * step, 0.5 + static_cast<double>(j) * step};
      const PlanePoint q = {12, 12};
      const PlanePoint r = {24, 24};
      // In units of the step everything is a whole number, and q and r lie on the diagonal.
      const auto in_steps = [](double x) { return static_cast<std::int64_t>(std::ldexp(x, 53)); };
      const Wide exact =
          twice_area({in_steps(p[0]), in_steps(p[1])}, {in_steps(12), in_steps(12)}, {in_steps(24), in_steps(24)});
      const int sign = exact > 0 ? 1 : (exact < 0 ? -1 : 0);
      ASSERT_EQ(turn(p, q, r), sign) << i << ' ' << j;
      ASSERT_EQ(turn(q, p, r), -sign) << i << ' ' << j;
      ASSERT_EQ(turn(q, r, p), sign) << i << ' ' << j;
      const double plain = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
      plain_failures += plain * sign < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(plain_failures, 100);  // the wrong side, not merely none
}

}  // namespace
}  // namespace collided
