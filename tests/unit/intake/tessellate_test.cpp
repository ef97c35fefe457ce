#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/mesh/tessellate.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/intake/loading.hpp"

// Curved surfaces as triangles, and how far those are off.  // A1 A21 B8
namespace collided::engine {
namespace {

constexpr double kPi = std::numbers::pi;

double distance_m(const Vec3& p, const TriangleMesh& mesh) {
  double nearest = INFINITY;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    nearest = std::min(nearest, closest(p, mesh.triangle(i)).distance_m);
  return nearest;
}

double volume_of(const TriangleMesh& mesh) {
  double six_times = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    six_times += t.a.dot(t.b.cross(t.c));
  }
  return six_times / 6;
}

/// Both ways by samples: points of the surface to the mesh, and points of the mesh to the surface.
template <class Point, class Distance>
void expect_bound_holds(const Tessellation& surface, const Point& surface_point, const Distance& from_surface_m,
                        std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  double farthest = 0;
  for (int i = 0; i < 300; ++i)
    farthest = std::max(farthest, distance_m(surface_point(unit(random), unit(random)), surface.mesh));
  for (int i = 0; i < 3000; ++i) {
    const Triangle t = surface.mesh.triangle(static_cast<std::uint32_t>(random() % surface.mesh.triangles.size()));
    double u = unit(random), v = unit(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    farthest = std::max(farthest, from_surface_m(t.a + u * (t.b - t.a) + v * (t.c - t.a)));
  }
  EXPECT_LE(farthest, surface.off_by_m);
  EXPECT_GE(farthest, 0.2 * surface.off_by_m) << "the bound says little";
}

void expect_closed(const Tessellation& surface, double volume, int sphere_or_torus) {
  const MeshHealth health = examine(surface.mesh);
  EXPECT_TRUE(health.is_closed);
  EXPECT_TRUE(health.is_consistently_oriented);
  EXPECT_EQ(health.equal_vertex_count, 0u) << "seams and poles are shared";
  EXPECT_EQ(health.zero_area_count, 0u);
  const auto euler = static_cast<int>(health.vertex_count) - static_cast<int>(health.edge_count) +
                     static_cast<int>(health.triangle_count);
  EXPECT_EQ(euler, sphere_or_torus);
  EXPECT_NEAR(volume_of(surface.mesh), volume, 0.05 * volume);
}

TEST(IntakeTessellate, SpheresAndEllipsoids) {
  std::mt19937_64 random = oracle::seeded(101);
  const Tessellation ball = tessellate_sphere(2, {16, 9});
  EXPECT_EQ(ball.mesh.triangles.size(), 256u);
  expect_closed(tessellate_sphere(2, {64, 33}), 4 * kPi / 3 * 8, 2);
  expect_bound_holds(
      ball,
      [](double u, double v) {
        return sphere_point({2 * kPi * u, kPi * v}, 2);
      },
      [](const Vec3& p) { return std::abs(p.norm() - 2); }, random);
  const Vec3 half(1, 2, 3);
  const Tessellation egg = tessellate_ellipsoid(half, {24, 13});
  expect_closed(tessellate_ellipsoid(half, {64, 33}), 4 * kPi / 3 * 6, 2);
  const Tessellation fine = tessellate_ellipsoid(half, {120, 60});
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 300; ++i) {
    const Vec3 on = sphere_point({2 * kPi * unit(random), kPi * unit(random)}, 1).cwiseProduct(half);
    EXPECT_LE(distance_m(on, egg.mesh), egg.off_by_m);
  }
  EXPECT_LT(fine.off_by_m, egg.off_by_m / 15);
}

TEST(IntakeTessellate, CylindersAndCones) {
  std::mt19937_64 random = oracle::seeded(102);
  const Tessellation can = tessellate_cylinder(0.5, 2, {12});
  expect_closed(tessellate_cylinder(0.5, 2, {48}), kPi * 0.25 * 2, 2);
  expect_bound_holds(
      can, [](double u, double v) { return Vec3(0.5 * std::cos(2 * kPi * u), 0.5 * std::sin(2 * kPi * u), 2 * v - 1); },
      [](const Vec3& p) { return std::min(0.5 - std::hypot(p[0], p[1]), 1 - std::abs(p[2])); }, random);
  const Tessellation hat = tessellate_cone(1, 2, {10});
  expect_closed(tessellate_cone(1, 2, {48}), kPi * 2 / 3, 2);
  const auto from_cone_m = [](const Vec3& p) {
    const double slant = std::sqrt(5.0);
    return std::min(p[2] + 1, (1 - p[2] - 2 * std::hypot(p[0], p[1])) / slant);  // inside of it
  };
  expect_bound_holds(
      hat,
      [](double u, double v) {
        return Vec3((1 - v) * std::cos(2 * kPi * u), (1 - v) * std::sin(2 * kPi * u), 2 * v - 1);
      },
      from_cone_m, random);
}

TEST(IntakeTessellate, TorusAndWaves) {
  std::mt19937_64 random = oracle::seeded(103);
  const Tessellation ring = tessellate_torus(2, 0.5, {32, 16});
  expect_closed(ring, 2 * kPi * kPi * 2 * 0.25, 0);
  expect_bound_holds(
      ring,
      [](double u, double v) {
        const double out = 2 + 0.5 * std::cos(2 * kPi * v);
        return Vec3(out * std::cos(2 * kPi * u), out * std::sin(2 * kPi * u), 0.5 * std::sin(2 * kPi * v));
      },
      [](const Vec3& p) { return std::abs(std::hypot(std::hypot(p[0], p[1]) - 2, p[2]) - 0.5); }, random);
  const HeightFunction saddle{[](double x, double y) { return x * x - y * y; }, {-1, -1}, {1, 1}, {2, 0, 2}};
  const Tessellation sheet = tessellate_heights(saddle, {8, 8});
  EXPECT_EQ(sheet.mesh.triangles.size(), 128u);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 500; ++i) {
    const double x = unit(random), y = unit(random);
    EXPECT_LE(distance_m({x, y, x * x - y * y}, sheet.mesh), sheet.off_by_m);
  }
}

