#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <set>

#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/programs/files/file_options.hpp"
#include "server/programs/files/mesh_findings.hpp"
#include "server/programs/files/simplifying.hpp"

// What the program behind `collide check` and `collide convert` is made of, part by part.
namespace collided::engine::files {
namespace {

template <class Ask>
std::string complaint_of(const Ask& ask) {
  try {
    ask();
  } catch (const LoadError& error) { return error.what(); }
  return "taken";
}

TEST(FilesLengths, EveryUnitIsItsMetres) {
  const std::map<std::string, double> metres{{"m", 1},       {"mm", 1e-3},   {"cm", 1e-2}, {"km", 1e3},   {"um", 1e-6},
                                             {"in", 0.0254}, {"ft", 0.3048}, {"2.5", 2.5}, {"1e-4", 1e-4}};
  for (const auto& [unit, value] : metres) EXPECT_EQ(unit_in_metres(unit), value) << unit;
  for (const char* unit : {"", "M", "0", "-1", "nan", "inf", "1e999", "2m", "1 ", "mmm"})
    EXPECT_FALSE(unit_in_metres(unit)) << unit;
}

TEST(FilesLengths, ALengthIsANumberAndAUnitOrItIsRefused) {
  EXPECT_EQ(length_in_metres("--crack", "2"), 2);
  EXPECT_EQ(length_in_metres("--crack", "2e-4"), 2e-4);
  EXPECT_EQ(length_in_metres("--crack", "3mm"), 3 * 1e-3);
  EXPECT_EQ(length_in_metres("--crack", "12in"), 12 * 0.0254);
  for (const char* text : {"", "wide", "mm", "1xx", "1mmm", "1 mm", "0", "0mm", "-1mm", "inf", "infmm", "nan", "1e999",
                           "1e999mm", "1e-999"}) {
    EXPECT_EQ(complaint_of([&] { length_in_metres("--crack", text); }),
              std::string("--crack '") + text + "'; a length above 0 is needed, as 0.1mm or 2e-4");
  }
  FileOptions file;
  EXPECT_EQ(crack_in_metres(file), 0);
  file.crack = "3cm";
  EXPECT_EQ(crack_in_metres(file), 3 * 1e-2);
}

TEST(FilesLengths, APointIsThreeFiniteNumbersAndNothingElse) {
  EXPECT_EQ(parse_point("--eye", "1,-2.5,3e5"), Vec3(1, -2.5, 3e5));
  for (const char* text : {"", "1,2", "1,2,", "1,2,3,", "1,2,3 ", "1,2,3,4", "1;2;3", "1, 2,3", "x,2,3", "1,y,3",
                           "1,2,z", "inf,2,3", "1,nan,3", "1,2,1e999"}) {
    EXPECT_EQ(complaint_of([&] { parse_point("--eye", text); }),
              std::string("--eye '") + text + "'; three finite numbers are needed: X,Y,Z");
  }
}

TEST(FilesNumbers, ThousandsStandApartAndNoDigitIsLost) {
  const std::map<std::uint64_t, std::string> texts{{0, "0"},
                                                   {7, "7"},
                                                   {999, "999"},
                                                   {1000, "1 000"},
                                                   {18204, "18 204"},
                                                   {1002003, "1 002 003"},
                                                   {10020030, "10 020 030"}};
  for (const auto& [value, text] : texts) EXPECT_EQ(grouped(value), text);
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(-1e300), "-1e+300");
  EXPECT_EQ(std::stod(shortest(1.0 / 3)), 1.0 / 3);
}

// Health is 0.15 of the work, edges the next tenth, the index the quarter behind them.
TEST(FilesCheck, ProgressComesToEachPhaseAndStaysWithinIt) {
  const TriangleMesh ball = latitude_longitude_sphere(1, 200, 101);
  std::mutex mutex;
  std::vector<double> told;
  check_mesh("ball", ball, nullptr, {}, [&](double fraction) {
    const std::lock_guard lock(mutex);
    told.push_back(fraction);
  });
  ASSERT_GT(told.size(), 4u);
  EXPECT_EQ(told[0], 0.15);
  EXPECT_EQ(told[1], 0.25);
  for (std::size_t i = 2; i < told.size(); ++i) {
    EXPECT_GE(told[i], 0.25);
    EXPECT_LE(told[i], 1);
  }
  EXPECT_TRUE(
      std::any_of(told.begin() + 2, told.end(), [](double fraction) { return fraction > 0.25 && fraction <= 0.5; }));
  EXPECT_TRUE(std::any_of(told.begin() + 2, told.end(), [](double fraction) { return fraction > 0.5; }));
}

std::vector<std::string> lines_of(const MeshFinding& finding) {
  std::vector<std::string> lines;
  for (const FindingPlace& place : finding.worst) {
    const std::string with =
        place.with ? "with " + place.with->object + " " + std::to_string(place.with->triangle) : std::string();
    lines.push_back(place.object + " " + std::to_string(place.triangle) + " " + place.detail + with);
  }
  return lines;
}

// Two triangles back to back, a third one in the place of the first, one without area, and one across them.
TEST(FilesCheck, FindingsComeInTheirOrderWorstFirstWithTheirPlaces) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {4, 3, 0}, {8, 0, 0}, {1, 1, -1}, {1, 1, 1}, {2, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}, {2, 0, 1}, {0, 1, 4}, {5, 6, 7}};
  const std::vector<Part> parts{{.name = "s/a", .triangle_count = 2},
                                {.name = "s/b", .first_triangle = 2, .triangle_count = 3}};
  const CheckedMesh checked = check_mesh("s", mesh, &parts, {}, [](double) {});
  std::map<std::string, std::pair<std::uint64_t, std::vector<std::string>>> found;
  std::string order;
  for (const MeshFinding& finding : findings_of(checked, 2)) {
    found[finding.key] = {finding.count, lines_of(finding)};
    order += std::string(finding.key) + " ";
  }
  using Lines = std::vector<std::string>;
  EXPECT_EQ(found["zero_area"], std::pair(std::uint64_t{1}, Lines{"s/b 1 "})) << order;
  EXPECT_EQ(found["duplicates"], std::pair(std::uint64_t{1}, Lines{"s/b 0 "})) << order;
  EXPECT_EQ(found["nonmanifold_edges"].first, 1u);
  EXPECT_EQ(found["nonmanifold_edges"].second, Lines{"s/a 0 side 1"});
  EXPECT_GT(found["boundary_edges"].first, 2u);
  EXPECT_EQ(found["boundary_edges"].second.size(), 2u);
  EXPECT_GE(found["self_intersections"].first, 2u);
  EXPECT_EQ(found["self_intersections"].second, (Lines{"s/a 0 with s/b 2", "s/b 0 with s/b 2"})) << order;
  EXPECT_LT(order.find("boundary_edges"), order.find("nonmanifold_edges"));
  EXPECT_LT(order.find("nonmanifold_edges"), order.find("zero_area"));
  EXPECT_LT(order.find("zero_area"), order.find("duplicates"));
  EXPECT_LT(order.find("duplicates"), order.find("self_intersections"));
}

