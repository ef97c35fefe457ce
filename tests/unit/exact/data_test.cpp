#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/mesh.hpp"
#include "tests/oracle/exact_data.hpp"
#include "tests/oracle/exact_oracle.hpp"

namespace collided::engine::data_test {
namespace {

using oracle::Table;
using oracle::Wide;
using Row = std::vector<std::string>;

#define SKIP_WITHOUT_DATA() \
  if (oracle::exact_data().empty()) GTEST_SKIP() << "no folder of exact answers (COLLIDED_DATA)"

double number(const std::string& text) { return std::strtod(text.c_str(), nullptr); }
/// Mesh files hold float32 decimals.
double single(const std::string& text) { return static_cast<double>(std::strtof(text.c_str(), nullptr)); }
Vec3 vec(const Row& row, std::size_t at) { return {number(row[at]), number(row[at + 1]), number(row[at + 2])}; }
Triangle triangle_at(const Row& row, std::size_t at) { return {vec(row, at), vec(row, at + 3), vec(row, at + 6)}; }

/// size, matrix by rows, centre
Box box_at(const Row& row, std::size_t at) {
  Box box;
  box.half_m = vec(row, at) / 2;
  for (int k = 0; k < 3; ++k) box.axes.row(k) = vec(row, at + 3 + 3 * static_cast<std::size_t>(k));
  box.center = vec(row, at + 12);
  return box;
}

class TriangleFile : public testing::TestWithParam<const char*> {};

TEST_P(TriangleFile, EveryPairEveryOrder) {
  SKIP_WITHOUT_DATA();
  const Table table = oracle::read_table(oracle::exact_data() / "tritri" / GetParam());
  const std::size_t at = table.column("a0x");
  for (const Row& row : table.rows) {
    const Triangle a = triangle_at(row, at);
    const Triangle b = triangle_at(row, at + 9);
    const Decision truth = row[table.column("intersects")] == "1" ? Decision::yes : Decision::no;
    for (const Triangle& rolled : {a, Triangle{a.b, a.c, a.a}, Triangle{a.c, a.b, a.a}}) {
      EXPECT_EQ(overlaps(rolled, b).decision, truth) << GetParam() << " " << row[0] << " " << row[1];
      EXPECT_EQ(overlaps(b, rolled).decision, truth) << GetParam() << " " << row[0] << " " << row[1];
    }
  }
}
INSTANTIATE_TEST_SUITE_P(ExactData, TriangleFile, testing::Values("generated.csv.gz", "loki.csv", "issues.csv"));

std::vector<Triangle> read_obj(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind, a, b, c;
    words >> kind >> a >> b >> c;
    if (kind == "v") vertices.emplace_back(single(a), single(b), single(c));
    const auto corner = [&](const std::string& text) { return vertices.at(std::stoul(text) - 1); };
    if (kind == "f") triangles.push_back({corner(a), corner(b), corner(c)});
  }
  return triangles;
}

/// The nearest hits of one ray by trying every triangle and ordering exactly.
struct NearestHits {
  std::vector<std::size_t> ids;
  int total = 0;
  RayHit hit;
};

NearestHits try_all(const Ray& ray, const std::vector<Triangle>& triangles) {
  NearestHits nearest;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    RayHit hit;
    if (!cast_ray(ray, triangles[i], hit).yes()) continue;
    ++nearest.total;
    const int order = nearest.ids.empty() ? -1 : compare_hits(ray, triangles[i], triangles[nearest.ids[0]]);
    if (order > 0) continue;
    if (order < 0) nearest.ids.clear();
    if (order < 0) nearest.hit = hit;
    nearest.ids.push_back(i);
  }
  return nearest;
}

std::string joined(const std::vector<std::size_t>& ids) {
  std::string text;
  for (const std::size_t id : ids) text += (text.empty() ? "" : ";") + std::to_string(id);
  return text;
}

class RayFile : public testing::TestWithParam<const char*> {};