/// Bernstein's form: nothing of the product's recurrence.
Vec3 bezier_point(const std::vector<Vec3>& p, double u, double v) {
  const auto weight = [](int i, double t) {
    return (i == 0 || i == 3 ? 1 : 3) * std::pow(t, i) * std::pow(1 - t, 3 - i);
  };
  Vec3 sum = Vec3::Zero();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) sum += weight(column, u) * weight(row, v) * p[4 * row + column];
  }
  return sum;
}

/// The Cox-de Boor recurrence of the basis functions, written down.
double basis(int i, int degree, int count, double t) {
  const auto knot = [&](int k) { return static_cast<double>(std::clamp(k - degree, 0, count - degree)); };
  const std::function<double(int, int)> n = [&](int k, int d) -> double {
    if (d == 0)
      return (knot(k) <= t && t < knot(k + 1)) || (t == count - degree && knot(k + 1) == t && knot(k) < t) ? 1 : 0;
    const double left = knot(k + d) > knot(k) ? (t - knot(k)) / (knot(k + d) - knot(k)) * n(k, d - 1) : 0;
    const double right =
        knot(k + d + 1) > knot(k + 1) ? (knot(k + d + 1) - t) / (knot(k + d + 1) - knot(k + 1)) * n(k + 1, d - 1) : 0;
    return left + right;
  };
  return n(i, degree);
}

