#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/mesh/single_precision.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/intake/scene.hpp"
#include "server/intake/weld.hpp"

namespace collided::engine {
namespace {

double volume(const TriangleMesh& mesh) {
  double six_times = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    six_times += t.a.dot(t.b.cross(t.c));
  }
  return six_times / 6;
}

TEST(IntakeMeshHealth, ABoxIsClosedAndAnOpenBoxHasFourBoundaryEdges) {
  TriangleMesh box = box_mesh({0, 0, 0}, {1, 2, 3});
  const MeshHealth whole = examine(box);
  EXPECT_EQ(whole.vertex_count, 8u);
  EXPECT_EQ(whole.triangle_count, 12u);
  EXPECT_EQ(whole.edge_count, 18u);
  EXPECT_EQ(whole.component_count, 1u);
  EXPECT_TRUE(whole.is_closed && whole.is_consistently_oriented);
  EXPECT_EQ(whole.bounds.high, Vec3(1, 2, 3));
  std::erase_if(box.triangles, [&](const TriangleCorners& t) {
    return box.vertices[t[0]][2] == 3 && box.vertices[t[1]][2] == 3 && box.vertices[t[2]][2] == 3;
  });
  const MeshHealth open = examine(box);
  EXPECT_EQ(open.boundary_edge_count, 4u);
  EXPECT_FALSE(open.is_closed);
}

TEST(IntakeMeshHealth, VerticesOfTheirOwnForEachTriangleChangeNothing) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh soup;
  for (std::uint32_t i = 0; i < 12; ++i) {
    const Triangle t = box.triangle(i);
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    soup.vertices.insert(soup.vertices.end(), {t.a, t.b, t.c});
  }
  EXPECT_EQ(examine(soup).equal_vertex_count, 28u);
  EXPECT_TRUE(examine(soup).is_closed);
  weld_equal_vertices(soup);
  EXPECT_EQ(soup.vertices.size(), 8u);
  EXPECT_EQ(examine(soup).edge_count, 18u);
}

TEST(IntakeMeshHealth, ATurnedTriangleIsInconsistentAlongItsThreeEdges) {
  TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  std::swap(box.triangles[4][0], box.triangles[4][1]);
  EXPECT_EQ(examine(box).inconsistent_edge_count, 3u);
  EXPECT_TRUE(examine(box).is_closed);
  EXPECT_FALSE(examine(box).is_consistently_oriented);
}

// Whichever triangle comes first: the fewer are the ones that are turned over.
TEST(IntakeMeshHealth, TheFewerOfAPieceAreFlipped) {
  for (std::uint32_t turned = 0; turned < 12; ++turned) {
    TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
    std::swap(box.triangles[turned][0], box.triangles[turned][1]);
    EXPECT_EQ(examine(box).flipped, std::vector<std::uint32_t>{turned});
    for (TriangleCorners& corners : box.triangles) std::swap(corners[0], corners[1]);
    EXPECT_EQ(examine(box).flipped, std::vector<std::uint32_t>{turned});
  }
  // Of as many, not the first one's side.
  const TriangleMesh two{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 3, 2}}};
  EXPECT_EQ(examine(two).flipped, std::vector<std::uint32_t>{1});
}

TEST(IntakeMeshHealth, AMoebiusStripIsOneSidedAndNoneOfItIsFlipped) {
  TriangleMesh strip;
  constexpr std::uint32_t kSteps = 9;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSteps;
    const Vec3 middle(2 * std::cos(angle), 2 * std::sin(angle), 0);
    const Vec3 across = 0.4 * (std::cos(angle / 2) * middle.normalized() + std::sin(angle / 2) * Vec3::UnitZ());
    strip.vertices.insert(strip.vertices.end(), {middle + across, middle - across});
  }
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const bool is_last = i + 1 == kSteps;
    const std::uint32_t next = is_last ? 1 : 2 * i + 2;
    const std::uint32_t next_other = is_last ? 0 : 2 * i + 3;
    strip.triangles.push_back({2 * i, 2 * i + 1, next});
    strip.triangles.push_back({next, 2 * i + 1, next_other});
  }
  const MeshHealth health = examine(strip);
  EXPECT_EQ(health.unorientable_count, 1u);
  EXPECT_TRUE(health.flipped.empty());
  EXPECT_GT(health.inconsistent_edge_count, 0u);
  EXPECT_EQ(health.boundary_edge_count, 2 * kSteps);
  // A flap on a flap, whose triangle comes first and whose edge comes last, hears of it all the same.
  const TriangleCorners last = strip.triangles[2 * kSteps - 3];
  strip.vertices.emplace_back(0, 0, 5);
  strip.vertices.emplace_back(0, 0, 6);
  strip.triangles.push_back({last[2], last[1], 2 * kSteps});
  strip.triangles.insert(strip.triangles.begin(), {last[2], 2 * kSteps, 2 * kSteps + 1});
  EXPECT_EQ(examine(strip).unorientable_count, 1u);
  EXPECT_TRUE(examine(strip).flipped.empty());
}

