#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <unistd.h>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/intake/mesh/mend.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/mesh/segment_grid.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/intake/weld.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"

namespace collided::engine {
namespace {

double mended_area(const TriangleMesh& mesh) {
  double twice = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    twice += (t.b - t.a).cross(t.c - t.a).norm();
  }
  return twice / 2;
}

/// Points that triangles use.
std::uint64_t point_count(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> point_of = first_equal_vertices(mesh.vertices);
  std::set<std::uint32_t> points;
  for (const TriangleCorners& t : mesh.triangles) {
    for (const std::uint32_t corner : t) points.insert(point_of[corner]);
  }
  return points.size();
}

/// Rays from inside a closed body through points of its seams that meet no triangle.
std::size_t leaks(const TriangleMesh& mesh, const std::vector<MeshSegment>& seams, std::size_t ray_count,
                  std::mt19937_64& random) {
  const Bvh tree = Bvh::build(mesh);
  std::uniform_real_distribution<double> unit(0, 1);
  std::size_t leaked = 0;
  for (std::size_t i = 0; i < ray_count; ++i) {
    const MeshSegment& seam = seams[random() % seams.size()];
    const Vec3 target = seam.a + unit(random) * (seam.b - seam.a);
    const Vec3 eye = 0.2 * Vec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
    const Ray ray{eye, target - eye};
    bool met = false;
    WalkCost cost;
    const auto candidate = [&](std::uint32_t triangle, double limit) {
      RayHit hit;
      met = met || cast_ray(ray, mesh.triangle(triangle), hit).yes();
      return met ? -1.0 : limit;
    };
    tree.walk_ray(ray, 3, 0, candidate, cost);
    leaked += met ? 0 : 1;
  }
  return leaked;
}

/// Rays a seam test is asked; COLLIDED_SEAM_RAYS=1000000 for the long form.
std::size_t seam_rays() {
  const char* asked = std::getenv("COLLIDED_SEAM_RAYS");
  return asked != nullptr ? std::strtoull(asked, nullptr, 10) : 20'000;
}

/// A ball of two tessellations, one above the equator and one below, each with its own number of points along it.
struct HalfBalls {
  TriangleMesh mesh;
  std::vector<MeshSegment> seam;
};

HalfBalls half_balls(unsigned upper, unsigned lower) {
  HalfBalls balls;
  for (const bool is_upper : {true, false}) {
    TriangleMesh half = latitude_longitude_sphere(1, is_upper ? upper : lower, 8);
    // Vertices of one circle differ in their last digits; on the plane they are one curve.
    for (Vec3& v : half.vertices) {
      if (std::abs(v[2]) < 1e-12) v[2] = 0;
    }
    std::erase_if(half.triangles, [&](const TriangleCorners& t) {
      const double z = half.vertices[t[0]][2] + half.vertices[t[1]][2] + half.vertices[t[2]][2];
      return is_upper ? z < 0 : z > 0;
    });
    scenes::append(balls.mesh, half);
  }
  const MeshHealth health = examine(balls.mesh);
  for (const HalfEdge half : health.boundary_edges) {
    const TriangleCorners& t = balls.mesh.triangles[triangle_of(half)];
    balls.seam.push_back({balls.mesh.vertices[t[half % 3]], balls.mesh.vertices[t[(half % 3 + 1) % 3]]});
  }
  return balls;
}

// A4, A5: two surfaces along one curve, tessellated apart, leave cracks that rays pass; mended, they are closed.
TEST(IntakeMend, CracksBetweenTwoTessellationsLeakAndMendedTheyDoNot) {
  std::mt19937_64 random = oracle::seeded(41);
  const HalfBalls balls = half_balls(40, 28);
  EXPECT_GT(leaks(balls.mesh, balls.seam, 20'000, random), 1000u);
  const double chord_m = 1 - std::cos(std::acos(-1.0) / 28);
  const MendedMesh mended = mend(balls.mesh, 1.01 * chord_m);
  const MeshHealth health = examine(mended.mesh);
  EXPECT_TRUE(health.is_closed && health.is_consistently_oriented);
  EXPECT_EQ(health.edge_count * 2, health.triangle_count * 3);
  EXPECT_EQ(point_count(mended.mesh) - health.edge_count + health.triangle_count, 2u);  // Euler
  EXPECT_LE(mended.report.largest_move_m, 1.01 * chord_m);
  EXPECT_EQ(leaks(mended.mesh, balls.seam, seam_rays(), random), 0u);
}

// A5: points that are a rounding apart become one.
TEST(IntakeMend, StitchingGivesEachInnerEdgeTwoTriangles) {
  std::mt19937_64 random = oracle::seeded(42);
  std::uniform_real_distribution<double> off(-1e-7, 1e-7);
  const TriangleMesh whole = scenes::icosphere(3, 1);
  TriangleMesh soup;
  for (std::uint32_t i = 0; i < whole.triangles.size(); ++i) {
    const Triangle t = whole.triangle(i);
    for (const Vec3& corner : {t.a, t.b, t.c})
      soup.vertices.push_back(corner + Vec3(off(random), off(random), off(random)));
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_EQ(examine(soup).boundary_edge_count, 3 * soup.triangles.size());
  const MendedMesh mended = mend(soup, 1e-6);
  const MeshHealth health = examine(mended.mesh);
  EXPECT_TRUE(health.is_closed && health.is_consistently_oriented && health.is_manifold());
  EXPECT_EQ(health.vertex_count - health.equal_vertex_count, whole.vertices.size());
  EXPECT_EQ(mended.report.cut_triangle_count, 0u);
  EXPECT_LE(mended.report.largest_move_m, 1e-6);
}

/// Twice the area vector of a triangle, exact.
std::array<mpq_class, 3> exact_normal(const Triangle& t) {
  const auto minus = [](const Vec3& a, const Vec3& b) {
    return std::array<mpq_class, 3>{mpq_class(a[0]) - mpq_class(b[0]), mpq_class(a[1]) - mpq_class(b[1]),
                                    mpq_class(a[2]) - mpq_class(b[2])};
  };
  const auto p = minus(t.b, t.a);
  const auto q = minus(t.c, t.a);
  return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
}

// A6: where the point lies on the edge exactly, so do the pieces on the triangle, and the area is the same exactly.
TEST(IntakeMend, CuttingATriangleAtPointsOfItsEdgesKeepsItsAreaExactly) {
  std::mt19937_64 random = oracle::seeded(43);
  for (int round = 0; round < 200; ++round) {
    // A triangle of small numbers with points at eighths of its sides, and around it one triangle for each gap.
    const auto coordinate = [&] { return static_cast<double>(static_cast<int>(random() % 17)) - 8; };
    Triangle t{{coordinate(), coordinate(), coordinate()},
               {coordinate(), coordinate(), coordinate()},
               {coordinate(), coordinate(), coordinate()}};
    if (has_zero_area(t)) continue;
    TriangleMesh mesh{{t.a, t.b, t.c}, {{0, 1, 2}}};
    std::size_t pieces = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3 from = mesh.vertices[k];
      const Vec3 to = mesh.vertices[(k + 1) % 3];
      const Vec3 out = 3 * (from + to) - 6 * mesh.vertices[(k + 2) % 3] + Vec3(0, 0, 1);
      std::uint32_t last = k;
      for (int eighth = 2; eighth <= 8; eighth += 2) {
        if (eighth < 8 && random() % 2 == 0) continue;
        std::uint32_t next = (k + 1) % 3;
        if (eighth < 8) {
          mesh.vertices.push_back(from + (to - from) * (eighth / 8.0));
          next = static_cast<std::uint32_t>(mesh.vertices.size()) - 1;
          ++pieces;
        }
        if (last == k && next == (k + 1) % 3) break;  // a side left whole has no neighbour
        mesh.vertices.push_back(to + out + 0.5 * (mesh.vertices[last] + mesh.vertices[next]));
        mesh.triangles.push_back({next, last, static_cast<std::uint32_t>(mesh.vertices.size()) - 1});
        last = next;
      }
    }
    const MendedMesh mended = mend(mesh, 1e-9);
    std::array<mpq_class, 3> sum{};
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < mended.mesh.triangles.size(); ++i) {
      if (mended.origin[i] != 0) continue;
      ++count;
      EXPECT_FALSE(has_zero_area(mended.mesh.triangle(i)));
      const auto normal = exact_normal(mended.mesh.triangle(i));
      for (int axis = 0; axis < 3; ++axis) sum[axis] += normal[axis];
    }
    EXPECT_EQ(count, 1 + pieces);
    EXPECT_EQ(sum, exact_normal(t));
    EXPECT_EQ(mended.report.largest_move_m, 0);
  }
}

TEST(IntakeMend, TVerticesGoAndTheAreaStaysAndNoVertexMoves) {
  std::mt19937_64 random = oracle::seeded(44);
  const TriangleMesh clean = scenes::rough_sphere(4, random);
  const scenes::Planted planted = scenes::plant(clean, 10, 1e-5, random);
  const MendedMesh mended = mend(planted.mesh, 1e-5);
  const MeshHealth health = examine(mended.mesh, 1e-5);
  EXPECT_EQ(health.seams.size(), 0u);
  EXPECT_EQ(mended.report.t_vertex_count, 10u);
  EXPECT_EQ(mended.report.closed_edge_count, 10u);
  EXPECT_EQ(mended.report.joined_point_count, 10u);
  EXPECT_EQ(mended.report.cut_triangle_count, 20u);
  EXPECT_LE(mended.report.largest_move_m, 1e-5);
  EXPECT_NEAR(mended_area(mended.mesh), mended_area(planted.mesh), 1e-4);
  // Only the border of the fins is left: two edges each.
  EXPECT_EQ(health.boundary_edge_count, 20u);
  for (std::uint32_t i = 0; i < planted.mesh.triangles.size(); ++i) EXPECT_EQ(mended.origin[i], i);
}

TEST(IntakeMend, AMeshWithoutSeamsIsTheSameBits) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 2, 3});
  const MendedMesh mended = mend(box, 0);
  EXPECT_EQ(mended.mesh.vertices, box.vertices);
  EXPECT_EQ(mended.mesh.triangles, box.triangles);
  EXPECT_FALSE(mended.report.did_anything());
  EXPECT_EQ(sentences(mended.report).at(0).substr(0, 30), "nothing: no T-vertex and no cr");
}

