#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "server/intake/weld.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/solids/solid.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/solid_oracle.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"

namespace collided::engine {
namespace {

std::shared_ptr<const IndexedMesh> indexed(const TriangleMesh& mesh) {
  const auto shared = std::make_shared<const TriangleMesh>(mesh);
  return indexed_mesh(shared, Bvh::build(*shared, {.threads = 1, .progress = {}, .cancelled = {}}));
}

TriangleMesh turned_over(TriangleMesh mesh) {
  for (TriangleCorners& corners : mesh.triangles) std::swap(corners[1], corners[2]);
  return mesh;
}

TriangleMesh together(TriangleMesh first, const TriangleMesh& more) {
  scenes::append(first, more);
  return first;
}

TriangleMesh scaled(TriangleMesh mesh, double factor, const Vec3& to = Vec3::Zero()) {
  for (Vec3& vertex : mesh.vertices) vertex = factor * vertex + to;
  return mesh;
}

/// Boxes side by side that share corners, without the faces between them: steps, whose planes hold many faces.
TriangleMesh steps() {
  TriangleMesh mesh;
  const auto quad = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& v : {a, b, c, d}) mesh.vertices.push_back(v);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  constexpr int kSteps = 4;
  for (int i = 0; i < kSteps; ++i) {
    const double high = kSteps - i;
    const double x = i;
    quad({x, 0, high}, {x + 1, 0, high}, {x + 1, 1, high}, {x, 1, high});
    quad({x, 0, 0}, {x, 1, 0}, {x + 1, 1, 0}, {x + 1, 0, 0});
    for (int z = 0; z < kSteps - i; ++z) {
      const double low = z;
      quad({x, 0, low}, {x + 1, 0, low}, {x + 1, 0, low + 1}, {x, 0, low + 1});
      quad({x, 1, low}, {x, 1, low + 1}, {x + 1, 1, low + 1}, {x + 1, 1, low});
      if (i == 0) quad({0, 0, low}, {0, 0, low + 1}, {0, 1, low + 1}, {0, 1, low});
    }
    quad({x + 1, 0, high - 1}, {x + 1, 1, high - 1}, {x + 1, 1, high}, {x + 1, 0, high});
  }
  weld_equal_vertices(mesh);
  return mesh;
}

/// A fan of thin triangles about a point far above its base: all of them in every cell about the point.
TriangleMesh spire(std::uint32_t count) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 100}, {0, 0, 0}};
  for (std::uint32_t i = 0; i < count; ++i) {
    const double turn = 2 * M_PI * i / count;
    const double radius = i % 2 == 0 ? 1 : 0.5;  // not convex
    mesh.vertices.push_back({radius * std::cos(turn), radius * std::sin(turn), 0});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t here = 2 + i;
    const std::uint32_t next = 2 + (i + 1) % count;
    mesh.triangles.push_back({0, here, next});
    mesh.triangles.push_back({1, next, here});
  }
  return mesh;
}

struct NamedMesh {
  const char* name;
  TriangleMesh mesh;
};

std::vector<NamedMesh> closed_meshes(std::mt19937_64& random) {
  const TriangleMesh small = scenes::box({0.25, 0.25, 0.25});
  return {{"box", scenes::box({1, 2, 3})},
          {"sphere", scenes::icosphere(2, 1)},
          {"rough sphere", scenes::rough_sphere(2, random)},
          {"far off", scaled(scenes::icosphere(2, 1), 1, {1e6 + 0.1, -3e6, 7e5})},
          {"tiny", scaled(scenes::icosphere(1, 1), 1e-200)},
          {"huge", scaled(scenes::icosphere(1, 1), 1e200)},
          {"steps", steps()},
          {"spire", spire(40)},
          {"cavity", together(scenes::box({1, 1, 1}), turned_over(small))},
          {"corner to corner", together(scenes::box({1, 1, 1}), scenes::box({1, 1, 1}, {2, 2, 2}))},
          {"edge to edge", together(scenes::box({1, 1, 1}), scenes::box({1, 1, 1}, {2, 2, 0}))}};
}

/// Meshes that are closed and more than a border.
std::vector<NamedMesh> overlapping_meshes() {
  const TriangleMesh box = scenes::box({1, 1, 1});
  return {{"two that cross", together(box, scenes::box({1, 1, 1}, {1, 0.5, 0.25}))},
          {"one in another", together(box, scenes::box({0.5, 0.5, 0.5}))},
          {"face to face", together(box, scenes::box({1, 1, 1}, {2, 0, 0}))},
          {"each twice", together(box, box)}};
}