TEST_P(RayFile, EveryRayAgainstEveryTriangle) {
  SKIP_WITHOUT_DATA();
  const std::filesystem::path folder = oracle::exact_data() / "ray";
  const std::vector<Triangle> triangles = read_obj(folder / (std::string(GetParam()) + ".obj"));
  const Table table = oracle::read_table(folder / (std::string(GetParam()) + ".rays.csv"));
  for (const Row& row : table.rows) {
    const Ray ray{{single(row[2]), single(row[3]), single(row[4])}, {single(row[5]), single(row[6]), single(row[7])}};
    const NearestHits found = try_all(ray, triangles);
    const bool truth = row[table.column("hit")] == "1";
    ASSERT_EQ(!found.ids.empty(), truth) << row[0] << " " << row[1];
    ASSERT_EQ(found.total, std::stoi(row[table.column("total_hits")])) << row[0] << " " << row[1];
    if (!truth) continue;
    ASSERT_EQ(joined(found.ids), row[table.column("closest_ids")]) << row[0] << " " << row[1];
    const Wide length = oracle::length(ray.direction);
    const Wide low = Wide(number(row[table.column("t_lo")])) * length;
    const Wide high = Wide(number(row[table.column("t_hi")])) * length;
    EXPECT_LE(Wide(found.hit.distance_m) - Wide(found.hit.distance_error_m), high) << row[0] << " " << row[1];
    EXPECT_GE(Wide(found.hit.distance_m) + Wide(found.hit.distance_error_m), low) << row[0] << " " << row[1];
  }
}
INSTANTIATE_TEST_SUITE_P(ExactData, RayFile,
                         testing::Values("cubegrid-16", "erleben-hole", "icosphere-3-r1e-12", "icosphere-4",
                                         "screw-big", "torus"));

struct MeshPair {
  const char* name;
  const char* fixed;  // files relative to the folder of exact answers
  const char* posed;
};

void PrintTo(const MeshPair& pair, std::ostream* out) { *out << pair.name; }

class MeshPairFile : public testing::TestWithParam<MeshPair> {};

/// Corner numbers of every triangle of a Wavefront file.
std::vector<TriangleCorners> read_corners(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<TriangleCorners> corners;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind, a, b, c;
    words >> kind >> a >> b >> c;
    const auto number_of = [](const std::string& text) { return static_cast<std::uint32_t>(std::stoul(text) - 1); };
    if (kind == "f") corners.push_back({number_of(a), number_of(b), number_of(c)});
  }
  return corners;
}

// The second mesh's vertices come posed, as doubles; every pair of triangles that meets is listed, and no other.
TEST_P(MeshPairFile, EveryTriangleAgainstEveryTriangle) {
  SKIP_WITHOUT_DATA();
  const std::filesystem::path root = oracle::exact_data();
  const std::vector<Triangle> fixed = read_obj(root / GetParam().fixed);
  const std::vector<TriangleCorners> corners = read_corners(root / GetParam().posed);
  const std::string name = GetParam().name;
  std::vector<std::vector<Vec3>> vertices;
  for (const Row& row : oracle::read_table(root / "meshpairs" / (name + ".vertices.csv.gz")).rows) {
    if (row[1] == "0") vertices.emplace_back();
    vertices.back().push_back(vec(row, 2));
  }
  std::set<std::array<std::size_t, 3>> expected;
  for (const Row& row : oracle::read_table(root / "meshpairs" / (name + ".pairs.csv.gz")).rows) {
    expected.insert({std::stoul(row[0]), std::stoul(row[1]), std::stoul(row[2])});
  }
  std::set<std::array<std::size_t, 3>> found;
  for (std::size_t pose = 0; pose < vertices.size(); ++pose) {
    const std::vector<Vec3>& v = vertices[pose];
    for (std::size_t j = 0; j < corners.size(); ++j) {
      const Triangle posed{v.at(corners[j][0]), v.at(corners[j][1]), v.at(corners[j][2])};
      for (std::size_t i = 0; i < fixed.size(); ++i) {
        const Decision decision = overlaps(fixed[i], posed).decision;
        ASSERT_NE(decision, Decision::undecided);
        if (decision == Decision::yes) found.insert({pose, i, j});
      }
    }
  }
  EXPECT_EQ(found, expected) << found.size() << " found, " << expected.size() << " expected";
}
INSTANTIATE_TEST_SUITE_P(ExactData, MeshPairFile,
                         testing::Values(MeshPair{"env-rob", "meshpairs/env.obj", "meshpairs/rob.obj"},
                                         MeshPair{"erleben-hole-spike", "meshes-rigid-ipc/erleben/hole.obj",
                                                  "meshes-rigid-ipc/erleben/spike.obj"},
                                         MeshPair{"erleben-wedge-wedge", "meshes-rigid-ipc/erleben/wedge.obj",
                                                  "meshes-rigid-ipc/erleben/wedge.obj"}));

