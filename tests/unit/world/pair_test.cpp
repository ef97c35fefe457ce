// Two objects of a world: distance, depth, crossings, containment; told alike in either order.
#include <gtest/gtest.h>

#include <set>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/world/query/pair_report.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

using extreme::Stage;

PairReport report(const World& world, ObjectId a, ObjectId b, const PairAsk& ask = {}) {
  return report_pair(*world.newest(), a, b, ask);
}

Placed placed_by_frame(const Snapshot& state, ObjectId id) {
  return {
      .info = state.objects[slot_of(id)].get(), .frame = state.frame(slot_of(id)), .bounds = state.bounds(slot_of(id))};
}

/// The slow twin: every part of the one with every part of the other.
struct Twin {
  double least_m = std::numeric_limits<double>::infinity();
  bool touches = false;
  std::set<std::pair<std::uint32_t, std::uint32_t>> triangles;

  Twin(const World& world, ObjectId a, ObjectId b) {
    const SnapshotRing::Lease state = world.newest();
    for (const PlacedPart& of_a : parts_of(placed_by_frame(*state, a))) {
      for (const PlacedPart& of_b : parts_of(placed_by_frame(*state, b))) {
        if (overlaps(of_a.part, of_b.part).yes()) {
          touches = true;
          triangles.emplace(of_a.triangle, of_b.triangle);
        } else {
          least_m = std::min(least_m, separation(of_a.part, of_b.part).distance_m);
        }
      }
    }
  }
};

/// One part of each kind a side: what an object may be made of.
std::vector<Shape> shapes_of_all_forms() {
  Shape balls;
  for (int i = 0; i < 40; ++i)
    balls.primitives.emplace_back(Sphere{{0.2 * (i % 5), 0.2 * (i / 5 % 4), 0.3 * (i / 20)}, 0.3});
  Shape mesh;
  mesh.mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(2, 1));
  Shape both = mesh;
  both.primitives = {Box{.center = {0.5, 0, 0}, .half_m = {1, 0.2, 0.2}}, Sphere{{0, 0.5, 0}, 0.5}};
  Shape few;
  few.primitives = {balls.primitives[0], balls.primitives[1], balls.primitives[7]};
  return {balls, mesh, both, few};
}

// Whoever has seen enough is told no more: a search for the first pair would go through all of them.
TEST(WorldPartPairs, AWalkEndsWhereItsVisitorSaysSo) {
  const std::vector<Shape> shapes = shapes_of_all_forms();
  for (std::size_t first = 0; first < shapes.size(); ++first) {
    for (std::size_t second = 0; second < shapes.size(); ++second) {
      Stage stage;
      const ObjectId a = stage.add("a", shapes[first], {}, false);
      const ObjectId b = stage.add("b", shapes[second], extreme::at({0.1, 0.2, 0.3}), false);
      stage.step();
      const SnapshotRing::Lease state = stage.world.newest();
      for (int wanted = 1; wanted < 20; wanted += 6) {
        int told = 0;
        WalkCost cost;
        visit_part_pairs(
            placed_by_frame(*state, a), placed_by_frame(*state, b), 0,
            [&](const PlacedPart&, const PlacedPart&) { return ++told < wanted; }, cost);
        EXPECT_LE(told, wanted) << first << " with " << second;
        EXPECT_GT(told, 0) << first << " with " << second;
      }
    }
  }
}

// A ball that rests on a mesh to the last digit is decided beyond doubles, whichever of the two is the first.
TEST(WorldTouch, ThePairOfAMeshAndASolidSaysHowExactlyItWasDecided) {
  for (const bool mesh_first : {true, false}) {
    for (const double height_m : {0.3, 0.1}) {
      Stage stage;
      Shape floor;
      auto mesh = std::make_shared<TriangleMesh>();
      mesh->vertices = {{-9, -9, 0.1}, {9, -9, 0.1}, {0, 9, 0.1}};
      mesh->triangles = {{0, 1, 2}};
      floor.mesh = mesh;
      const Shape ball = extreme::ball_shape(0.2);
      // 0.3 is a little less than 0.1 + 0.2, by a rounding alone.
      const ObjectId a = mesh_first ? stage.add("floor", floor, {}, false)
                                    : stage.add("ball", ball, extreme::at({0, 0, height_m}), false);
      const ObjectId b = mesh_first ? stage.add("ball", ball, extreme::at({0, 0, height_m}), false)
                                    : stage.add("floor", floor, {}, false);
      stage.step();
      const SnapshotRing::Lease state = stage.world.newest();
      ContactSearch touch;
      WalkCost cost;
      search_objects(placed_by_frame(*state, a), placed_by_frame(*state, b), touch, cost);
      EXPECT_TRUE(touch.yes) << mesh_first << ' ' << height_m;
      EXPECT_EQ(touch.level > Level::filter, height_m == 0.3) << mesh_first;
      EXPECT_FALSE(touch.undecided);
      EXPECT_EQ(touch.exact_tests, 1u);
      const PrecisionScope filter_alone({.highest = Level::filter});
      ContactSearch quick;
      search_objects(placed_by_frame(*state, a), placed_by_frame(*state, b), quick, cost);
      EXPECT_EQ(quick.yes, height_m == 0.1) << mesh_first;
      EXPECT_EQ(quick.undecided, height_m == 0.3) << "what was not allowed to be decided is not called apart";
    }
  }
}