TEST(IntakeMeshHealth, WhereFansMeetAtAPointAloneItIsPinched) {
  TriangleMesh two = box_mesh({0, 0, 0}, {1, 1, 1});
  const TriangleMesh other = box_mesh({1, 1, 1}, {2, 2, 2});
  for (const TriangleCorners& t : other.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  two.vertices.insert(two.vertices.end(), other.vertices.begin(), other.vertices.end());
  const MeshHealth health = examine(two);
  ASSERT_EQ(health.pinched_points.size(), 1u);
  EXPECT_EQ(two.vertices[health.pinched_points[0]], Vec3(1, 1, 1));
  EXPECT_TRUE(health.is_closed);
  EXPECT_FALSE(health.is_manifold());
  EXPECT_TRUE(examine(box_mesh({0, 0, 0}, {1, 1, 1})).pinched_points.empty());
}

TEST(IntakeMeshHealth, AFinOnABoxIsNoManifold) {
  TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  box.vertices.emplace_back(2, 2, 2);
  const TriangleCorners& first = box.triangles[0];
  box.triangles.push_back({first[0], first[1], 8});
  EXPECT_EQ(examine(box).nonmanifold_edge_count, 1u);
  EXPECT_EQ(examine(box).boundary_edge_count, 2u);
  EXPECT_FALSE(examine(box).is_closed);
}

TEST(IntakeMeshHealth, DuplicatesAreFoundWhateverTheirOrder) {
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-0.0, 0, 0}},
                    {{0, 1, 2}, {2, 1, 0}, {1, 2, 3}, {4, 2, 1}}};
  EXPECT_EQ(examine(mesh).duplicate_count, 3u);
}

TEST(IntakeMeshHealth, ZeroAreaIsExactFarFromTheOrigin) {
  const Vec3 a(4649000.1, 500000.3, 12.7);
  const Vec3 step(0.125, 0.25, 0.5);
  EXPECT_TRUE(has_zero_area({a, a, a + step}));
  const Vec3 round_a(4649000, 500000, 12);
  EXPECT_TRUE(has_zero_area({round_a, round_a + step, round_a + 2 * step}));
  Vec3 off = round_a + 2 * step;
  off[1] = std::nextafter(off[1], 1e9);
  EXPECT_FALSE(has_zero_area({round_a, round_a + step, off}));
}