TEST(IntakeTessellate, PatchesAreTheSplinesThatTheirBasesSay) {
  std::mt19937_64 random = oracle::seeded(104);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 40; ++round) {
    SplinePatch patch{static_cast<unsigned>(1 + random() % 4), static_cast<unsigned>(1 + random() % 4), 0, {}};
    patch.columns = patch.first_degree + 1 + static_cast<unsigned>(random() % 3);
    const unsigned rows = patch.second_degree + 1 + static_cast<unsigned>(random() % 3);
    for (unsigned i = 0; i < rows * patch.columns; ++i)
      patch.points.emplace_back(unit(random), unit(random), unit(random));
    const auto spans_u = static_cast<double>(patch.columns - patch.first_degree);
    const auto spans_v = static_cast<double>(rows - patch.second_degree);
    const Tessellation surface = tessellate_patch(patch, {5, 4});
    EXPECT_EQ(surface.mesh.triangles.size(), static_cast<std::size_t>(2 * 5 * spans_u * 4 * spans_v));
    for (int i = 0; i < 20; ++i) {
      const double u = i == 0 ? spans_u : spans_u * unit(random);
      const double v = i == 1 ? spans_v : spans_v * unit(random);
      Vec3 expected = Vec3::Zero();
      for (unsigned row = 0; row < rows; ++row) {
        for (unsigned column = 0; column < patch.columns; ++column) {
          expected += basis(static_cast<int>(column), static_cast<int>(patch.first_degree),
                            static_cast<int>(patch.columns), u) *
                      basis(static_cast<int>(row), static_cast<int>(patch.second_degree), static_cast<int>(rows), v) *
                      patch.points[row * patch.columns + column];
        }
      }
      ASSERT_NEAR((patch.at(u, v) - expected).norm(), 0, 1e-12) << round;
      ASSERT_LE(distance_m(expected, surface.mesh), surface.off_by_m) << round;
    }
  }
}

TEST(IntakeTessellate, ABezierPatchIsTheSplineOfOneSpan) {
  std::mt19937_64 random = oracle::seeded(105);
  std::uniform_real_distribution<double> unit(-1, 1);
  SplinePatch patch{3, 3, 4, {}};
  for (int i = 0; i < 16; ++i)
    patch.points.emplace_back(i % 4 + 0.3 * unit(random), i / 4 + 0.3 * unit(random), unit(random));
  const Tessellation surface = tessellate_patch(patch, {.error_m = 0.02});
  EXPECT_LE(surface.off_by_m, 0.02 + 1e-9);
  for (int i = 0; i < 200; ++i) {
    const Vec3 on = bezier_point(patch.points, std::abs(unit(random)), std::abs(unit(random)));
    EXPECT_LE(distance_m(on, surface.mesh), surface.off_by_m);
  }
}

// Without curvature the bound is what roundings leave, and they do leave something.
TEST(IntakeTessellate, AFlatPatchIsOffByRoundingsAlone) {
  std::mt19937_64 random = oracle::seeded(106);
  std::uniform_real_distribution<double> unit(0, 1);
  const Vec3 origin(1e3 + 0.1, 0.2, -7.3), along(0.3, 0.7, 0.1), across(-0.2, 0.4, 0.9);
  const SplinePatch patch{1, 1, 2, {origin, origin + along, origin + across, origin + along + across}};
  const Tessellation surface = tessellate_patch(patch, {7, 11});
  double farthest = 0;
  for (int i = 0; i < 300; ++i)
    farthest = std::max(farthest, distance_m(origin + unit(random) * along + unit(random) * across, surface.mesh));
  EXPECT_GT(farthest, 0);
  EXPECT_LE(farthest, surface.off_by_m);
  EXPECT_LT(surface.off_by_m, 1e-10);
}

// A1: twice the pieces, a quarter of the error; by error, no more than asked and not many more triangles than needed.
TEST(IntakeTessellate, TheErrorFallsByFourWhenThePiecesDouble) {
  const auto falls = [](const auto& make) {
    const double ratio = make(Fineness{32, 32}).off_by_m / make(Fineness{64, 64}).off_by_m;
    EXPECT_NEAR(ratio, 4, 0.1);
    const Tessellation asked = make(Fineness{.error_m = 1e-3});
    EXPECT_LE(asked.off_by_m, 1e-3 * (1 + 1e-9));
    EXPECT_GE(asked.off_by_m, 0.85e-3);
  };
  falls([](const Fineness& f) { return tessellate_sphere(1, f); });
  falls([](const Fineness& f) { return tessellate_ellipsoid({1, 2, 3}, f); });
  falls([](const Fineness& f) { return tessellate_cylinder(1, 2, f); });
  falls([](const Fineness& f) { return tessellate_cone(1, 2, f); });
  falls([](const Fineness& f) { return tessellate_torus(2, 0.5, f); });
  falls([](const Fineness& f) {
    return tessellate_heights({[](double x, double y) { return std::sin(x) * y; }, {0, 0}, {1, 1}, {1, 1, 0}}, f);
  });
}