/// Points where a decision is easily wrong: on corners, edges and faces as near as doubles come, in the planes of many
/// faces, and the neighbours of all those.
class HardPoints {
 public:
  HardPoints(const TriangleMesh& mesh, std::mt19937_64& random) : mesh_(mesh), random_(random) {
    for (const Vec3& vertex : mesh.vertices) box_.extend(vertex);
  }

  Vec3 next() {
    Vec3 point = of_kind(static_cast<int>(random_() % 6));
    for (int axis = 0; axis < 3; ++axis) {
      const auto by = static_cast<int>(random_() % 5);
      if (by < 2) point[axis] = std::nextafter(point[axis], by == 0 ? -INFINITY : INFINITY);
    }
    return point;
  }

 private:
  double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  const Vec3& any_vertex() { return mesh_.vertices[random_() % mesh_.vertices.size()]; }
  Vec3 of_kind(int kind) {
    const Triangle t = mesh_.triangle(static_cast<std::uint32_t>(random_() % mesh_.triangles.size()));
    const double a = share();
    const double b = share() * (1 - a);
    switch (kind) {
      case 0: return t.a;
      case 1: return t.a / 2 + t.b / 2;
      case 2: return t.a + a * (t.b - t.a);
      case 3: return (t.a + a * (t.b - t.a)) + b * (t.c - t.a);
      case 4: return {any_vertex().x(), any_vertex().y(), any_vertex().z()};
      default: break;
    }
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = box_.low[axis] + share() * (box_.high[axis] - box_.low[axis]);
    return point;
  }

  const TriangleMesh& mesh_;
  std::mt19937_64& random_;
  Aabb box_;
};

int points_a_mesh() {
  const char* asked = std::getenv("COLLIDED_SOLID_POINTS");
  return asked != nullptr ? std::atoi(asked) : 300;
}

void expect_sides(const NamedMesh& named, bool is_border, std::mt19937_64& random) {
  SCOPED_TRACE(named.name);
  const auto surface = indexed(named.mesh);
  SolidFindings findings;
  const auto solid = solid_within(surface, findings);
  ASSERT_TRUE(solid) << findings.refusal;
  EXPECT_EQ(findings.warning.empty(), is_border) << findings.warning;
  EXPECT_EQ(solid->tree.has_value(), is_border);
  const oracle::SolidOracle oracle(named.mesh);
  HardPoints points(named.mesh, random);
  int counts[3] = {};
  for (int i = 0; i < points_a_mesh(); ++i) {
    const Vec3 point = points.next();
    const SolidSide truth = oracle.side(oracle::rational(point), random);
    ++counts[static_cast<int>(truth)];
    WalkCost cost;
    const auto said = [&] { return testing::Message() << std::hexfloat << point.transpose(); };
    ASSERT_EQ(side_by_ray(*surface, point, cost).side, truth) << said();
    ASSERT_EQ(side_of(*solid, point, cost).side, truth) << said();
    if (!solid->tree) continue;
    std::uint32_t nodes = 0;
    const std::optional<SolidSide> by_tree = solid->tree->side(point, nodes);
    if (by_tree) { ASSERT_EQ(*by_tree, truth) << said(); }
  }
  for (const int count : counts) EXPECT_GT(count, points_a_mesh() / 100) << "such points must be among those tried";
}

TEST(WorldSolid, SidesOfHardPointsAreThoseOfRationals) {
  std::mt19937_64 random = oracle::seeded(24);
  for (const NamedMesh& named : closed_meshes(random)) expect_sides(named, true, random);
}

TEST(WorldSolid, WhereSurfacesOverlapInsideIsWhereTheyGoAround) {
  std::mt19937_64 random = oracle::seeded(25);
  for (const NamedMesh& named : overlapping_meshes()) expect_sides(named, false, random);
}

