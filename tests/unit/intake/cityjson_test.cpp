#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/intake/polygons/triangulate.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

using test::complaint;
using test::load;

std::string city(
    std::string_view objects,
    std::string_view vertices =
        "[[0,0,0],[4000,0,0],[4000,4000,0],[0,4000,0],[1000,1000,0],[1000,3000,0],[3000,3000,0],[3000,1000,0]]") {
  return fmt::format(
      R"({{"type":"CityJSON","version":"2.0","metadata":{{"referenceSystem":"EPSG:7415"}},)"
      R"("transform":{{"scale":[0.001,0.001,0.001],"translate":[84610,447420,-1]}},"CityObjects":{{{}}},"vertices":{}}})",
      objects, vertices);
}

std::string house(std::string_view boundaries, std::string_view type = "MultiSurface", std::string_view lod = "\"1\"") {
  return fmt::format(R"("house":{{"type":"Building","geometry":[{{"type":"{}","lod":{},"boundaries":{}}}]}})", type,
                     lod, boundaries);
}

double area(const TriangleMesh& mesh) {
  double twice = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    twice += (t.b - t.a).cross(t.c - t.a).norm();
  }
  return twice / 2;
}

TEST(IntakeCityJson, CoordinatesAreScaledAndMovedAndTheirSystemIsSaid) {
  const auto loaded = load("delft.json", city(house("[[[0,1,2]],[[0,2,3]]]")));
  EXPECT_EQ(loaded.scene.parts.at(0).name, "delft/house");
  EXPECT_EQ(loaded.scene.mesh.vertices[2], Vec3(84614, 447424, -1));
  EXPECT_EQ(loaded.report.placed.at(0), "coordinates are those of EPSG:7415");
  EXPECT_EQ(loaded.report.placed.at(2), "z is up, as CityJSON says");
}

TEST(IntakeCityJson, HolesStayOpen) {
  const auto loaded = load("a.city.json", city(house("[[[0,1,2,3],[4,5,6,7]]]")));
  EXPECT_NEAR(area(loaded.scene.mesh), 16 - 4, 1e-9);
  EXPECT_TRUE(loaded.report.mended.empty());
  // The hole the other way round is the same hole.
  EXPECT_NEAR(area(load("a.json", city(house("[[[0,1,2,3],[7,6,5,4]]]"))).scene.mesh), 12, 1e-9);
}

TEST(IntakeCityJson, AHoleOutsideOfItsSurfaceIsCoveredAndTold) {
  const auto loaded = load("a.json", city(house("[[[4,5,6,7],[0,1,2,3]]]")));
  ASSERT_EQ(loaded.report.mended.size(), 1u);
  EXPECT_EQ(loaded.report.mended[0], "1 surfaces closed over holes that cross their border or lie outside of it");
}

TEST(IntakeCityJson, TheFinestDetailIsTakenAndTheRestTold) {
  const std::string two =
      R"("a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1.2","boundaries":[[[0,1,2]]]},)"
      R"({"type":"Solid","lod":"2.2","boundaries":[[[[0,1,2]],[[0,2,3]]]]}]})";
  const auto loaded = load("a.json", city(two));
  EXPECT_EQ(loaded.scene.mesh.triangles.size(), 2u);
  ASSERT_EQ(loaded.report.refused.size(), 1u);
  EXPECT_EQ(loaded.report.refused[0], "1 geometries of lower detail than the finest of their object left out");
}

TEST(IntakeCityJson, ComplaintsNameThePlace) {
  EXPECT_EQ(complaint("a.json", R"({"hello":1})"),
            "a.json: its \"type\" is '', only \"CityJSON\" is read. Nothing was loaded.");
  EXPECT_EQ(complaint("a.json", city(house("[[[0,1,99]]]"))),
            "a.json: /CityObjects/house/geometry/0 has a corner that is vertex 99 of 8. Nothing was loaded.");
  EXPECT_EQ(complaint("a.json", city(house("[[[0,1,-2]]]"))),
            "a.json: /CityObjects/house/geometry/0 has a corner that is vertex -2 of 8. Nothing was loaded.");
  EXPECT_EQ(complaint("a.json", city(house("[[[0,1,2]]]"), "[[0,0,0],[1,0]]")),
            "a.json: /vertices/1 is not three numbers. Nothing was loaded.");
  // The file's own names are made fit for a terminal.
  EXPECT_EQ(complaint("a.json", city(R"("h\u0001\u00e9":{"geometry":[{"type":7}]})")),
            "a.json: /CityObjects/h?\?\?/geometry/0/type is not text. Nothing was loaded.");
  EXPECT_EQ(complaint("a.json", city(house("[[[0,1,2]]]")), {.max_triangles = 0}),
            "a.json: 1 triangles, limit 0. Nothing was loaded.");
}