TEST(IntakeTessellate, NonsenseIsRefused) {
  EXPECT_THROW(tessellate_sphere(-1, {8, 8}), std::invalid_argument);
  EXPECT_THROW(tessellate_sphere(NAN, {8, 8}), std::invalid_argument);
  EXPECT_THROW(tessellate_sphere(1, {2, 8}), std::invalid_argument);
  EXPECT_THROW(tessellate_sphere(1, {.error_m = -1}), std::invalid_argument);
  EXPECT_THROW(tessellate_sphere(1, {.error_m = 1e-15}), std::invalid_argument);
  EXPECT_THROW(tessellate_sphere(1, {100'000, 100'000}), std::invalid_argument);
  EXPECT_THROW(tessellate_torus(1, 2, {8, 8}), std::invalid_argument);
  EXPECT_THROW(tessellate_patch({3, 3, 3, std::vector<Vec3>(12)}, {4, 4}), std::invalid_argument);
  EXPECT_THROW(tessellate_patch({9, 1, 10, std::vector<Vec3>(20)}, {4, 4}), std::invalid_argument);
}

// A21: where a ray meets the sphere, the two parameters lead back to the point; at the poles and on the seam too.
TEST(IntakeTessellate, RayHitsOnTheExplicitSphereComeBackByTheirParameters) {
  std::mt19937_64 random = oracle::seeded(121);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double radius_m : {1e-6, 1.0, 1e6}) {
    const Sphere sphere{Vec3::Zero(), radius_m};
    for (int i = 0; i < 3000; ++i) {
      Vec3 aim(unit(random), unit(random), unit(random));
      if (i % 10 == 0) aim = {0, 0, i % 20 == 0 ? 1.0 : -1.0};                      // a pole
      if (i % 10 == 1) aim = {std::abs(aim[0]), i % 20 == 1 ? 0.0 : -0.0, aim[2]};  // the seam
      if (i % 10 == 2) aim = {std::abs(aim[0]), -1e-17, aim[2]};
      RayHit hit;
      const Ray ray{3 * radius_m * aim.normalized(), -aim, 10 * radius_m / aim.norm()};
      if (!cast_ray(ray, sphere, hit).yes()) continue;
      const Vec3 point = ray.origin + hit.distance_m * ray.direction.normalized();
      const SphereParameters at = sphere_parameters(point);
      EXPECT_GE(at.longitude_rad, 0);
      EXPECT_LT(at.longitude_rad, 2 * kPi);
      EXPECT_GE(at.colatitude_rad, 0);
      EXPECT_LE(at.colatitude_rad, kPi);
      EXPECT_LE((sphere_point(at, radius_m) - point).norm(), 1e-12 * radius_m) << aim.transpose();
    }
  }
}

TEST(IntakeSurfaceFile, SurfacesBecomePartsAndTheReportSaysTheirError) {
  const test::Loaded loaded =
      test::load("a.surfaces", "# two\nglobe sphere 1 at 0 0 3 count 16 9\nring torus 2 0.5 error 0.1\n");
  ASSERT_EQ(loaded.scene.parts.size(), 2u);
  EXPECT_EQ(loaded.scene.parts[0].name, "a/globe");
  EXPECT_EQ(loaded.scene.parts[0].triangle_count, 256u);
  ASSERT_EQ(loaded.report.notes.size(), 2u);
  EXPECT_EQ(loaded.report.notes[0], "'globe': sphere as 256 triangles, off by at most 0.0343 of the file's units");
  EXPECT_EQ(test::complaint("a.surfaces", "a sphere 1\n"),
            "a.surfaces: line 1: how finely is not said: 'count N', 'count N M' or 'error E' ends the line. Nothing "
            "was loaded.");
  EXPECT_NE(test::complaint("a.surfaces", "a sphere 1 2 count 4\n").find("2 numbers, this kind takes 1"),
            std::string::npos);
  EXPECT_NE(test::complaint("a.surfaces", "a sphere x count 4\n").find("'x' is no number"), std::string::npos);
  EXPECT_NE(test::complaint("a.surfaces", "a blob 1 count 4\n").find("surface 'blob', allowed are"), std::string::npos);
}

