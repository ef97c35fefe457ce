#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <numeric>
#include <map>
#include <random>
#include <set>

#include "server/intake/limits.hpp"
#include "server/intake/polygons/crossing_polygon.hpp"
#include "server/intake/polygons/planar.hpp"
#include "server/intake/polygons/sweep_triangulation.hpp"
#include "server/intake/polygons/triangulate.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
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
  for (std::size_t i = 2; i < polygon.size(); ++i) { sum += twice_area(polygon[0], polygon[i - 1], polygon[i]); }
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
  for (const GridPoint& p : polygon) { vertices.push_back(lifted(p, renaming)); }
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
  for (GridPoint& point : p) { point = {coordinate(random), coordinate(random)}; }
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
    if (HasFailure()) { FAIL() << "seed " << seed << ", polygon " << i; }
  }
}

TEST(IntakeTriangulate, CornersOnStraightEdgesAreKept) {
  expect_exact_cover({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 2}, {0, 2}}, 0);
  expect_exact_cover({{0, 0}, {2, 0}, {4, 0}, {4, 4}, {2, 4}, {2, 2}, {2, 1}, {0, 1}}, 1);
}

// Corners on straight edges are ears without area; once clipped they are in nobody's way.
TEST(IntakeTriangulate, RandomPolygonsWithCornersOnTheirEdgesAreCoveredExactlyOnce) {
  std::mt19937_64 random = oracle::seeded(417);
  for (int i = 0; i < 300 && !::testing::Test::HasFailure(); ++i) {
    std::vector<GridPoint> polygon;
    const std::vector<GridPoint> plain = random_simple_polygon(random, 4 + random() % 12);
    for (std::size_t k = 0; k < plain.size(); ++k) {
      const GridPoint a{4 * plain[k].x, 4 * plain[k].y};
      const GridPoint b{4 * plain[(k + 1) % plain.size()].x, 4 * plain[(k + 1) % plain.size()].y};
      polygon.push_back(a);
      for (const std::int64_t quarter : {1, 2, 3}) {
        if (random() % 3 == 0) polygon.push_back({a.x + (b.x - a.x) / 4 * quarter, a.y + (b.y - a.y) / 4 * quarter});
      }
    }
    expect_exact_cover(polygon, i);
    std::reverse(polygon.begin(), polygon.end());
    expect_exact_cover(polygon, i);
  }
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

TEST(IntakeTriangulate, OnlyPolygonsThatCrossThemselvesHaveALimit) {
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
  EXPECT_EQ(triangulate(corners, vertices, triangles), PolygonKind::concave);
  EXPECT_EQ(triangles.size(), corners.size() - 2);
  std::swap(vertices[7], vertices[8]);
  triangles.clear();
  EXPECT_EQ(triangulate(corners, vertices, triangles), PolygonKind::too_long);
  EXPECT_TRUE(triangles.empty());
}

std::mt19937_64 seeded_random() {
  const char* given = std::getenv("COLLIDED_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  std::cout << "COLLIDED_SEED=" << seed << '\n';
  return std::mt19937_64(seed);
}

std::vector<PlanePoint> plane_points(const std::vector<GridPoint>& polygon) {
  std::vector<PlanePoint> points;
  for (const GridPoint& p : polygon) points.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
  return points;
}

/// Rings cut by the sweep: as many triangles as there must be, all to the left, their areas those of the rings.  // A1
void expect_swept(const std::vector<std::vector<GridPoint>>& rings) {
  std::vector<GridPoint> all;
  std::vector<std::uint32_t> ends;
  Wide area = 0;
  for (const auto& ring : rings) {
    all.insert(all.end(), ring.begin(), ring.end());
    ends.push_back(static_cast<std::uint32_t>(all.size()));
    const Wide own = twice_area(ring) < 0 ? -twice_area(ring) : twice_area(ring);
    area += ends.size() == 1 ? own : -own;
  }
  std::vector<TriangleCorners> triangles;
  ASSERT_FALSE(triangulate_by_sweep(plane_points(all), ends, triangles));
  ASSERT_EQ(triangles.size(), all.size() + 2 * (rings.size() - 1) - 2);
  Wide sum = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const TriangleCorners& t : triangles) {
    const Wide own = twice_area(all[t[0]], all[t[1]], all[t[2]]);
    EXPECT_TRUE(own >= 0);
    sum += own;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      balance[{low, high}] += t[k] == low ? 1 : -1;
    }
  }
  EXPECT_TRUE(sum == area);
  // The border is that of the rings, edge by edge: what is left over when inner edges cancel.
  std::size_t border_count = 0;
  for (const auto& [edge, count] : balance) border_count += count != 0;
  EXPECT_EQ(border_count, all.size());
}