void expect_contact(const Contact& contact, const Wide& signed_distance, const Row& row) {
  EXPECT_LE(abs(Wide(contact.depth_m) + signed_distance),
            Wide(contact.depth_error_m) + abs(signed_distance) * Wide(1e-37))
      << row[0] << " " << row[1] << " depth " << contact.depth_m << " truth " << signed_distance;
  EXPECT_NEAR(contact.normal.norm(), 1, 1e-14);
}

TEST(ExactData, BoxBoxDistances) {
  SKIP_WITHOUT_DATA();
  for (const char* file : {"box-box.csv.gz", "fcl-regressions.csv"}) {
    const Table table = oracle::read_table(oracle::exact_data() / "distance" / file);
    for (const Row& row : table.rows) {
      const Box a = box_at(row, table.column("a_sx"));
      const Box b = box_at(row, table.column("b_sx"));
      const Wide truth(row[table.column("signed_distance")]);
      ASSERT_EQ(overlaps(a, b).decision, truth > 0 ? Decision::no : Decision::yes) << file << " " << row[0];
      if (truth <= 0) expect_contact(contact(a, b), truth, row);
    }
  }
}

TEST(ExactData, BoxTriangleDistances) {
  SKIP_WITHOUT_DATA();
  const Table table = oracle::read_table(oracle::exact_data() / "distance" / "box-triangle.csv.gz");
  for (const Row& row : table.rows) {
    const Box box = box_at(row, table.column("a_sx"));
    const Triangle triangle = triangle_at(row, table.column("t0x"));
    const Wide truth(row[table.column("distance")]);
    ASSERT_EQ(overlaps(box, triangle).decision, truth > 0 ? Decision::no : Decision::yes) << row[0] << " " << row[1];
  }
}

TEST(ExactData, SphereTriangleDistances) {
  SKIP_WITHOUT_DATA();
  const Table table = oracle::read_table(oracle::exact_data() / "distance" / "sphere-triangle.csv.gz");
  for (const Row& row : table.rows) {
    const Sphere sphere{vec(row, table.column("cx")), number(row[table.column("r")])};
    const Triangle triangle = triangle_at(row, table.column("t0x"));
    const Wide truth(row[table.column("signed_distance")]);
    ASSERT_EQ(overlaps(sphere, triangle).decision, truth > 0 ? Decision::no : Decision::yes) << row[0] << " " << row[1];
    if (truth <= 0) expect_contact(contact(sphere, triangle), truth, row);
    const Closest nearest = closest(sphere.center, triangle);
    const Wide distance = truth + Wide(sphere.radius_m);
    EXPECT_LE(abs(Wide(nearest.distance_m) - distance), Wide(nearest.distance_error_m) + distance * Wide(1e-30))
        << row[0] << " " << row[1];
    EXPECT_LE(nearest.distance_error_m, 1e-12 * nearest.distance_m) << row[0] << " " << row[1];
  }
}

double number(const nlohmann::json& j) { return j.is_string() ? number(j.get<std::string>()) : j.get<double>(); }
Vec3 vec(const nlohmann::json& j) { return {number(j[0]), number(j[1]), number(j[2])}; }