/// A solid built of boxes, some with a hollow: what holds a point is known from their bounds alone. Their numbers are eighths, so
/// that faces, edges and corners of several fall together; those of hollows are sixteenths, since the check takes a hollow that
/// shares an edge with another box for one surface with that, and may refuse it.
class BuiltOfBoxes {
 public:
  explicit BuiltOfBoxes(std::mt19937_64& random) : random_(random) {
    const int count = 1 + static_cast<int>(random_() % 5);
    for (int i = 0; i < count; ++i) {
      const Vec3 half(eighths(2, 12), eighths(2, 12), eighths(2, 12));
      const Vec3 center(eighths(-12, 12), eighths(-12, 12), eighths(-12, 12));
      add(half, center, true);
      if (random_() % 2 == 0) add(half - Vec3::Constant(0.0625), center, false);
    }
  }
  const TriangleMesh& mesh() const { return mesh_; }
  SolidSide side(const Vec3& point) const {
    int times = 0;
    for (const Part& part : parts_) {
      if ((point.array() < part.box.low.array()).any() || (point.array() > part.box.high.array()).any()) continue;
      if ((point.array() == part.box.low.array()).any() || (point.array() == part.box.high.array()).any())
        return SolidSide::on;
      times += part.is_outward ? 1 : -1;
    }
    return times > 0 ? SolidSide::in : SolidSide::out;
  }
  Vec3 any_point() {
    Vec3 point = Vec3(eighths(-52, 52), eighths(-52, 52), eighths(-52, 52)) / 2;
    for (double& x : point) {
      const auto by = random_() % 4;
      if (by < 2) x = std::nextafter(x, by == 0 ? -INFINITY : INFINITY);
    }
    return point;
  }

 private:
  struct Part {
    Aabb box;
    bool is_outward = true;
  };
  double eighths(int low, int high) { return 0.125 * std::uniform_int_distribution<int>(low, high)(random_); }
  void add(const Vec3& half, const Vec3& center, bool is_outward) {
    const TriangleMesh box = scenes::box(half, center);
    scenes::append(mesh_, is_outward ? box : turned_over(box));
    parts_.push_back({{center - half, center + half}, is_outward});
  }

  std::mt19937_64& random_;
  TriangleMesh mesh_;
  std::vector<Part> parts_;
};

TEST(WorldSolid, WhatIsBuiltOfBoxesHoldsWhatTheirBoundsSay) {
  std::mt19937_64 random = oracle::seeded(28);
  int counts[3] = {};
  for (int i = 0; i < points_a_mesh(); ++i) {
    BuiltOfBoxes built(random);
    const auto surface = indexed(built.mesh());
    SolidFindings findings;
    const auto solid = solid_within(surface, findings);
    ASSERT_TRUE(solid) << findings.refusal;
    for (int k = 0; k < 200; ++k) {
      const Vec3 point = built.any_point();
      const SolidSide truth = built.side(point);
      ++counts[static_cast<int>(truth)];
      WalkCost cost;
      const auto said = [&] { return testing::Message() << i << ": " << std::hexfloat << point.transpose(); };
      ASSERT_EQ(side_of(*solid, point, cost).side, truth) << said();
      ASSERT_EQ(side_by_ray(*surface, point, cost).side, truth) << said();
    }
  }
  for (const int count : counts) EXPECT_GT(count, points_a_mesh());
}

// The frame rounds; the answer is for the quaternion and the position as they were given.
TEST(WorldSolid, SidesAtAPoseAreThoseOfTheNumbersGiven) {
  std::mt19937_64 random = oracle::seeded(26);
  std::normal_distribution<double> normal;
  for (const NamedMesh& named : closed_meshes(random)) {
    const std::string_view name = named.name;
    if (name == "tiny" || name == "huge") continue;
    SCOPED_TRACE(named.name);
    SolidFindings findings;
    const auto solid = solid_within(indexed(named.mesh), findings);
    ASSERT_TRUE(solid);
    const oracle::SolidOracle oracle(named.mesh);
    HardPoints points(named.mesh, random);
    int by_rationals = 0;
    for (int i = 0; i < points_a_mesh() / 4; ++i) {
      Pose pose;
      pose.rotation = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
      pose.position = 10 * Vec3(normal(random), normal(random), normal(random));
      const Frame frame = frame_of(pose);
      ObjectInfo info;
      Placed placed{.info = &info, .frame = frame, .bounds = {}, .pose = &pose};
      for (const Vec3& vertex : named.mesh.vertices) placed.bounds.extend(place(frame, vertex));
      const Vec3 point = place(frame, points.next());
      WalkCost cost;
      const SideFound found = side_of_placed(*solid, placed, point, cost);
      by_rationals += found.level == Level::rational ? 1 : 0;
      ASSERT_EQ(found.side, oracle.side(oracle::seen_from(pose, point), random)) << std::hexfloat << point.transpose();
      // Where no pose was given, the placed corners are the input.
      placed.pose = nullptr;
      TriangleMesh there = named.mesh;
      for (Vec3& vertex : there.vertices) vertex = place(frame, vertex);
      ASSERT_EQ(side_of_placed(*solid, placed, point, cost).side,
                oracle::SolidOracle(there).side(oracle::rational(point), random))
          << std::hexfloat << point.transpose();
    }
    EXPECT_GT(by_rationals, 0) << "some points must hang on the rounding of the frame";
  }
}