TEST(IntakeSweep, RandomSimplePolygonsAreCoveredExactlyOnce) {
  std::mt19937_64 random = seeded_random();
  for (int i = 0; i < 400 && !::testing::Test::HasFailure(); ++i) {
    std::vector<GridPoint> polygon = random_simple_polygon(random, 3 + random() % (i % 20 == 0 ? 150 : 25));
    expect_swept({polygon});
    std::reverse(polygon.begin(), polygon.end());
    expect_swept({polygon});
  }
}

// Cells of a lattice, joined as long as no two meet at a corner alone: collinear corners, equal x, holes of any form.
TEST(IntakeSweep, LatticesWithHolesAreCoveredExactlyOnce) {
  std::mt19937_64 random = seeded_random();
  for (int i = 0; i < 300 && !::testing::Test::HasFailure(); ++i) {
    const auto n = static_cast<std::int64_t>(2 + random() % 8);
    std::vector<std::vector<GridPoint>> rings{{{0, 0}}};
    for (std::int64_t side = 0; side < 4; ++side) {  // a square with a corner every 3
      for (std::int64_t k = side == 0 ? 1 : 0; k < n; ++k) {
        const std::int64_t at = 3 * k;
        rings[0].push_back(side == 0   ? GridPoint{at, 0}
                           : side == 1 ? GridPoint{3 * n, at}
                           : side == 2 ? GridPoint{3 * (n - k), 3 * n}
                                       : GridPoint{0, 3 * n - at});
      }
    }
    for (std::int64_t x = 0; x < n; ++x) {
      for (std::int64_t y = 0; y < n; ++y) {
        const GridPoint low{3 * x + 1, 3 * y + 1};
        switch (random() % 4) {
          case 0: rings.push_back({low, {low.x + 1, low.y}, {low.x + 1, low.y + 1}, {low.x, low.y + 1}}); break;
          case 1: rings.push_back({low, {low.x, low.y + 1}, {low.x + 1, low.y}}); break;
          default: break;
        }
      }
    }
    expect_swept(rings);
  }
}

bool touches_itself(const std::vector<GridPoint>& p) {
  const std::size_t n = p.size();
  const auto side = [](const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    const Wide area = twice_area(a, b, c);
    return area > 0 ? 1 : area < 0 ? -1 : 0;
  };
  const auto on = [&](const GridPoint& a, const GridPoint& b, const GridPoint& q) {
    return side(a, b, q) == 0 && std::min(a.x, b.x) <= q.x && q.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= q.y &&
           q.y <= std::max(a.y, b.y);
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      const GridPoint &a = p[i], &b = p[(i + 1) % n], &c = p[k];
      if (k != i && k != (i + 1) % n && on(a, b, c)) return true;
      if (i != k && a.x == c.x && a.y == c.y) return true;
      const GridPoint& d = p[(k + 1) % n];
      if (k != i && side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0) return true;
    }
  }
  return false;
}