/// "2", "1/2" or decimals.
Wide wide(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return Wide(text);
  return Wide(text.substr(0, slash)) / Wide(text.substr(slash + 1));
}

void expect_distance(const RayHit& hit, const nlohmann::json& expect, const Ray& ray, const std::string& id) {
  const Wide length = oracle::length(ray.direction);
  if (expect.contains("t")) {
    const Wide truth = wide(expect["t"]) * length;
    EXPECT_LE(abs(Wide(hit.distance_m) - truth), Wide(hit.distance_error_m)) << id;
  } else if (expect.contains("t_between")) {
    const Wide slack = Wide(hit.distance_error_m) + Wide(1e-15) * Wide(hit.distance_m);
    EXPECT_LE(abs(Wide(hit.distance_m) - wide(expect["t_between"][0]) * length), slack) << id;
  }
}

void check_triangles(const nlohmann::json& c) {
  const std::string id = c["id"];
  const nlohmann::json& expect = c["expect"];
  if (expect.contains("error")) return;  // refused at the border, before the exact phase
  Ray ray{vec(c["input"]["o"]), vec(c["input"]["d"])};
  if (ray.direction.isZero(0)) return;
  if (c["input"].contains("tmax")) ray.length_m = number(c["input"]["tmax"]) * ray.direction.norm();
  std::vector<Triangle> triangles;
  for (const auto& t : c["input"]["triangles"]) triangles.push_back({vec(t[0]), vec(t[1]), vec(t[2])});
  const NearestHits found = try_all(ray, triangles);
  ASSERT_EQ(!found.ids.empty(), expect["hit"].get<bool>()) << id;
  EXPECT_EQ(found.total, expect.value("total_hits", found.total)) << id;
  if (found.ids.empty()) return;
  EXPECT_EQ(found.ids, expect.value("closest_ids", found.ids)) << id;
  expect_distance(found.hit, expect, ray, id);
}

void check_solids(const nlohmann::json& c) {
  const std::string id = c["id"];
  const nlohmann::json& in = c["input"];
  const nlohmann::json& expect = c["expect"];
  if (c["query"] == "ray-sphere" || c["query"] == "ray-aabb") {
    const Ray ray{vec(in["o"]), vec(in["d"])};
    RayHit hit;
    Decision decision;
    if (c["query"] == "ray-sphere") {
      decision = cast_ray(ray, Sphere{vec(in["c"]), number(in["r"])}, hit).decision;
    } else {
      const Vec3 low = vec(in["lo"]);
      const Vec3 high = vec(in["hi"]);
      decision = cast_ray(ray, Box{(low + high) / 2, Mat3::Identity(), (high - low) / 2}, hit).decision;
    }
    ASSERT_EQ(decision, expect["hit"].get<bool>() ? Decision::yes : Decision::no) << id;
    if (decision == Decision::yes) expect_distance(hit, expect, ray, id);
  } else if (c["query"] == "sphere-sphere") {
    const Sphere a{vec(in["a"]), number(in["ra"])};
    const Sphere b{vec(in["b"]), number(in["rb"])};
    ASSERT_EQ(overlaps(a, b).yes(), expect["overlap_closed"].get<bool>()) << id;
    if (overlaps(a, b).yes()) {
      const Contact touch = contact(a, b);
      const double truth = -number(expect["signed_distance"]);
      EXPECT_LE(std::abs(touch.depth_m - truth), touch.depth_error_m + 1e-15 * truth) << id;
      EXPECT_EQ(touch.depth_m == 0, expect["touching"].get<bool>()) << id;
    }
  }
}

TEST(ExactData, ClosedForms) {
  SKIP_WITHOUT_DATA();
  std::ifstream in(oracle::exact_data() / "closed-form" / "cases.json");
  const nlohmann::json known = nlohmann::json::parse(in);
  for (const auto& c : known["cases"]) {
    if (c["query"] == "ray-triangles") check_triangles(c);
    else check_solids(c);
  }
}

}  // namespace
}  // namespace collided::engine::data_test