/// A flat square of 2 * cells^2 triangles from that x on, as a part of its own.
void add_plate(Scene& scene, const std::string& name, double x, std::uint32_t cells) {
  const auto first = static_cast<std::uint32_t>(scene.mesh.vertices.size());
  const auto first_triangle = static_cast<std::uint32_t>(scene.mesh.triangles.size());
  for (std::uint32_t row = 0; row <= cells; ++row) {
    for (std::uint32_t column = 0; column <= cells; ++column) scene.mesh.vertices.emplace_back(x + column, row, 0);
  }
  for (std::uint32_t row = 0; row < cells; ++row) {
    for (std::uint32_t column = 0; column < cells; ++column) {
      const std::uint32_t low = first + row * (cells + 1) + column;
      scene.mesh.triangles.push_back({low, low + 1, low + cells + 2});
      scene.mesh.triangles.push_back({low, low + cells + 2, low + cells + 1});
    }
  }
  scene.parts.push_back({.name = name,
                         .first_triangle = first_triangle,
                         .triangle_count = static_cast<std::uint32_t>(scene.mesh.triangles.size()) - first_triangle});
}

TEST(FilesSimplify, PartsKeepTheirNamesAndTheirOwnTriangles) {
  Scene scene{.name = "plates"};
  add_plate(scene, "plates/west", -100, 6);
  add_plate(scene, "plates/middle", 0, 10);
  add_plate(scene, "plates/east", 100, 8);
  testing::internal::CaptureStdout();
  simplify_to(scene, "50%", CollapseCost::edge_length);
  const std::string said = testing::internal::GetCapturedStdout();
  ASSERT_EQ(scene.mesh.triangles.size(), 200u);
  EXPECT_EQ(said.find("  simplify  200 of 400 triangles, no point of either surface farther than "), 0u) << said;
  const std::size_t second = said.find('\n') + 1;
  EXPECT_EQ(said.find("            refused: ", second), second) << said;
  EXPECT_NE(said.find(" collapses that would turn a normal by 90 degrees, ", second), std::string::npos) << said;
  EXPECT_EQ(said.find("asked for"), std::string::npos) << said;
  ASSERT_EQ(scene.parts.size(), 3u);
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Part& part = scene.parts[i];
    EXPECT_EQ(part.name, std::vector<std::string>({"plates/west", "plates/middle", "plates/east"})[i]);
    EXPECT_EQ(part.first_triangle, first);
    EXPECT_GT(part.triangle_count, 0u);
    first += part.triangle_count;
    const double low_x = -100 + 100 * static_cast<double>(i);
    for (std::uint32_t t = part.first_triangle; t < std::min(first, 200u); ++t) {
      const double x = scene.mesh.vertices[scene.mesh.triangles[t][0]].x();
      EXPECT_TRUE(low_x <= x && x <= low_x + 10) << part.name << ' ' << t;
    }
  }
  EXPECT_EQ(first, 200u);
}

TEST(FilesSimplify, LevelsAreToldByTheirTrianglesAndWhatTheGuardsRefused) {
  Scene scene{.name = "plate"};
  add_plate(scene, "plate", 0, 12);
  const TriangleMesh mesh = scene.mesh;
  testing::internal::CaptureStdout();
  add_levels(scene, CollapseCost::quadric);
  const std::string said = testing::internal::GetCapturedStdout();
  EXPECT_EQ(said.find("  level    "), 0u) << said;
  EXPECT_NE(said.find(" triangles, distances within "), std::string::npos) << said;
  EXPECT_NE(said.find("\n           refused: "), std::string::npos) << said;
  EXPECT_EQ(scene.mesh.triangles, mesh.triangles) << "the mesh itself stays";
  Scene nothing;
  testing::internal::CaptureStdout();
  add_levels(nothing, CollapseCost::quadric);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace collided::engine::files