/// Two parts, each a square whose common border has points that only the other one has.
Scene two_parts() {
  Scene scene;
  scene.name = "s";
  scene.mesh = {{{0, 0, 0}, {1, 0, 0}, {1, 0.25, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}, {1, 0.5, 0}},
                {{0, 1, 2}, {0, 2, 4}, {2, 3, 4}, {1, 5, 7}, {5, 6, 7}, {7, 6, 3}}};
  scene.parts = {{.name = "s/left", .first_triangle = 0, .triangle_count = 3},
                 {.name = "s/right", .first_triangle = 3, .triangle_count = 3}};
  return scene;
}

TEST(IntakeMend, PiecesComeLastInTheirPartAndTellTheNumberOfTheFile) {
  Scene scene = two_parts();
  const Scene before = scene;
  const MendReport report = mend(scene, 0);
  EXPECT_EQ(report.t_vertex_count, 2u);
  EXPECT_EQ(report.cut_triangle_count, 2u);
  ASSERT_EQ(scene.parts[0].triangle_count, 4u);
  ASSERT_EQ(scene.parts[1].first_triangle, 4u);
  ASSERT_EQ(scene.parts[1].triangle_count, 4u);
  for (const Part& part : scene.parts) {
    const Part& old = before.parts[static_cast<std::size_t>(&part - scene.parts.data())];
    for (std::uint32_t i = 0; i < part.triangle_count; ++i) {
      const std::uint32_t told = part.cut.told(i, part.triangle_count);
      if (i < 3) { EXPECT_EQ(told, i); }
      // Each piece lies within the triangle it is said to be of: so does its middle.
      const Triangle piece = scene.mesh.triangle(part.first_triangle + i);
      const Vec3 middle = (piece.a + piece.b + piece.c) / 3;
      RayHit hit;
      EXPECT_TRUE(
          cast_ray(Ray{middle + Vec3(0, 0, 1), Vec3(0, 0, -1)}, before.mesh.triangle(old.first_triangle + told), hit)
              .yes());
    }
  }
  // Mended again, there is nothing to do, and the numbers stay.
  const auto told = scene.parts[0].cut.told(3, 4);
  EXPECT_FALSE(mend(scene, 0).did_anything());
  EXPECT_EQ(scene.parts[0].cut.told(3, 4), told);
}