void expect_turned(const PairReport& one, const PairReport& other) {
  EXPECT_EQ(one.touches, other.touches);
  EXPECT_EQ(one.contact.depth_m, other.contact.depth_m);
  EXPECT_EQ(one.contact.point, other.contact.point);
  EXPECT_EQ(one.contact.normal, -other.contact.normal);
  EXPECT_EQ(one.contact.depth_error_m, other.contact.depth_error_m);
  EXPECT_EQ(one.a_triangle, other.b_triangle);
  EXPECT_EQ(one.b_triangle, other.a_triangle);
  EXPECT_EQ(one.contained == Contained::a_in_b, other.contained == Contained::b_in_a);
  EXPECT_EQ(one.contained == Contained::b_in_a, other.contained == Contained::a_in_b);
  EXPECT_EQ(one.separation.error_m, other.separation.error_m);
  EXPECT_EQ(one.separation.point_error_m, other.separation.point_error_m);
  EXPECT_EQ(one.separation.distance_m, other.separation.distance_m);
  EXPECT_EQ(one.separation.on_a, other.separation.on_b);
  EXPECT_EQ(one.separation.on_b, other.separation.on_a);
  EXPECT_EQ(one.separation.normal, -other.separation.normal);
  ASSERT_EQ(one.manifold.size(), other.manifold.size());
  for (std::size_t i = 0; i < one.manifold.size(); ++i) {
    EXPECT_EQ(one.manifold[i].point, other.manifold[i].point);
    EXPECT_EQ(one.manifold[i].depth_m, other.manifold[i].depth_m);
    EXPECT_EQ(one.manifold[i].depth_error_m, other.manifold[i].depth_error_m);
    EXPECT_EQ(one.manifold[i].a_triangle, other.manifold[i].b_triangle);
    EXPECT_EQ(one.manifold[i].b_triangle, other.manifold[i].a_triangle);
  }
  EXPECT_EQ(one.crossing_count, other.crossing_count);
  std::set<std::pair<std::uint32_t, std::uint32_t>> turned;
  for (const TriangleCrossing& c : other.crossings) turned.emplace(c.b, c.a);
  std::set<std::pair<std::uint32_t, std::uint32_t>> straight;
  for (const TriangleCrossing& c : one.crossings) straight.emplace(c.a, c.b);
  EXPECT_EQ(straight, turned);
}

Pose random_pose(std::mt19937_64& generator, double spread_m) {
  std::uniform_real_distribution<double> any(-1, 1);
  return extreme::at(spread_m * Vec3(any(generator), any(generator), any(generator)),
                     Quat(any(generator), any(generator), any(generator), any(generator)).normalized());
}

std::vector<Shape> shapes_of_all_kinds(std::mt19937_64& generator) {
  oracle::RandomShapes random(generator, oracle::Family::random);
  std::vector<Shape> shapes;
  for (const Primitive& primitive :
       {Primitive(random.sphere()), Primitive(random.box()), Primitive(random.capsule()), Primitive(random.cylinder()),
        Primitive(random.cone()), Primitive(random.ellipsoid()), Primitive(random.hull())}) {
    shapes.push_back({.primitives = {primitive}, .mesh = nullptr});
  }
  shapes.push_back(extreme::mesh_shape(latitude_longitude_sphere(0.6, 10, 6)));
  Shape compound = extreme::mesh_shape(latitude_longitude_sphere(0.3, 6, 4));
  compound.primitives = {random.sphere(), random.box()};
  shapes.push_back(compound);
  return shapes;
}