TEST(IntakeSweep, AFlawIsFoundExactlyWhereThereIsOne) {
  std::mt19937_64 random = seeded_random();
  int simple_count = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::size_t count = 3 + random() % 7;
    std::vector<GridPoint> polygon(count);
    const std::uint64_t reach = 4 + random() % 20;
    for (GridPoint& p : polygon)
      p = {static_cast<std::int64_t>(random() % reach), static_cast<std::int64_t>(random() % reach)};
    std::vector<TriangleCorners> triangles;
    const std::vector<std::uint32_t> ends{static_cast<std::uint32_t>(count)};
    const bool has_flaw = triangulate_by_sweep(plane_points(polygon), ends, triangles).has_value();
    ASSERT_EQ(has_flaw, touches_itself(polygon)) << i;
    simple_count += !has_flaw;
    if (!has_flaw) expect_swept({polygon});
    if (HasFailure()) FAIL() << i;
  }
  EXPECT_GT(simple_count, 1000);
}

TEST(IntakeSweep, AHoleOutsideOrOverTheBorderIsRefused) {
  const auto flaw = [](const std::vector<GridPoint>& hole) {
    std::vector<GridPoint> all{{0, 0}, {9, 0}, {9, 9}, {0, 9}};
    all.insert(all.end(), hole.begin(), hole.end());
    std::vector<TriangleCorners> triangles;
    const std::vector<std::uint32_t> ends{4, static_cast<std::uint32_t>(all.size())};
    return triangulate_by_sweep(plane_points(all), ends, triangles).has_value();
  };
  EXPECT_FALSE(flaw({{2, 2}, {4, 2}, {3, 4}}));
  EXPECT_TRUE(flaw({{12, 2}, {14, 2}, {13, 4}})) << "outside";
  EXPECT_TRUE(flaw({{2, 2}, {14, 2}, {13, 4}})) << "across the border";
  EXPECT_TRUE(flaw({{0, 2}, {4, 2}, {3, 4}})) << "touching it";
  EXPECT_TRUE(flaw({{2, 2}, {4, 2}}));
  EXPECT_TRUE(flaw({{2, 2}, {4, 2}, {6, 2}})) << "without area";
}

TEST(IntakeTriangulate, HolesInSpaceKeepTheOuterRingsSide) {
  const std::vector<Vec3> v{{0, 0, 1}, {0, 6, 1}, {6, 6, 1}, {6, 0, 1},
                            {2, 2, 1}, {4, 2, 1}, {4, 4, 1}, {2, 4, 1}};  // seen from above: to the right
  const std::vector<std::uint32_t> corners{0, 1, 2, 3, 4, 5, 6, 7};
  const std::vector<std::uint32_t> ends{4, 8};
  std::vector<TriangleCorners> triangles;
  EXPECT_EQ(triangulate_with_holes(corners, ends, v, triangles), PolygonKind::concave);
  ASSERT_EQ(triangles.size(), 8u);
  double area = 0;
  for (const TriangleCorners& t : triangles) area += (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]])[2] / 2;
  EXPECT_EQ(area, -(36 - 4));
}

/// Twice the area of each lobe's triangles along z, added up by sign.
std::pair<double, double> areas(const std::vector<Vec3>& v, const std::vector<TriangleCorners>& triangles) {
  std::pair<double, double> sum{0, 0};
  for (const TriangleCorners& t : triangles) {
    const double twice = (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]])[2];
    (twice > 0 ? sum.first : sum.second) += twice;
  }
  return sum;
}

// A3: both lobes keep their area, edges their direction.
TEST(IntakeBowtie, IsSplitAtTheCrossing) {
  std::vector<Vec3> v = {{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 4, 0}};
  const std::vector<std::uint32_t> corners = {0, 1, 2, 3};
  const std::vector<TriangleCorners> triangles = split_at_crossings(corners, v);
  ASSERT_EQ(triangles.size(), 2u);
  ASSERT_EQ(v.size(), 5u);
  EXPECT_EQ(v[4], Vec3(2, 2, 0));
  EXPECT_EQ(areas(v, triangles), std::pair(8.0, -8.0));
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const TriangleCorners& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
  }
  for (const auto& edge : {std::pair{0u, 4u}, {4u, 1u}, {1u, 2u}, {2u, 4u}, {4u, 3u}, {3u, 0u}})
    EXPECT_TRUE(edges.contains(edge)) << edge.first << edge.second;
}

