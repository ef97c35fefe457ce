#include <gtest/gtest.h>

#include <cmath>

#include "server/world/objects/swept_object.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

ObjectInfo mesh_object(TriangleMesh mesh) {
  double radius_m = 0;
  for (const Vec3& v : mesh.vertices) radius_m = std::max(radius_m, v.norm() * (1 + 1e-15));
  auto shared = std::make_shared<const TriangleMesh>(std::move(mesh));
  Bvh tree = Bvh::build(*shared);
  ObjectInfo info;
  info.mesh = std::make_shared<const IndexedMesh>(IndexedMesh{shared, std::move(tree), radius_m});
  return info;
}

ObjectInfo primitive_object(const Primitive& primitive) {
  ObjectInfo info;
  info.primitives = {primitive};
  return info;
}

Frame frame_at(const Vec3& position) { return {Mat3::Identity(), position}; }

TEST(SweptContact, TheEarliestContactWinsAndOfEqualOnesThatWithTheLowestNumbers) {
  SweptContact touch;
  EXPECT_TRUE(touch.take({0.5, 0.75}, 5, 5));
  EXPECT_FALSE(touch.take({0.25, 0.75}, 5, 6));
  EXPECT_FALSE(touch.take({0.25, 0.75}, 6, 0));
  EXPECT_FALSE(touch.take({0.25, 0.75}, 5, 5)) << "it is that one";
  EXPECT_EQ(touch.bracket.low, 0.25) << "one with a later end may begin earlier";
  EXPECT_TRUE(touch.take({0.3, 0.75}, 4, 9));
  EXPECT_TRUE(touch.take({0.3, 0.7}, 8, 8));
  EXPECT_EQ(touch.a_triangle, 8U);
  EXPECT_EQ(touch.bracket.high, 0.7);
  EXPECT_EQ(touch.bracket.low, 0.25);
}

struct IndexedTriangles {
  StaticScene scene;

  explicit IndexedTriangles(TriangleMesh mesh) {
    scene.tree = Bvh::build(mesh);
    scene.mesh = std::move(mesh);
  }
  SweptContact ask(const ObjectInfo& info, const Frame& from, const Frame& to, const SweepOptions& options = {}) const {
    WalkCost cost;
    SweptContact touch;
    sweep(SweptBody(info, BodyMotion(from, to)), SweptBody(scene), options, cost, touch);
    return touch;
  }
};

TEST(WorldSweptObject, ABoxAndTheMeshOfItsSidesMeetAScanAtTheSameTime) {
  std::mt19937_64 generator = oracle::seeded(61);
  std::uniform_real_distribution<double> place(-3, 3);
  const auto point = [&] { return Vec3(place(generator), place(generator), place(generator)); };
  const IndexedTriangles scene{scenes::icosphere(3, 1)};
  const Vec3 half_m(0.25, 0.5, 0.125);
  const ObjectInfo box = primitive_object(Box{.center = Vec3::Zero(), .half_m = half_m});
  const ObjectInfo mesh = mesh_object(scenes::box(half_m));
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 from = 3 * point().normalized();
    Frame to = frame_at(point());
    if (i % 2 == 1) to.rotation = Eigen::AngleAxisd(place(generator), point().normalized()).toRotationMatrix();
    const SweptContact one = scene.ask(box, frame_at(from), to);
    const SweptContact other = scene.ask(mesh, frame_at(from), to);
    ASSERT_FALSE(one.undecided || other.undecided);
    ASSERT_EQ(one.yes, other.yes) << i;
    if (!one.yes) continue;
    ++hits;
    ASSERT_LE(one.bracket.low, other.bracket.high + 1e-12);
    ASSERT_GE(one.bracket.high + 1e-12, other.bracket.low);
    ASSERT_LE(one.bracket.high - one.bracket.low, 2e-6);
  }
  EXPECT_GT(hits, 20);
}

TEST(WorldSweptObject, NoKindOfMoverPassesThroughASheet) {
  const IndexedTriangles sheet{{{{5, -9, -9}, {5, 9, -9}, {5, 0, 9}}, {{0, 1, 2}}}};
  const Vec3 half_m = Vec3::Constant(0x1p-10);
  const Frame to = frame_at({0x1p20, 0, 0});
  for (const ObjectInfo& info : {primitive_object(Box{.center = Vec3::Zero(), .half_m = half_m}),
                                 primitive_object(Capsule{{0, 0, 0}, {0, 0x1p-10, 0}, 0x1p-10}),
                                 primitive_object(Cylinder{{-0x1p-10, 0, 0}, {0x1p-10, 0, 0}, 0x1p-10}),
                                 primitive_object(Cone{{0x1p-10, 0, 0}, {-0x1p-10, 0, 0}, 0x1p-10}),
                                 primitive_object(Ellipsoid{.center = Vec3::Zero(), .half_m = half_m}),
                                 primitive_object(Sphere{Vec3::Zero(), 0x1p-10}), mesh_object(scenes::box(half_m))}) {
    const double truth = (5 - 0x1p-10) * 0x1p-20;
    const SweptContact touch = sheet.ask(info, frame_at(Vec3::Zero()), to, {.width = 1e-9});
    ASSERT_TRUE(touch.yes);
    EXPECT_LE(touch.bracket.low, truth);
    EXPECT_GE(touch.bracket.high, truth);
    EXPECT_LE(touch.bracket.high - touch.bracket.low, 1e-9);
    EXPECT_EQ(touch.b_triangle, 0u);
  }
}