TEST(PairReports, AreAsEveryPairOfPartsSays) {
  std::mt19937_64 generator = oracle::seeded(5);
  int touching = 0;
  int apart = 0;
  for (int round = 0; round < 12; ++round) {
    const std::vector<Shape> shapes = shapes_of_all_kinds(generator);
    for (const Shape& first : shapes) {
      for (const Shape& second : shapes) {
        Stage stage;
        const ObjectId a = stage.add("a", first, random_pose(generator, 1.2));
        const ObjectId b = stage.add("b", second, random_pose(generator, 1.2));
        stage.step();
        Twin twin(stage.world, a, b);
        const PairReport found = report(stage.world, a, b, {.triangles = true});
        expect_turned(found, report(stage.world, b, a, {.triangles = true}));
        ASSERT_EQ(found.touches, twin.touches ? Decision::yes : Decision::no);
        if (!twin.touches) {
          ++apart;
          ASSERT_LE(std::abs(found.separation.distance_m - twin.least_m), found.separation.error_m + 1e-12);
          const Vec3 displacement = found.separation.on_b - found.separation.on_a;
          ASSERT_NEAR(displacement.norm(), found.separation.distance_m,
                      found.separation.error_m + 2 * found.separation.point_error_m + 1e-12);
          continue;
        }
        ++touching;
        ASSERT_GE(found.manifold.size(), 1u);
        ASSERT_LE(found.manifold.size(), 4u);
        if (!first.mesh || !second.mesh) continue;
        std::erase_if(twin.triangles,
                      [](const auto& pair) { return pair.first == kNoTriangle || pair.second == kNoTriangle; });
        std::set<std::pair<std::uint32_t, std::uint32_t>> told;
        for (const TriangleCrossing& c : found.crossings) told.emplace(c.a, c.b);
        ASSERT_EQ(told, twin.triangles);
      }
    }
  }
  EXPECT_GT(touching, 100);
  EXPECT_GT(apart, 50);
}

