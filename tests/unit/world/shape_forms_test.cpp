#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <unistd.h>

#include "idl/scene_generated.h"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/intake/mesh/shape_scale.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/world/objects/part_index.hpp"
#include "server/world/query/plan.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

// Forms of shapes that become others when they are loaded: clouds, lines, height fields, scaled and shared ones.  // A10
namespace collided::engine {
namespace {

namespace fb = flatbuffers;

/// A buffer with one shape; `fill` makes the vectors and tables and returns the finished table.
template <class Fill>
DecodedShape decoded(const Fill& fill, const ShapeLimits& limits = {}) {
  fb::FlatBufferBuilder builder;
  builder.Finish(fill(builder));
  return decode_shape(std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize())), limits);
}

DecodedShape cloud_of(const std::vector<double>& numbers, double radius_m, bool line = false) {
  return decoded([&](fb::FlatBufferBuilder& b) {
    const auto points = b.CreateVector(std::vector{format::CreatePointsDirect(b, &numbers, radius_m)});
    format::ShapeBuilder shape(b);
    line ? shape.add_polylines(points) : shape.add_clouds(points);
    return shape.Finish();
  });
}

DecodedShape field_of(std::uint32_t columns, double dx, double dy, const std::vector<double>& heights) {
  return decoded([&](fb::FlatBufferBuilder& b) {
    const auto field = format::CreateHeightFieldDirect(b, columns, dx, dy, &heights);
    format::ShapeBuilder shape(b);
    shape.add_height_field(field);
    return shape.Finish();
  });
}

ObjectId added(World& world, const std::string& name, const Shape& shape, bool moving = false) {
  const auto defined =
      world.define({.name = name, .scene = {}, .shape = shape, .pose = {}, .filter = {}, .moving = moving});
  EXPECT_TRUE(std::holds_alternative<ObjectId>(defined));
  return std::get<ObjectId>(defined);
}

Answers asked(const World& world, QuestionKind kind, const std::vector<double>& numbers) {
  Answers answers;
  QueryScratch scratch;
  Questions questions;
  questions.kind = kind;
  questions.numbers = numbers;
  answer(*world.newest(), questions, answers, scratch);
  return answers;
}

DecodedShape buffers_of(const std::vector<format::BufferKind>& kinds, std::uint32_t stride) {
  std::vector<std::uint8_t> vertices(4 * stride, 0);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const float position[3] = {static_cast<float>(i / 2), static_cast<float>(i % 2), 1};
    std::memcpy(vertices.data() + i * stride, position, std::min<std::size_t>(stride, sizeof position));
  }
  const std::vector<std::uint8_t> indices{0, 0, 2, 0, 1, 0, 3, 0};
  return decoded([&](fb::FlatBufferBuilder& b) {
    std::vector<fb::Offset<format::VertexBuffer>> tables;
    for (const format::BufferKind kind : kinds)
      tables.push_back(format::CreateVertexBufferDirect(b, kind, false, stride, 0, &vertices, 2, &indices, 0.25));
    const auto buffers = b.CreateVector(tables);
    format::ShapeBuilder shape(b);
    shape.add_buffers(buffers);
    return shape.Finish();
  });
}

TEST(VertexBuffers, AreShapesOnTheWire) {
  const DecodedShape strip =
      buffers_of({format::BufferKind::strip, format::BufferKind::points, format::BufferKind::polyline}, 16);
  ASSERT_TRUE(strip.shape) << strip.refusal;
  EXPECT_EQ(strip.shape->mesh->triangles.size(), 2u);
  EXPECT_EQ(strip.shape->primitives.size(), 4u + 3u);
  World world({});
  added(world, "sheet", *buffers_of({format::BufferKind::strip}, 12).shape);
  world.step(0, 1, {});
  const Answers answers = asked(world, QuestionKind::ray, {0.5, 0.25, 3, 0, 0, -1, 9});
  ASSERT_EQ(answers.hits.size(), 1u);
  EXPECT_EQ(answers.hits[0].distance_m, 2);
  EXPECT_NE(buffers_of({format::BufferKind::strip}, 11).refusal.find("buffer 0: stride 11"), std::string::npos);
  EXPECT_EQ(buffers_of({format::BufferKind::strip, format::BufferKind::fan}, 12).refusal,
            "buffer 1: a second surface; a shape holds one");
}