/// A blade from the origin along x sweeps a quarter turn; a wire stands at 45 degrees.
TEST(WorldSweptObject, ATurningBladeMeetsAWireHalfWay) {
  const IndexedTriangles wire{{{{0.5, 0.5, -1}, {0.5, 0.5, 1}, {0.5, 0.5, 0}}, {{0, 1, 2}}}};
  const ObjectInfo blade = mesh_object({{{0, 0, -0.5}, {1, 0, 0}, {0, 0, 0.5}}, {{0, 1, 2}}});
  const ObjectInfo rod = primitive_object(Box{.center = {0.5, 0, 0}, .half_m = {0.5, 1e-3, 1e-3}});
  const Frame to{Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()).toRotationMatrix(), Vec3::Zero()};
  const SweptContact cut = wire.ask(blade, frame_at(Vec3::Zero()), to, {.width = 1e-9});
  // They share points for an instant, which no pose but the one half way would show.
  ASSERT_TRUE(cut.yes);
  EXPECT_NEAR(cut.bracket.high, 0.5, 1e-9);
  EXPECT_LE(cut.bracket.low, 0.5);
  const SweptContact hit = wire.ask(rod, frame_at(Vec3::Zero()), to, {.width = 1e-9});
  ASSERT_TRUE(hit.yes);
  // The rod's side is 1 mm ahead of its axis.
  EXPECT_NEAR(hit.bracket.high, 0.5 - std::asin(1e-3 / std::sqrt(0.5)) / (M_PI / 2), 1e-8);
}

// A box meets two triangles of a wall at one instant: the place told is that of the triangle told.
TEST(WorldSweptObject, OfTwoTrianglesMetAtOnceTheContactIsThatOfTheOneThatIsTold) {
  const ObjectInfo box = primitive_object(Box{.center = Vec3::Zero(), .half_m = {0.5, 2, 2}});
  for (const double side : {1.0, -1.0}) {
    const std::vector<Vec3> corners{{5, side, -1},  {5, side, 1},  {5, 1.5 * side, 0},
                                    {5, -side, -1}, {5, -side, 1}, {5, -1.5 * side, 0}};
    const IndexedTriangles both{{corners, {{0, 1, 2}, {3, 4, 5}}}};
    const IndexedTriangles first{{corners, {{0, 1, 2}}}};
    const SweptContact touch = both.ask(box, frame_at(Vec3::Zero()), frame_at({16, 0, 0}));
    const SweptContact alone = first.ask(box, frame_at(Vec3::Zero()), frame_at({16, 0, 0}));
    ASSERT_TRUE(touch.yes && alone.yes);
    EXPECT_EQ(touch.b_triangle, 0u);
    EXPECT_EQ(touch.contact.point, alone.contact.point);
    EXPECT_GE(side * touch.contact.point.y(), 1 - 1e-9);
    EXPECT_NEAR((touch.contact.normal - Vec3(1, 0, 0)).norm(), 0, 1e-9);
    const SweptContact bare = both.ask(box, frame_at(Vec3::Zero()), frame_at({16, 0, 0}), {.contacts = false});
    EXPECT_TRUE(bare.yes);
    EXPECT_EQ(bare.bracket.high, touch.bracket.high);
    EXPECT_EQ(bare.contact.point, Contact{}.point) << "nobody asked where";
  }
}

TEST(WorldSweptObject, ASearchWithoutRoomSaysSo) {
  const IndexedTriangles scene{scenes::icosphere(4, 1)};
  const ObjectInfo mesh = mesh_object(scenes::icosphere(2, 0.5));
  const SweptContact touch = scene.ask(mesh, frame_at({2, 0, 0}), frame_at({-2, 0, 0}), {.most_looks = 3});
  EXPECT_TRUE(touch.undecided);
  EXPECT_TRUE(scene.ask(mesh, frame_at({2, 0, 0}), frame_at({-2, 0, 0})).yes);
}

}  // namespace
}  // namespace collided::engine
