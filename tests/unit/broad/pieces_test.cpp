#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_pieces.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

/// Long slanted triangles among small ones.
TriangleMesh needles(std::uint32_t small, std::uint32_t slanted, std::uint64_t seed) {
  TriangleMesh mesh = scenes::scattered(small, 0.02, seed);
  scenes::append(mesh, scenes::slanted(slanted, 1, seed + 1));
  return mesh;
}

Bvh best(const TriangleMesh& mesh) {
  return Bvh::build(mesh, {.threads = 2, .progress = {}, .cancelled = {}, .form = BvhForm::best});
}

bool is_in(const bvh::Primitive& box, const Vec3& point) {
  bool all = true;
  for (int axis = 0; axis < 3; ++axis) {
    all =
        all && static_cast<double>(box.low[axis]) <= point[axis] && point[axis] <= static_cast<double>(box.high[axis]);
  }
  return all;
}

// Points of a triangle, its edges and corners, and points on the planes of the cuts, which belong to both sides.
TEST(BvhPieces, CoverEveryPointOfTheTriangle) {
  std::mt19937_64 random = oracle::seeded(4);
  std::uniform_real_distribution<double> part(0, 1);
  TriangleMesh mesh = scenes::scattered(60, 1, random());
  scenes::append(mesh, needles(20, 40, random()));
  const bvh::MeshFrame found = bvh::mesh_frame(mesh, 1);
  for (std::uint32_t number = 0; number < mesh.triangles.size(); ++number) {
    const auto asked = static_cast<std::uint32_t>(1 + random() % bvh::kMaxPieces);
    bvh::Primitive pieces[bvh::kMaxPieces];
    const std::uint32_t count = bvh::cover(mesh, found.frame, number, asked, pieces);
    ASSERT_GE(count, 1u);
    ASSERT_LE(count, asked);
    const Triangle world = mesh.triangle(number);
    for (int i = 0; i < 300; ++i) {
      double u = i % 3 == 0 ? 0 : part(random);
      double v = i % 5 == 0 ? 1 - u : part(random);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3 point = found.frame.to_local(world.a + u * (world.b - world.a) + v * (world.c - world.a));
      EXPECT_TRUE(std::any_of(pieces, pieces + count, [&](const bvh::Primitive& box) { return is_in(box, point); }))
          << "triangle " << number << " in " << count << " pieces, at " << u << ' ' << v;
    }
  }
}

// An edge through the local origin, which the first cut meets: floats tell coordinates near zero apart that the rounding
// of the cut's point does not.
TEST(BvhPieces, CoverAnEdgeBesideTheCut) {
  std::mt19937_64 random = oracle::seeded(5);
  std::uniform_real_distribution<float> number(0.1f, 0.5f);
  for (int i = 0; i < 500; ++i) {
    const Vec3 along(0.55 + 0.4 * static_cast<double>(number(random)), static_cast<double>(number(random)),
                     static_cast<double>(number(random)));
    const Vec3 step = along.cast<float>().cast<double>();
    const double beyond = 1 - static_cast<double>(1 + i % 100) / 512;
    const TriangleMesh mesh{.vertices = {-step, beyond * step, {0.1, -0.2, -0.3}}, .triangles = {{0, 1, 2}}};
    const bvh::MeshFrame found = bvh::mesh_frame(mesh, 1);
    ASSERT_EQ(found.frame.origin, Vec3::Zero());
    bvh::Primitive pieces[2];
    ASSERT_EQ(bvh::cover(mesh, found.frame, 0, 2, pieces), 2u);
    for (int exponent = -90; exponent < -40; ++exponent) {
      for (const double sign : {-1.0, 1.0}) {
        const Vec3 point = found.frame.to_local(sign * std::ldexp(1.0, exponent) * step);
        EXPECT_TRUE(is_in(pieces[0], point) || is_in(pieces[1], point)) << i << ' ' << exponent;
      }
    }
  }
}