TEST(IntakeMeshHealth, PiecesHangTogetherOverPoints) {
  TriangleMesh two = box_mesh({0, 0, 0}, {1, 1, 1});
  const auto add = [&](const TriangleMesh& other) {
    const auto first = static_cast<std::uint32_t>(two.vertices.size());
    two.vertices.insert(two.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const TriangleCorners& t : other.triangles) {
      two.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  };
  add(box_mesh({1, 1, 1}, {2, 2, 2}));
  EXPECT_EQ(examine(two).component_count, 1u);
  add(box_mesh({3, 3, 3}, {4, 4, 4}));
  EXPECT_EQ(examine(two).component_count, 2u);
}

TEST(IntakeMeshHealth, AnEmptyMeshIsNotClosed) {
  EXPECT_FALSE(examine({}).is_closed);
  EXPECT_TRUE(examine({}).bounds.empty());
}

TEST(IntakeSphereMesh, HasTheTrianglesOfTheFormulaAndIsClosed) {
  EXPECT_EQ(latitude_longitude_sphere(1, 16, 9).triangles.size(), 256u);
  for (unsigned longitudes = 3; longitudes < 20; ++longitudes) {
    for (unsigned latitudes = 2; latitudes < 12; ++latitudes) {
      const TriangleMesh sphere = latitude_longitude_sphere(2, longitudes, latitudes);
      ASSERT_EQ(sphere.triangles.size(), 2 * longitudes * (latitudes - 1));
      const MeshHealth health = examine(sphere);
      ASSERT_TRUE(health.is_closed && health.is_consistently_oriented) << longitudes << ' ' << latitudes;
      ASSERT_EQ(health.vertex_count - health.edge_count + health.triangle_count, 2u);
      ASSERT_EQ(health.equal_vertex_count + health.zero_area_count, 0u);
      ASSERT_GT(volume(sphere), 0);
    }
  }
  EXPECT_THROW(latitude_longitude_sphere(1, 2, 9), std::invalid_argument);
  EXPECT_THROW(latitude_longitude_sphere(1, 9, 1), std::invalid_argument);
  EXPECT_THROW(latitude_longitude_sphere(std::nan(""), 9, 9), std::invalid_argument);
}

TEST(IntakeSphereMesh, VolumeTendsToTheSpheresWithTheSquareOfTheStep) {
  const double exact = 4 * std::numbers::pi / 3 * 8;
  double last = 0;
  for (const unsigned n : {8u, 16u, 32u, 64u, 128u}) {
    const double missing = exact - volume(latitude_longitude_sphere(2, 2 * n, n));
    if (last != 0) { EXPECT_NEAR(last / missing, 4, 0.2); }
    last = missing;
  }
}

TEST(IntakeSphereMesh, NoPointIsDeeperThanPromised) {
  const TriangleMesh sphere = latitude_longitude_sphere(1, 7, 5);
  const double least = std::cos(std::numbers::pi / 10) * std::cos(std::numbers::pi / 7);
  double nearest = 1;
  for (std::uint32_t i = 0; i < sphere.triangles.size(); ++i) {
    const Triangle t = sphere.triangle(i);
    for (int u = 0; u <= 20; ++u) {
      for (int v = 0; u + v <= 20; ++v) {
        nearest = std::min(nearest, (t.a * u + t.b * v + t.c * (20 - u - v)).norm() / 20);
      }
    }
  }
  EXPECT_GE(nearest, least - 1e-15);
  EXPECT_NEAR(nearest, least, 1e-3);  // the bound is met at the equator
  for (const Vec3& vertex : sphere.vertices) { EXPECT_NEAR(vertex.norm(), 1, 4e-16); }
}

TEST(IntakeBoxMesh, InwardNormalsTurnTheVolumeRound) {
  EXPECT_EQ(volume(box_mesh({0, 0, 0}, {1, 2, 3})), 6);
  const TriangleMesh room = box_mesh({0, 0, 0}, {1, 2, 3}, Normals::inward);
  EXPECT_EQ(volume(room), -6);
  EXPECT_TRUE(examine(room).is_closed && examine(room).is_consistently_oriented);
}

TEST(IntakeEmbeddedScene, IsTheWarehouseOfTheManual) {
  const Scene scene = embedded_scene();
  EXPECT_EQ(scene.name, "warehouse");
  EXPECT_EQ(scene.mesh.triangles.size(), 300u);
  EXPECT_EQ(scene.objects.size(), 6u);
  const auto top = std::find_if(scene.parts.begin(), scene.parts.end(),
                                [](const Part& part) { return part.name == "warehouse/shelf_3/top"; });
  ASSERT_NE(top, scene.parts.end());
  double highest = 0;
  for (std::uint32_t i = 0; i < top->triangle_count; ++i) {
    highest = std::max(highest, scene.mesh.triangle(top->first_triangle + i).a[2]);
  }
  EXPECT_EQ(highest, 1.2);
  EXPECT_TRUE(examine(scene.mesh).zero_area_count == 0 && examine(scene.mesh).duplicate_count == 0);
}

TriangleMesh far_mesh(double x_m, bool rounded) {
  TriangleMesh mesh;
  for (int i = 0; i < 30; ++i) {
    const Vec3 p(x_m + 0.37 * i, x_m / 9 + 0.77 * i, 3.1 * i);
    mesh.vertices.push_back(rounded ? Vec3(p.cast<float>().cast<double>()) : p);
  }
  return mesh;
}

TEST(IntakeSinglePrecision, FarCoordinatesOfFloatsGiveAWarningWithTheirGrid) {
  const std::string warning = single_precision_warning(far_mesh(4.649e6, true), 1);
  EXPECT_NE(warning.find("60 of 60 far coordinates"), std::string::npos) << warning;
  EXPECT_NE(warning.find("below 0.5 m mean nothing"), std::string::npos) << warning;
  EXPECT_NE(warning.find("the origin at 4649000,517000,0"), std::string::npos) << warning;
}

TEST(IntakeSinglePrecision, DoublesAndWholeNumbersFarAwayGiveNoWarning) {
  EXPECT_EQ(single_precision_warning(far_mesh(4.649e6, false), 1), "");
  TriangleMesh whole;
  for (int i = 0; i < 30; ++i) { whole.vertices.emplace_back(4649000 + i, 500000 - i, 100 * i); }
  EXPECT_EQ(single_precision_warning(whole, 1), "");
}

TEST(IntakeSinglePrecision, NearCoordinatesGiveNoWarning) {
  EXPECT_EQ(single_precision_warning(far_mesh(8000, true), 1), "");
  EXPECT_EQ(single_precision_warning(far_mesh(4.649e6, true), 1e-4), "");
}

// Floats are 0.98 mm apart below 16,384 and 1.95 mm from there on; a millimetre is the limit, whatever the unit.
TEST(IntakeSinglePrecision, FarBeginsWhereFloatsAreMoreThanAMillimetreApart) {
  const auto warning = [](double x, double unit_m) {
    TriangleMesh mesh;
    mesh.vertices.assign(12, Vec3(x, 0, -0.0));
    return single_precision_warning(mesh, unit_m);
  };
  const double below = std::nextafter(16384.0F, 0.0F), above = std::nextafter(16384.0F, 1e9F);
  for (const double sign : {1, -1}) {
    EXPECT_EQ(warning(sign * below, 1), "");
    EXPECT_NE(warning(sign * above, 1).find("12 of 12"), std::string::npos);
    EXPECT_NE(warning(sign * below / 1024, 1100).find("12 of 12"), std::string::npos);
    EXPECT_EQ(warning(sign * above * 1024, 1.0 / 1024 / 2), "");
  }
  EXPECT_EQ(warning(1e300, 1), "") << "no float is as large";
}

}  // namespace
}  // namespace collided::engine