// No kind stands on its side, no place or number changes with another, no surface takes another's corners.
TEST(IntakeSurfaceFile, EachSurfaceStandsAtItsPlaceWithItsOwnSizes) {
  const Scene scene = test::load("a.surfaces",
                                 "egg ellipsoid 1 2 3 at 10 -20 30 count 64 32\ncan cylinder 0.5 4 at 1 2 3 count "
                                 "8\nhat cone 2 3 at -7 5 1 count 8\n"
                                 "ring torus 3 0.5 at 0 0 9 count 8 8\nsea waves 4 2 0.5 0.25 3 at 1 2 3 count 8 4\n"
                                 "sheet patch 1 1 2 2 0 0 0 4 0 1 0 6 2 4 6 3 at 100 200 300 count 1\n")
                          .scene;
  const auto bounds = [&](std::size_t part) {
    Aabb box;
    for (std::uint32_t i = 0; i < scene.parts.at(part).triangle_count; ++i) {
      const Triangle t = scene.mesh.triangle(scene.parts[part].first_triangle + i);
      for (const Vec3& corner : {t.a, t.b, t.c}) {
        box.low = box.low.cwiseMin(corner);
        box.high = box.high.cwiseMax(corner);
      }
    }
    return box;
  };
  const auto expect_bounds = [&](std::size_t part, const Vec3& low, const Vec3& high) {
    const Aabb box = bounds(part);
    EXPECT_LT((box.low - low).norm(), 1e-12) << scene.parts[part].name << ' ' << box.low.transpose();
    EXPECT_LT((box.high - high).norm(), 1e-12) << scene.parts[part].name << ' ' << box.high.transpose();
  };
  ASSERT_EQ(scene.parts.size(), 6u);
  expect_bounds(0, {9, -22, 27}, {11, -18, 33});
  expect_bounds(1, {0.5, 1.5, 1}, {1.5, 2.5, 5});
  expect_bounds(2, {-9, 3, -0.5}, {-5, 7, 2.5});
  expect_bounds(3, {-3.5, -3.5, 8.5}, {3.5, 3.5, 9.5});
  EXPECT_LT((bounds(4).low - Vec3(-1, 1, 0)).head<2>().norm(), 1e-12);
  EXPECT_LT((bounds(4).high - Vec3(3, 3, 0)).head<2>().norm(), 1e-12);
  expect_bounds(5, {100, 200, 300}, {104, 206, 303});
  for (std::uint32_t i = 0; i < scene.parts[4].triangle_count; ++i) {
    const Vec3 p = scene.mesh.triangle(scene.parts[4].first_triangle + i).b;
    EXPECT_NEAR(p[2], 3 + 0.5 * std::sin(0.25 * (p[0] - 1)) * std::sin(3 * (p[1] - 2)), 1e-12);
  }
  // The cone's apex is up.
  for (std::uint32_t i = 0; i < scene.parts[2].triangle_count; ++i) {
    const Triangle t = scene.mesh.triangle(scene.parts[2].first_triangle + i);
    for (const Vec3& p : {t.a, t.b, t.c}) {
      if (p[2] > 1) { EXPECT_LT((p - Vec3(-7, 5, 2.5)).norm(), 1e-12); }
    }
  }
}

// The sagitta of three slices, to the bit: who asks for just that needs no fourth.
TEST(IntakeTessellate, AnErrorThatTheFewestPiecesJustKeepTakesNoMore) {
  const double half = std::sin(kPi / 3 / 2);
  const double sagitta = 2 * half * half;
  const auto triangles = [](const Fineness& how) { return tessellate_cylinder(1, 2, how).mesh.triangles.size(); };
  EXPECT_EQ(triangles({.error_m = sagitta}), triangles({.first = 3, .second = 1}));
  EXPECT_EQ(triangles({.error_m = std::nextafter(sagitta, 0)}), triangles({.first = 4, .second = 1}));
  EXPECT_EQ(triangles({.error_m = 10}), triangles({.first = 3, .second = 1}));
}

}  // namespace
}  // namespace collided::engine