// Stars with up to six star-shaped holes, in a tilted plane: the triangles' area is what the rings leave.
TEST(IntakeTriangulate, TheAreaLeftBetweenRingsIsTheirDifference) {
  std::mt19937_64 random = oracle::seeded(51);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 300; ++round) {
    std::vector<Vec3> vertices;
    std::vector<std::vector<std::uint32_t>> rings;
    const auto add_star = [&](double x, double y, double least, double most) {
      const int corners = 3 + static_cast<int>(random() % 12);
      double twice = 0;
      std::vector<std::uint32_t> ring;
      double last_x = 0;
      double last_y = 0;
      double first_x = 0;
      double first_y = 0;
      for (int i = 0; i < corners; ++i) {
        const double angle = 2 * 3.141592653589793 * (i + 0.8 * unit(random)) / corners;
        const double radius = least + (most - least) * unit(random);
        const double px = x + radius * std::cos(angle);
        const double py = y + radius * std::sin(angle);
        if (i > 0) twice += last_x * py - last_y * px;
        else first_x = px, first_y = py;
        last_x = px;
        last_y = py;
        ring.push_back(static_cast<std::uint32_t>(vertices.size()));
        vertices.emplace_back(px, py, 0.5 * px - 0.25 * py);
      }
      twice += last_x * first_y - last_y * first_x;
      if (random() % 2 == 0) std::reverse(ring.begin(), ring.end());
      rings.push_back(std::move(ring));
      return twice / 2;
    };
    double left = add_star(0, 0, 12, 15);
    if (!(left > 300)) continue;  // three corners may leave the middle out
    for (int hole = 0; hole < static_cast<int>(random() % 7); ++hole) {
      left -= std::abs(add_star(-2 + 2 * (hole % 3), -1 + 2 * (hole / 3), 0.2, 0.9));
    }
    std::vector<std::uint32_t> corners;
    std::vector<std::uint32_t> ends;
    for (const std::vector<std::uint32_t>& ring : rings) {
      corners.insert(corners.end(), ring.begin(), ring.end());
      ends.push_back(static_cast<std::uint32_t>(corners.size()));
    }
    TriangleMesh mesh{vertices, {}};
    EXPECT_NE(triangulate_with_holes(corners, ends, vertices, mesh.triangles), PolygonKind::crossing) << round;
    ASSERT_NEAR(area(mesh), left * std::sqrt(1 + 0.25 + 0.0625), 1e-9) << round;
  }
}

// Each axis has its own scale and its own origin.
TEST(IntakeCityJson, EachAxisIsScaledAndMovedByItsOwnNumbers) {
  const std::string text =
      R"({"type":"CityJSON","version":"1.1","transform":{"scale":[0.5,2,4],"translate":[100,-20,3]},)"
      R"("CityObjects":{"h":{"type":"Building","geometry":[{"type":"MultiSurface","lod":2,"boundaries":[[[2,0,1]]]}]}},)"
      R"("vertices":[[1,2,3],[4,5,6],[7,8,10]]})";
  const Scene scene = load("a.json", text).scene;
  EXPECT_EQ(scene.mesh.vertices, (std::vector<Vec3>{{100.5, -16, 15}, {102, -10, 27}, {103.5, -4, 43}}));
  EXPECT_EQ(scene.mesh.triangles, (std::vector<TriangleCorners>{{2, 0, 1}}));
  EXPECT_EQ(load("a.json", text, {.unit_m = 0.5, .up = 'y'}).scene.mesh.vertices[0], Vec3(50.25, -7.5, -8));
}

// Every kind lies as deep in lists as the format says, with all of its surfaces.
TEST(IntakeCityJson, EveryKindOfGeometryGivesAllItsSurfaces) {
  const auto triangles = [](std::string_view type, std::string_view boundaries) {
    return load("a.json", city(house(boundaries, type))).scene.mesh.triangles;
  };
  const std::vector<TriangleCorners> expected{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(triangles("MultiSurface", "[[[0,1,2]],[[0,2,3]],[[4,5,6]]]"), expected);
  EXPECT_EQ(triangles("CompositeSurface", "[[[0,1,2]],[[0,2,3]],[[4,5,6]]]"), expected);
  EXPECT_EQ(triangles("Solid", "[[[[0,1,2]],[[0,2,3]]],[[[4,5,6]]]]"), expected) << "the inner shell too";
  EXPECT_EQ(triangles("MultiSolid", "[[[[[0,1,2]],[[0,2,3]]]],[[[[4,5,6]]]]]"), expected);
  EXPECT_EQ(triangles("CompositeSolid", "[[[[[0,1,2]],[[0,2,3]]]],[[[[4,5,6]]]]]"), expected);
}

TEST(IntakeCityJson, DetailIsANumberAlsoWhereItIsText) {
  const auto count = [](std::string_view coarse, std::string_view fine) {
    return load(
               "a.json",
               city(fmt::format(
                   R"("a":{{"type":"Building","geometry":[{{"type":"MultiSurface","lod":{},"boundaries":[[[0,1,2]],[[0,2,3]]]}},)"
                   R"({{"type":"MultiSurface","lod":{},"boundaries":[[[4,5,6]]]}}]}})",
                   coarse, fine)))
        .scene.mesh.triangles.size();
  };
  EXPECT_EQ(count("1", "2"), 1u);
  EXPECT_EQ(count("2", "1"), 2u);
  EXPECT_EQ(count("\"2.1\"", "\"2.3\""), 1u);
  EXPECT_EQ(count("\"1\"", "1.5"), 1u);
  EXPECT_EQ(count("2", "\"2\""), 3u) << "as fine as each other: both";
}

TEST(IntakeCityJson, EachObjectIsAPartOfItsOwnTriangles) {
  const Scene scene =
      load(
          "a.json",
          city(
              house("[[[0,1,2]],[[0,2,3]]]") + "," +
              R"("annex":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[4,5,6]]]}]})"))
          .scene;
  ASSERT_EQ(scene.parts.size(), 2u);
  EXPECT_EQ(scene.parts[0].name, "a/annex");
  EXPECT_EQ(scene.parts[0].triangle_count, 1u);
  EXPECT_EQ(scene.parts[1].name, "a/house");
  EXPECT_EQ(scene.parts[1].first_triangle, 1u);
  EXPECT_EQ(scene.parts[1].triangle_count, 2u);
}

}  // namespace
}  // namespace collided::engine
