// The contact of two meshes and its manifold, beside the contacts of all their triangles.
#include <gtest/gtest.h>

#include <random>

#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/world/query/pair_report.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

using extreme::Stage;

Placed placed(const Snapshot& state, ObjectId id) {
  return {
      .info = state.objects[slot_of(id)].get(), .frame = state.frame(slot_of(id)), .bounds = state.bounds(slot_of(id))};
}

/// The slow twin: the full contact of every pair that overlaps.
struct AllContacts {
  ContactSearch deepest;
  std::vector<ManifoldPoint> manifold;

  AllContacts(const Placed& a, const Placed& b) {
    const std::vector<PlacedPart> parts_b = parts_of(b);
    const std::vector<PlacedPart> parts_a = parts_of(a);
    const auto visit_all = [&](const auto& visit) {
      for (const PlacedPart& of_a : parts_a) {
        for (const PlacedPart& of_b : parts_b) {
          if (overlaps(of_a.part, of_b.part).yes()) visit(of_a, of_b, contact(of_a.part, of_b.part));
        }
      }
    };
    visit_all([&](const PlacedPart& of_a, const PlacedPart& of_b, const Contact& here) {
      if (!deeper(here, of_a.triangle, of_b.triangle, deepest)) return;
      deepest.contact = here;
      deepest.a_triangle = of_a.triangle;
      deepest.b_triangle = of_b.triangle;
      deepest.yes = true;
    });
    visit_all([&](const PlacedPart& of_a, const PlacedPart& of_b, const Contact& here) {
      if (here.normal.dot(deepest.contact.normal) < 0.9) return;
      append_manifold(of_a.part, of_b.part, here, deepest.contact.normal, manifold);
    });
    keep_extremes(deepest.contact.normal, manifold);
  }
};

Pose any_pose(double spread_m, std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  const double x = any(random), y = any(random), z = any(random);
  const double w = any(random), p = any(random), q = any(random);
  return {.position = spread_m * Vec3(x, y, z), .rotation = Quat(w, p, q, any(random)).normalized()};
}

/// False: they do not touch.
bool expect_as_all(const TriangleMesh& first, const TriangleMesh& second, const Pose& pose, int round) {
  Stage stage;
  const ObjectId a = stage.add("a", extreme::mesh_shape(first), {});
  const ObjectId b = stage.add("b", extreme::mesh_shape(second), pose);
  stage.step();
  const SnapshotRing::Lease state = stage.world.newest();
  const AllContacts twin(placed(*state, a), placed(*state, b));
  const PairReport found = report_pair(*state, a, b, {});
  EXPECT_EQ(found.touches == Decision::yes, twin.deepest.yes) << round;
  if (!twin.deepest.yes) return false;
  EXPECT_EQ(found.a_triangle, twin.deepest.a_triangle) << round;
  EXPECT_EQ(found.b_triangle, twin.deepest.b_triangle) << round;
  EXPECT_EQ(found.contact.depth_m, twin.deepest.contact.depth_m) << round;
  EXPECT_EQ(found.contact.point, twin.deepest.contact.point) << round;
  EXPECT_EQ(found.contact.normal, twin.deepest.contact.normal) << round;
  EXPECT_EQ(found.manifold.size(), twin.manifold.size()) << round;
  for (std::size_t i = 0; i < std::min(found.manifold.size(), twin.manifold.size()); ++i) {
    EXPECT_EQ(found.manifold[i].point, twin.manifold[i].point) << round;
    EXPECT_EQ(found.manifold[i].depth_m, twin.manifold[i].depth_m) << round;
  }
  return true;
}

// Most contacts are only bounded, and most pairs of the manifold only known to point elsewhere: what is told is the same
// to the last bit as from all contacts.
TEST(MeshContact, IsTheDeepestOfAllTrianglesAndItsManifoldIsFromAll) {
  std::mt19937_64 random = oracle::seeded(20261201);
  const TriangleMesh ball = latitude_longitude_sphere(0.7, 12, 8);
  int touching = 0;
  for (int round = 0; round < 40; ++round) {
    const Pose pose = any_pose(0.8, random);
    touching += expect_as_all(ball, ball, pose, round) ? 1 : 0;
    touching += expect_as_all(scenes::terrain(8, 2, random()), ball, pose, round) ? 1 : 0;
    touching += expect_as_all(scenes::degenerate(100, random()), ball, pose, round) ? 1 : 0;
    touching += expect_as_all(scenes::slanted(100, 0.5, random()), scenes::box({0.5, 0.4, 0.3}), pose, round) ? 1 : 0;
    if (HasFailure()) return;
  }
  EXPECT_GT(touching, 80);
}

// Sheets that all cross all blades: more pairs than the search keeps, so they are looked for again, and none is lost.
TEST(MeshContact, OfMorePairsThanAreKeptAllAreCounted) {
  constexpr std::uint32_t kCount = 1030;
  TriangleMesh sheets;
  TriangleMesh blades;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double at = 1e-4 * i;
    sheets.vertices.insert(sheets.vertices.end(), {{-10, -10, at}, {10, -10, at}, {0, 10, at}});
    blades.vertices.insert(blades.vertices.end(), {{at, -1, -5}, {at, 1, -5}, {at, 0, 5}});
    sheets.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    blades.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  Stage stage;
  const ObjectId a = stage.add("a", extreme::mesh_shape(sheets), {});
  const ObjectId b = stage.add("b", extreme::mesh_shape(blades), {});
  stage.step();
  const PairReport found = report_pair(*stage.world.newest(), a, b, {.triangles = true, .most_crossings = 10});
  EXPECT_EQ(found.touches, Decision::yes);
  EXPECT_EQ(found.crossing_count, std::uint64_t{kCount} * kCount);
  EXPECT_EQ(found.crossings.size(), 10u);
  EXPECT_FALSE(found.manifold.empty());
}

// Faces on faces and edges on edges: depths of 0 and ties all over.
TEST(MeshContact, OfBoxesThatRestOnEachOtherIsThatOfAll) {
  const TriangleMesh box = scenes::box({1, 1, 1});
  int round = 0;
  for (const Vec3& place :
       {Vec3(0, 0, 2), Vec3(1, 0, 2), Vec3(0.5, 0.25, 2), Vec3(2, 2, 0), Vec3(1, 1, 1), Vec3(0, 0, 0)})
    EXPECT_TRUE(expect_as_all(box, box, {.position = place, .rotation = Quat::Identity()}, round++));
}

}  // namespace
}  // namespace collided::engine