// Mended as a static part and as the mesh of objects, a triangle has the same number of the file.
TEST(IntakeMend, PiecesOfAnObjectsMeshTellTheNumberOfTheFile) {
  Scene parts = two_parts();
  const auto mesh = std::make_shared<const TriangleMesh>(parts.mesh);
  parts.parts = {{.name = "s", .first_triangle = 0, .triangle_count = 6}};
  mend(parts, 0);
  Scene scene{.name = "s"};
  for (const char* name : {"one", "other"}) scene.objects.push_back({.name = name, .shape = {{}, mesh}});
  mend_objects(scene, 0);
  for (const SceneObject& object : scene.objects) {
    ASSERT_EQ(object.shape.mesh->triangles.size(), 8u);
    ASSERT_EQ(object.cut.piece_count(), 2u);
    for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(object.cut.told(i, 8), parts.parts[0].cut.told(i, 8)) << i;
    EXPECT_EQ(object.shape.mesh, scene.objects[0].shape.mesh) << "they still share it";
  }
  EXPECT_LT(scene.objects[0].cut.told(6, 8), 6u);
  const std::vector<std::uint32_t> told = *scene.objects[0].cut.piece_of;
  mend_objects(scene, 0);
  EXPECT_EQ(*scene.objects[0].cut.piece_of, told) << "mended again there is nothing to do";
}

TEST(IntakeMend, TheSceneFileKeepsTheNumbersOfPieces) {
  Scene scene = two_parts();
  mend(scene, 0);
  const std::string path = testing::TempDir() + "mended_" + std::to_string(::getpid()) + ".cscene";
  save_scene(path, scene);
  LoadReport report;
  const Scene loaded = load_scene(path, {}, report);
  std::remove(path.c_str());
  for (std::size_t p = 0; p < 2; ++p) {
    ASSERT_EQ(loaded.parts[p].cut.piece_count(), 1u);
    EXPECT_EQ(loaded.parts[p].cut.told(3, 4), scene.parts[p].cut.told(3, 4));
  }
}

}  // namespace
}  // namespace collided::engine