// 0.1 + 0.2 is above 0.3: with a rounded position the point would be on the other side of the face.
TEST(WorldSolid, ARoundedPositionDoesNotMoveTheFace) {
  SolidFindings findings;
  const auto solid = solid_within(indexed(scenes::box({0.2, 1, 1})), findings);
  Pose pose;
  pose.position = {0.1, 0, 0};
  const Frame frame = frame_of(pose);
  ObjectInfo info;
  const Placed placed{.info = &info, .frame = frame, .bounds = {{-0.1, -1, -1}, {0.31, 1, 1}}, .pose = &pose};
  WalkCost cost;
  // The face is at 0.1 + 0.2 exactly, between these two doubles.
  EXPECT_EQ(side_of_placed(*solid, placed, {0.30000000000000004, 0, 0}, cost).side, SolidSide::out);
  EXPECT_EQ(side_of_placed(*solid, placed, {0.3, 0, 0}, cost).side, SolidSide::in);
}

std::string refusal_of(const TriangleMesh& mesh) { return checked(*indexed(mesh)).refusal; }

TEST(WorldSolid, AMeshThatBoundsNothingIsRefusedWithTheReason) {
  TriangleMesh open = scenes::box({1, 1, 1});
  open.triangles.pop_back();
  EXPECT_NE(refusal_of(open).find("does not close"), std::string::npos) << refusal_of(open);
  EXPECT_NE(refusal_of(turned_over(scenes::box({1, 1, 1}))).find("inside out"), std::string::npos);
  TriangleMesh one_flipped = scenes::box({1, 1, 1});
  std::swap(one_flipped.triangles[3][1], one_flipped.triangles[3][2]);
  EXPECT_NE(refusal_of(one_flipped).find("face different ways"), std::string::npos) << refusal_of(one_flipped);
  TriangleMesh fin = scenes::box({1, 1, 1});
  fin.vertices.push_back({5, 5, 5});
  fin.triangles.push_back(
      {fin.triangles[0][0], fin.triangles[0][1], static_cast<std::uint32_t>(fin.vertices.size() - 1)});
  EXPECT_NE(refusal_of(fin), "");
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_NE(refusal_of(flat).find("encloses no volume"), std::string::npos) << refusal_of(flat);
  TriangleMesh point;
  point.vertices = {{0, 0, 0}};
  point.triangles = {{0, 0, 0}};
  EXPECT_NE(refusal_of(point).find("no triangle"), std::string::npos);
}

// A mesh without shared corners, as STL has it, closes all the same; triangles without area hold no water either.
TEST(WorldSolid, CornersCloseByTheirPlaces) {
  TriangleMesh loose;
  const TriangleMesh box = scenes::box({1, 1, 1});
  for (std::uint32_t i = 0; i < box.triangles.size(); ++i) {
    const Triangle t = box.triangle(i);
    const auto first = static_cast<std::uint32_t>(loose.vertices.size());
    for (const Vec3& corner : {t.a, t.b, t.c}) loose.vertices.push_back(corner);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(refusal_of(loose), "");
  loose.triangles.push_back({0, 0, 1});
  EXPECT_EQ(refusal_of(loose), "");
  SolidFindings findings;
  const auto solid = solid_within(indexed(loose), findings);
  ASSERT_TRUE(solid && solid->tree);
  WalkCost cost;
  EXPECT_EQ(side_of(*solid, {0.5, 0.5, 0.5}, cost).side, SolidSide::in);
  EXPECT_EQ(side_of(*solid, {1, 0.5, 0.5}, cost).side, SolidSide::on);
  EXPECT_EQ(side_of(*solid, {1.5, 0.5, 0.5}, cost).side, SolidSide::out);
}

TEST(WorldSolid, ATreeHasFewPiecesAndIsNotAList) {
  SolidFindings findings;
  const auto solid = solid_within(indexed(scenes::icosphere(4, 1)), findings);
  ASSERT_TRUE(solid && solid->tree);
  const SolidTreeReport& report = solid->tree->report();
  EXPECT_LE(report.fragments, 3 * report.triangles);
  EXPECT_LE(report.depth, 100u) << "the faces of a convex body alone would make a list of 5,120";
  EXPECT_GT(report.across_nodes, 0u);
}

}  // namespace
}  // namespace collided::engine