TEST(BvhPieces, AreSmallerThanTheWhole) {
  const TriangleMesh mesh = needles(0, 1, 8);
  const bvh::MeshFrame found = bvh::mesh_frame(mesh, 1);
  const bvh::Primitive whole = bvh::local_primitive(mesh, found.frame, 0);
  bvh::Primitive pieces[16];
  const std::uint32_t count = bvh::cover(mesh, found.frame, 0, 16, pieces);
  ASSERT_EQ(count, 16u);
  float area = 0;
  for (const bvh::Primitive& piece : pieces) area += bvh::FloatBox{piece.low, piece.high}.half_area();
  EXPECT_LT(area, (bvh::FloatBox{whole.low, whole.high}.half_area()) / 4);
}

TEST(BvhPieces, PayForLongSlantedTrianglesOnly) {
  const auto splits = [](const TriangleMesh& mesh) { return best(mesh).report().split_triangles; };
  EXPECT_EQ(splits(scenes::terrain(60, 2, 1)), 0u);
  EXPECT_EQ(splits(scenes::icosphere(4, 1)), 0u);
  EXPECT_EQ(splits(scenes::scattered(3000, 0.05, 1)), 0u);
  EXPECT_GT(splits(needles(3000, 60, 1)), 30u);
}

TEST(BvhPieces, ReferencesStayWithinAQuarterMore) {
  for (const std::uint32_t slanted : {1u, 10u, 100u, 1000u}) {
    const TriangleMesh mesh = needles(1000, slanted, slanted);
    const Bvh tree = best(mesh);
    const BvhReport& report = tree.report();
    EXPECT_LE(static_cast<double>(report.references), 1.25 * static_cast<double>(mesh.triangles.size()));
  }
}

// Of so many only every second is looked at for a first guess; here those are the small ones, and the rest is what costs.
TEST(BvhPieces, ReferencesStayWithinAQuarterMoreWhereASampleSaysLittle) {
  constexpr std::uint32_t kHalf = 36'000;
  const TriangleMesh small = scenes::scattered(kHalf, 0.002, 1);
  const TriangleMesh large = scenes::slanted(kHalf, 0.05, 2);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 2 * kHalf; ++i) {
    const Triangle t = i % 2 == 0 ? small.triangle(i / 2) : large.triangle(i / 2);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {t.a, t.b, t.c});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const Bvh tree = best(mesh);
  const BvhReport& report = tree.report();
  EXPECT_GE(report.references, mesh.triangles.size());
  EXPECT_LE(static_cast<double>(report.references), 1.25 * static_cast<double>(mesh.triangles.size()));
  EXPECT_GT(report.split_triangles, 0u);
}

TEST(BvhPieces, AWalkLosesNoTriangleThatTheExactTestMeets) {
  std::mt19937_64 random = oracle::seeded(77);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const TriangleMesh mesh = needles(400, 30, random());
  const Bvh tree = best(mesh);
  ASSERT_GT(tree.report().split_triangles, 0u);
  std::size_t met = 0;
  for (int i = 0; i < 2000; ++i) {
    // At corners, edges and insides of the long ones and of all.
    const auto first = i % 2 == 0 ? 400u : 0u;
    const Triangle aim = mesh.triangle(static_cast<std::uint32_t>(first + random() % (430 - first)));
    const double x = coordinate(random);
    const double y = coordinate(random);
    const Vec3 from = 2 * Vec3(x, y, coordinate(random));
    const double along = std::abs(coordinate(random));
    const Vec3 target =
        i % 3 == 0 ? aim.b : Vec3(aim.a + along * (aim.b - aim.a) + (1 - along) * 0.5 * (aim.c - aim.a));
    const Ray ray{from, target - from};
    std::set<std::uint32_t> seen;
    WalkCost cost;
    const auto note = [&](std::uint32_t triangle, double limit) {
      seen.insert(triangle);
      return limit;
    };
    tree.walk_ray(ray, std::numeric_limits<double>::infinity(), 0, note, cost);
    RayHit hit;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (!cast_ray(ray, mesh.triangle(t), hit).yes()) continue;
      ++met;
      EXPECT_TRUE(seen.contains(t)) << "ray " << i << " loses triangle " << t;
    }
  }
  EXPECT_GT(met, 1000u);
}

}  // namespace
}  // namespace collided::engine