// Values known by hand, told in the order asked in, whichever name comes first in the alphabet.
TEST(PairReports, NormalsPointsAndTrianglesAreThoseOfTheFirstAndTheSecondAsked) {
  TriangleMesh floor{{{-9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, {9, -9, 0}}, {{0, 1, 2}, {0, 3, 1}}};
  for (const bool floor_named_first : {true, false}) {
    Stage stage;
    const ObjectId ground =
        stage.add(floor_named_first ? "a" : "z", extreme::mesh_shape(floor), extreme::at({0, 0, 0}));
    const ObjectId high =
        stage.add("high", {.primitives = {Sphere{Vec3::Zero(), 0.5}}, .mesh = nullptr}, extreme::at({3, 1, 2}));
    const ObjectId low =
        stage.add("low", {.primitives = {Sphere{Vec3::Zero(), 0.5}}, .mesh = nullptr}, extreme::at({3, 1, 0.25}));
    stage.step();
    const PairReport up = report(stage.world, ground, high);
    ASSERT_EQ(up.touches, Decision::no);
    EXPECT_NEAR(up.separation.distance_m, 1.5, up.separation.error_m);
    EXPECT_NEAR((up.separation.normal - Vec3::UnitZ()).norm(), 0, 1e-12);
    EXPECT_NEAR((up.separation.on_a - Vec3(3, 1, 0)).norm(), 0, 1e-12);
    EXPECT_NEAR((up.separation.on_b - Vec3(3, 1, 1.5)).norm(), 0, 1e-12);
    expect_turned(up, report(stage.world, high, ground));
    const PairReport touching = report(stage.world, ground, low);
    ASSERT_EQ(touching.touches, Decision::yes);
    EXPECT_NEAR((touching.contact.normal - Vec3::UnitZ()).norm(), 0, 1e-12);
    EXPECT_NEAR(touching.contact.depth_m, 0.25, touching.contact.depth_error_m + 1e-15);
    EXPECT_EQ(touching.a_triangle, 1u) << "the half of the floor where x > y";
    EXPECT_EQ(touching.b_triangle, kNoTriangle);
    ASSERT_EQ(touching.manifold.size(), 1u);
    EXPECT_EQ(touching.manifold[0].a_triangle, 1u);
    EXPECT_EQ(touching.manifold[0].b_triangle, kNoTriangle);
    expect_turned(touching, report(stage.world, low, ground));
  }
}

TEST(PairReports, CountAllCrossingsAndTellWhatFits) {
  Stage stage;
  const TriangleMesh ball = latitude_longitude_sphere(1, 24, 16);
  const ObjectId a = stage.add("a", extreme::mesh_shape(ball), extreme::at({0, 0, 0}));
  const ObjectId b = stage.add("b", extreme::mesh_shape(ball), extreme::at({0.7, 0.2, 0.1}));
  stage.step();
  const PairReport all = report(stage.world, a, b, {.triangles = true});
  EXPECT_EQ(all.crossings.size(), all.crossing_count);
  ASSERT_GT(all.crossing_count, 20u);
  const PairReport some = report(stage.world, a, b, {.triangles = true, .most_crossings = 10});
  EXPECT_EQ(some.crossings.size(), 10u);
  EXPECT_EQ(some.crossing_count, all.crossing_count);
  EXPECT_LE(all.manifold.size(), 4u);
}

TEST(PairReports, OneMeshWithinAnother) {
  Stage stage;
  const ObjectId outer =
      stage.add("outer", extreme::mesh_shape(latitude_longitude_sphere(2, 12, 8)), extreme::at({1, 2, 3}));
  const ObjectId inner =
      stage.add("inner", extreme::mesh_shape(latitude_longitude_sphere(0.3, 8, 6)), extreme::at({1.1, 2, 3}));
  const ObjectId ball = stage.ball("ball", {1, 2.5, 3}, 0.2);
  const ObjectId summand = stage.ball("beside", {2.9, 3.9, 3}, 0.1);  // in its bounds, not in it
  stage.step();
  EXPECT_EQ(report(stage.world, outer, inner).contained, Contained::b_in_a);
  EXPECT_EQ(report(stage.world, inner, outer).contained, Contained::a_in_b);
  EXPECT_EQ(report(stage.world, outer, ball).contained, Contained::b_in_a);
  EXPECT_EQ(report(stage.world, outer, summand).contained, Contained::none);
  EXPECT_EQ(report(stage.world, inner, ball).contained, Contained::none);
  const auto two_balls = [&](const std::string& name, double apart_m) {
    TriangleMesh both = latitude_longitude_sphere(0.3, 8, 6);
    const auto first = static_cast<std::uint32_t>(both.vertices.size());
    const TriangleMesh one = both;
    for (const Vec3& v : one.vertices) both.vertices.push_back(v + Vec3{apart_m, 0, 0});
    for (const TriangleCorners& t : one.triangles) both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return stage.add(name, extreme::mesh_shape(both), extreme::at({1, 2, 3}));
  };
  const ObjectId near = two_balls("near", 1);
  const ObjectId far = two_balls("far", 5);
  stage.step();
  EXPECT_EQ(report(stage.world, outer, near).contained, Contained::b_in_a);
  EXPECT_EQ(report(stage.world, outer, far).contained, Contained::none) << "one piece of two is";
  TriangleMesh open = latitude_longitude_sphere(2, 12, 8);
  open.triangles.pop_back();
  const ObjectId shell = stage.add("shell", extreme::mesh_shape(open), extreme::at({9, 9, 9}));
  const ObjectId in_shell = stage.ball("in shell", {9, 9, 9}, 0.2);
  stage.step();
  EXPECT_EQ(report(stage.world, shell, in_shell).contained, Contained::none) << "an open surface holds nothing";
}

// A box that rests on a floor of many triangles bears on its own four corners.
TEST(PairReports, ABoxOnATessellatedFloorBearsOnItsCorners) {
  Stage stage;
  TriangleMesh floor;
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 10; ++j) floor.vertices.emplace_back(i - 5.0, j - 5.0, 0);
  }
  for (std::uint32_t i = 0; i < 10; ++i) {
    for (std::uint32_t j = 0; j < 10; ++j) {
      const std::uint32_t a = i * 11 + j;
      floor.triangles.push_back({a, a + 11, a + 12});
      floor.triangles.push_back({a, a + 12, a + 1});
    }
  }
  stage.load("floor", floor);
  const ObjectId box = stage.add("box", extreme::box_shape({1.3, 0.9, 0.5}), extreme::at({0.2, 0.1, 0.49}));
  stage.step();
  const PairReport found = report(stage.world, *stage.world.find("floor"), box);
  ASSERT_EQ(found.manifold.size(), 4u);
  for (const ManifoldPoint& p : found.manifold) {
    EXPECT_NEAR(std::abs(p.point.x() - 0.2), 1.3, 1e-9);
    EXPECT_NEAR(std::abs(p.point.y() - 0.1), 0.9, 1e-9);
    EXPECT_NEAR(p.depth_m, 0.01, p.depth_error_m + 1e-14);
  }
  EXPECT_NEAR((found.contact.normal - Vec3::UnitZ()).norm(), 0, 1e-12) << "from the floor to the box";
}

}  // namespace
}  // namespace collided::engine