TEST(IntakeBowtie, AStarAndAnAsymmetricOneKeepTheirLobes) {
  std::vector<Vec3> star = {{0, 100, 0}, {-59, -81, 0}, {95, 31, 0}, {-95, 31, 0}, {59, -81, 0}};
  const std::vector<std::uint32_t> corners = {0, 1, 2, 3, 4};
  const Wide whole = twice_area({{0, 100}, {-59, -81}, {95, 31}, {-95, 31}, {59, -81}});  // the middle counts twice
  const std::vector<TriangleCorners> triangles = split_at_crossings(corners, star);
  EXPECT_EQ(triangles.size(), 3u);
  const auto [left, right] = areas(star, triangles);
  EXPECT_NEAR(left + right, static_cast<double>(whole), 1e-9);
  std::vector<Vec3> uneven = {{0, 0, 3}, {10, 0, 3}, {0, 2, 3}, {4, -2, 3}};
  const std::vector<std::uint32_t> four = {0, 1, 2, 3};
  const std::vector<TriangleCorners> lobes = split_at_crossings(four, uneven);
  ASSERT_EQ(lobes.size(), 2u);
  const auto [one, other] = areas(uneven, lobes);
  EXPECT_NEAR(one + other, static_cast<double>(twice_area({{0, 0}, {10, 0}, {0, 2}, {4, -2}})), 1e-12);
  EXPECT_EQ(uneven.back()[2], 3);
  std::vector<Vec3> simple = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {1, 1, 0}};
  EXPECT_TRUE(split_at_crossings(four, simple).empty());
  EXPECT_EQ(simple.size(), 4u);
}

// A quad twisted in space only looks like a bowtie: a point between its edges would tear it off its neighbours.
TEST(IntakeBowtie, ATwistedPolygonIsNotSplit) {
  std::vector<Vec3> v = {{0, 0, 0}, {4, 4, 1}, {4, 0, 0}, {0, 4, 0}};
  const std::vector<std::uint32_t> corners = {0, 1, 2, 3};
  EXPECT_TRUE(split_at_crossings(corners, v).empty());
  EXPECT_EQ(v.size(), 4u);
}

TEST(IntakeBowtie, TheReportSaysWhatWasGuessedAndStrictRefuses) {
  const std::string obj = "v 0 0 0\nv 4 4 0\nv 4 0 0\nv 0 4 0\nv 9 0 0\nv 9 4 0.5\nf 3 5 6 2\nf 1 2 3 4\n";
  const std::string off = "OFF\n6 2 0\n0 0 0\n4 4 0\n4 0 0\n0 4 0\n9 0 0\n9 4 0.5\n4 2 4 5 1\n4 0 1 2 3\n";
  for (const auto& [file, text] : {std::pair{std::string("bowtie.obj"), obj}, {std::string("bowtie.off"), off}}) {
    const test::Loaded loaded = test::load(file, text);
    ASSERT_EQ(loaded.report.mended.size(), 1u) << file;
    EXPECT_NE(loaded.report.mended[0].find("1 polygons that cross themselves split at 1 crossings; a guess"),
              std::string::npos)
        << file;
    ASSERT_FALSE(loaded.report.warnings.empty());
    EXPECT_NE(loaded.report.warnings[0].find("1 polygons are not flat, the worst by 0.1"), std::string::npos)
        << loaded.report.warnings[0];
    EXPECT_EQ(loaded.scene.mesh.vertices.size(), 7u);
    const auto [left, right] =
        areas(loaded.scene.mesh.vertices, {loaded.scene.mesh.triangles.begin() + 2, loaded.scene.mesh.triangles.end()});
    EXPECT_EQ(left, 8);
    EXPECT_EQ(right, -8);
    EXPECT_NE(test::complaint(file, text, {.strict = true}).find("crosses or touches itself"), std::string::npos);
  }
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
}  // namespace collided::engine