/// A hundred thousand balls of 4 mm in a metre; what a ray meets is counted, since a clock says nothing on a busy machine.
TEST(PointCloud, AHundredThousandPointsAnswerThroughTheirIndex) {
  std::mt19937_64 random = oracle::seeded(71);
  std::uniform_real_distribution<double> place(0, 1);
  std::vector<double> numbers(300'000);
  for (double& number : numbers) number = place(random);
  const DecodedShape cloud = cloud_of(numbers, 0.002);
  ASSERT_TRUE(cloud.shape) << cloud.refusal;
  ASSERT_EQ(cloud.shape->primitives.size(), 100'000u);
  World world({});
  added(world, "scan", *cloud.shape);
  world.step(0, 1, {});
  std::vector<double> rays;
  for (int i = 0; i < 200; ++i) {
    for (const double x : {place(random), place(random), -1.0, place(random) - 0.5, place(random) - 0.5, 1.0, 10.0})
      rays.push_back(x);
  }
  const Answers answers = asked(world, QuestionKind::ray, rays);
  std::size_t hits = 0;
  for (std::size_t i = 0, at = 0; i < 200; ++i) {
    const Vec3 from(rays[7 * i], rays[7 * i + 1], -1);
    const Vec3 along(rays[7 * i + 3], rays[7 * i + 4], 1);
    double nearest = INFINITY;
    for (const Primitive& point : cloud.shape->primitives) {
      RayHit hit;
      if (cast_ray({from, along, 10}, std::get<Sphere>(point), hit).yes()) nearest = std::min(nearest, hit.distance_m);
    }
    ASSERT_EQ(answers.hit_counts[i] == 1, std::isfinite(nearest)) << i;
    EXPECT_LT(answers.exact_tests[i], 2'000u) << "a fiftieth of them";
    if (answers.hit_counts[i] == 1) {
      EXPECT_EQ(answers.hits[at++].distance_m, nearest);
      ++hits;
    }
  }
  EXPECT_GT(hits, 50u);
}

TEST(PointCloud, PointsAndLinesAreRefusedByName) {
  EXPECT_EQ(cloud_of({0, 0, 0, 1}, 0.1).refusal, "cloud 0: 4 coordinates, must be a multiple of 3 above 0");
  EXPECT_EQ(cloud_of({0, 0, 0, 1, NAN, 1}, 0.1).refusal, "cloud 0: point 1 is (1, nan, 1)");
  EXPECT_EQ(cloud_of({0, 0, 0}, -1).refusal, "cloud 0: radius -1 m, allowed are finite sizes of 0 and more");
  EXPECT_EQ(cloud_of({0, 0, 0}, 1, true).refusal, "polyline 0: one point, at least 2 are needed");
  const DecodedShape line = cloud_of({0, 0, 0, 1, 0, 0, 1, 1, 0}, 0.5, true);
  ASSERT_TRUE(line.shape);
  ASSERT_EQ(line.shape->primitives.size(), 2u);
  EXPECT_EQ(std::get<Capsule>(line.shape->primitives[1]).b, Vec3(1, 1, 0));
}

TEST(HeightField, BecomesTheSurfaceOverItsGrid) {
  const DecodedShape field = field_of(3, 2, 5, {0, 1, 2, 3, 4, 5});
  ASSERT_TRUE(field.shape) << field.refusal;
  EXPECT_EQ(field.shape->mesh->vertices[4], Vec3(2, 5, 4));
  ASSERT_EQ(field.shape->mesh->triangles.size(), 4u);
  World world({});
  added(world, "hill", *field.shape);
  world.step(0, 1, {});
  // The plane z = x / 2 + 3 y / 5 goes through all of them.
  const Answers down = asked(world, QuestionKind::ray, {3, 2.5, 100, 0, 0, -1, INFINITY});
  ASSERT_EQ(down.hits.size(), 1u);
  EXPECT_NEAR(down.hits[0].distance_m, 100 - (1.5 + 1.5), down.hits[0].error_m + 1e-13);
  EXPECT_EQ(field_of(3, 2, 5, {0, 1, 2, 3}).refusal,
            "height field of 4 heights in 3 columns, needed are whole rows, 2 of 2 at least");
  EXPECT_EQ(field_of(2, 0, 5, {0, 1, 2, 3}).refusal, "height field: spacing 0 m, allowed are finite lengths above 0");
  EXPECT_EQ(field_of(2, 1, 1, {0, 1, NAN, 3}).refusal, "height field: height 2 is nan");
}

TEST(HalfSpaceShape, StandsAloneAndDoesNotMove) {
  World world({});
  const Shape ground{{HalfSpace{{0, 0, 0}, {0, 0, 1}}}, nullptr};
  const auto refused =
      world.define({.name = "ground", .scene = {}, .shape = ground, .pose = {}, .filter = {}, .moving = true});
  ASSERT_TRUE(std::holds_alternative<Refusal>(refused));
  EXPECT_NE(std::get<Refusal>(refused).reason.find("half-space that moves"), std::string::npos);
  added(world, "ground", ground);
  const ObjectId ball = added(world, "ball", Shape{{Sphere{{0, 0, 2}, 1}}, nullptr}, true);
  world.step(0, 1, {});
  EXPECT_TRUE(world.contacts().empty());
  world.move(ball, Pose{.position = {1e7, 0, -1}, .rotation = Quat::Identity()}, 1, false);
  world.step(1, 1, {});
  ASSERT_EQ(world.contacts().size(), 1u) << "touching, ten thousand kilometres out";
  Shape company = ground;
  company.primitives.push_back(Sphere{{0, 0, 0}, 1});
  EXPECT_NE(decode_shape(encode_shape(company)).refusal.find("makes an object of its own"), std::string::npos);
  const Shape nowhere{{HalfSpace{{0, 0, 0}, {0, 0, 0}}}, nullptr};
  EXPECT_EQ(decode_shape(encode_shape(nowhere)).refusal,
            "half-space 0: normal of length 0, allowed 1e-30 to 9.999999999999999e+29");
  const DecodedShape again = decode_shape(encode_shape(ground));
  ASSERT_TRUE(again.shape);
  EXPECT_EQ(std::get<HalfSpace>(again.shape->primitives[0]).normal, Vec3(0, 0, 1));
}

Shape one_of(const Primitive& primitive) { return {{primitive}, nullptr}; }

TEST(ScaledShape, KeepsItsKindOrIsRefusedByName) {
  const auto refusal = [](Shape shape, const Vec3& factor) { return scale(shape, factor); };
  Shape box = one_of(Box{.center = {1, 1, 1}, .half_m = {1, 2, 3}});
  EXPECT_EQ(scale(box, {2, 3, 4}), "");
  EXPECT_EQ(std::get<Box>(box.primitives[0]).half_m, Vec3(2, 6, 12));
  EXPECT_EQ(std::get<Box>(box.primitives[0]).center, Vec3(2, 3, 4));
  Mat3 quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Shape turned = one_of(Box{.center = {0, 0, 0}, .axes = quarter, .half_m = {1, 2, 3}});
  EXPECT_EQ(scale(turned, {10, 1, 1}), "");
  EXPECT_EQ(std::get<Box>(turned.primitives[0]).half_m, Vec3(1, 20, 3)) << "its second side lies along x";
  Shape ball = one_of(Sphere{{1, 0, 0}, 2});
  EXPECT_EQ(scale(ball, {3, 3, 3}), "");
  EXPECT_EQ(std::get<Sphere>(ball.primitives[0]).radius_m, 6);
  EXPECT_EQ(refusal(ball, {1, 2, 1}),
            "scale (1, 2, 1): a sphere would become an ellipsoid; one factor for all axes is allowed");
  EXPECT_EQ(refusal(one_of(Capsule{{0, 0, 0}, {1, 0, 0}, 1}), {1, 2, 1}),
            "scale (1, 2, 1): a capsule would become no capsule; one factor for all axes is allowed");
  EXPECT_EQ(refusal(ball, {1, -1, 1}),
            "scale (1, -1, 1): factors must be finite and above 0; mirror images are not offered");
  EXPECT_EQ(refusal(one_of(Sphere{{1e300, 0, 0}, 1}), Vec3::Constant(1e10)),
            "scale (10000000000, 10000000000, 10000000000): a coordinate would exceed 1e290 m");
  Mat3 skew = Eigen::AngleAxisd(0.3, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_EQ(refusal(one_of(Box{.center = {0, 0, 0}, .axes = skew, .half_m = {1, 1, 1}}), {1, 2, 1}),
            "scale (1, 2, 1): a turned box would become no box; one factor for all axes is allowed");
}

Shape tetrahedron() {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return {{}, mesh};
}

TEST(SharedMesh, EqualMeshesHaveOneMemoryAndIndex) {
  World world({});
  const ObjectInfo& first = *world.info(added(world, "first", tetrahedron()));
  const ObjectInfo& second = *world.info(added(world, "second", tetrahedron(), true));
  EXPECT_EQ(first.mesh, second.mesh) << "equal numbers, two senders";
  Shape larger = tetrahedron();
  ASSERT_EQ(scale(larger, {2, 1, 1}), "");
  const ObjectInfo& third = *world.info(added(world, "third", larger));
  EXPECT_NE(first.mesh, third.mesh);
  EXPECT_EQ(third.mesh->mesh->vertices[1], Vec3(2, 0, 0));
  world.step(0, 1, {});
  bool told = false;
  for (const PlanRow& row : plan_of(*world.newest(), false)) {
    if (row.structure == "shared meshes") told = row.built && row.reason == "3 objects with 2 different meshes";
  }
  EXPECT_TRUE(told);
}

TEST(SharedMesh, AFileHoldsItOnce) {
  Scene scene;
  scene.name = "many";
  const Shape shape = tetrahedron();
  for (int i = 0; i < 50; ++i) {
    SceneObject object;
    object.name = "copy" + std::to_string(i);
    object.shape = shape;
    scene.objects.push_back(std::move(object));
  }
  const std::string path = testing::TempDir() + "shared_mesh_" + std::to_string(::getpid()) + ".cscene";
  save_scene(path, scene);
  LoadReport report;
  const Scene loaded = load_scene(path, {}, report);
  ASSERT_EQ(loaded.objects.size(), 50u);
  for (const SceneObject& object : loaded.objects) EXPECT_EQ(object.shape.mesh, loaded.objects[0].shape.mesh);
  Scene to_index = loaded;
  const auto indexed = World::index_scene(to_index, {.threads = 1, .progress = {}, .cancelled = {}});
  EXPECT_EQ(indexed.geometry->object_meshes[0], indexed.geometry->object_meshes[49]);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace collided::engine
