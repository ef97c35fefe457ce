#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "server/geometry/aabb.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/intake/scene_file/scene_encoder.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

using test::complaint;

bool same_bits(const Vec3& a, const Vec3& b) { return std::memcmp(a.data(), b.data(), sizeof(Vec3)) == 0; }

void expect_same(const TriangleMesh& a, const TriangleMesh& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t i = 0; i < a.vertices.size(); ++i) { ASSERT_TRUE(same_bits(a.vertices[i], b.vertices[i])) << i; }
  EXPECT_EQ(a.triangles, b.triangles);
}

void expect_same(const Primitive& a, const Primitive& b) {
  ASSERT_EQ(a.index(), b.index());
  if (const auto* sphere = std::get_if<Sphere>(&a)) {
    EXPECT_TRUE(same_bits(sphere->center, std::get<Sphere>(b).center));
    EXPECT_EQ(sphere->radius_m, std::get<Sphere>(b).radius_m);
  } else if (const auto* box = std::get_if<Box>(&a)) {
    EXPECT_TRUE(same_bits(box->center, std::get<Box>(b).center));
    EXPECT_TRUE(same_bits(box->half_m, std::get<Box>(b).half_m));
    EXPECT_EQ(box->axes, std::get<Box>(b).axes);
  } else {
    EXPECT_TRUE(same_bits(std::get<Capsule>(a).a, std::get<Capsule>(b).a));
    EXPECT_TRUE(same_bits(std::get<Capsule>(a).b, std::get<Capsule>(b).b));
    EXPECT_EQ(std::get<Capsule>(a).radius_m, std::get<Capsule>(b).radius_m);
  }
}

void expect_same(const Shape& a, const Shape& b) {
  ASSERT_EQ(a.primitives.size(), b.primitives.size());
  for (std::size_t i = 0; i < a.primitives.size(); ++i) { expect_same(a.primitives[i], b.primitives[i]); }
  ASSERT_EQ(a.mesh == nullptr, b.mesh == nullptr);
  if (a.mesh) { expect_same(*a.mesh, *b.mesh); }
}

void expect_same(const Filter& a, const Filter& b) {
  EXPECT_EQ(a.layers, b.layers);
  EXPECT_EQ(a.mask, b.mask);
  EXPECT_EQ(a.group, b.group);
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.name, b.name);
  expect_same(a.mesh, b.mesh);
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    EXPECT_EQ(a.parts[i].name, b.parts[i].name);
    EXPECT_EQ(a.parts[i].first_triangle, b.parts[i].first_triangle);
    EXPECT_EQ(a.parts[i].triangle_count, b.parts[i].triangle_count);
    expect_same(a.parts[i].filter, b.parts[i].filter);
  }
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].name, b.objects[i].name);
    expect_same(a.objects[i].shape, b.objects[i].shape);
    EXPECT_TRUE(same_bits(a.objects[i].pose.position, b.objects[i].pose.position));
    EXPECT_EQ(a.objects[i].pose.rotation.coeffs(), b.objects[i].pose.rotation.coeffs());
    expect_same(a.objects[i].filter, b.objects[i].filter);
  }
  ASSERT_EQ(a.allowed_pairs == nullptr, b.allowed_pairs == nullptr);
}

/// A scene with one of everything, and numbers that do not survive a decimal detour or single precision.
Scene varied_scene() {
  Scene scene = embedded_scene();
  scene.parts[1].filter = {.layers = 6, .mask = 9, .group = 2};
  scene.mesh.vertices[0] = {-0.0, 5e-324, 0.1 + 0.2};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 20; ++i) {
    const Quat turn = Quat(number(random), number(random), number(random), number(random)).normalized();
    SceneObject object{.name = "thing_" + std::to_string(i)};
    object.pose = {.position = {1e6 + number(random), number(random), 1e-9}, .rotation = turn};
    object.shape.primitives.push_back(Sphere{{number(random), 0, 0}, 0.25});
    object.shape.primitives.push_back(Box{.center = {1, 2, 3}, .axes = turn.toRotationMatrix(), .half_m = {0, 1, 2}});
    object.shape.primitives.push_back(Capsule{{0, 0, number(random)}, {0, 0, 1}, 0});
    object.shape.mesh = std::make_shared<const TriangleMesh>(latitude_longitude_sphere(number(random) + 2, 5, 4));
    object.filter = {.layers = 2, .mask = 3, .group = 4};
    scene.objects.push_back(object);
  }
  return scene;
}

class IntakeSceneFile : public testing::Test {
 protected:
  void SetUp() override {
    path_ = (std::filesystem::temp_directory_path() /
             ("intake_" + std::to_string(::getpid()) + "_" +
              testing::UnitTest::GetInstance()->current_test_info()->name() + ".cscene"))
                .string();
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::string bytes_of(const Scene& scene) const {
    save_scene(path_, scene);
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::string save_complaint(const Scene& scene) const {
    try {
      save_scene(path_, scene);
    } catch (const LoadError& error) { return error.what(); }
    return "saved";
  }

  std::string path_;
};

TEST_F(IntakeSceneFile, ComesBackBitForBit) {
  const Scene scene = varied_scene();
  save_scene(path_, scene);
  LoadReport report;
  expect_same(scene, load_scene(path_, {}, report));
  EXPECT_TRUE(report.mended.empty() && report.refused.empty());
}

TEST_F(IntakeSceneFile, TheOrderOfCollapsesComesBackAndOneThatCannotBeTakenIsRefused) {
  Scene scene = embedded_scene();
  scene.collapses = {{0, 1}, {2, 1}, {1, 5}};
  save_scene(path_, scene);
  LoadReport report;
  const CollapseOrder loaded = load_scene(path_, {}, report).collapses;
  ASSERT_EQ(loaded.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(loaded[i].removed == scene.collapses[i].removed && loaded[i].kept == scene.collapses[i].kept);
  scene.collapses[1] = {1'000'000, 1};
  EXPECT_NE(save_complaint(scene).find("collapse 1: vertex 1000000 of "), std::string::npos) << save_complaint(scene);
  scene.collapses[1] = {0, 1};
  EXPECT_NE(save_complaint(scene).find("collapse 1: vertex 0 is gone already"), std::string::npos)
      << save_complaint(scene);
}

TEST_F(IntakeSceneFile, AllowedPairsComeBackByTheObjectsThatAreThere) {
  Scene scene = embedded_scene();
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) scene.objects[i].number = 100 + i;
  scene.allowed_pairs = std::make_shared<const AllowedPairs>(std::vector<NumberPair>{{105, 102}, {100, 104}, {7, 101}});
  const auto loaded_pairs = [&] {
    save_scene(path_, scene);
    LoadReport report;
    return load_scene(path_, {}, report).allowed_pairs;
  };
  EXPECT_EQ(loaded_pairs()->pairs(), (std::vector<NumberPair>{{0, 4}, {2, 5}})) << "no object has the number 7";
  EXPECT_FALSE(loaded_pairs()->is_every_pair());
  scene.allowed_pairs = std::make_shared<const AllowedPairs>();
  EXPECT_TRUE(loaded_pairs()->is_every_pair());
  scene.allowed_pairs = std::make_shared<const AllowedPairs>(std::vector<NumberPair>{});
  EXPECT_TRUE(loaded_pairs()->pairs().empty());
}

// A program that does not know of allowed pairs would find contacts at every joint.
TEST_F(IntakeSceneFile, AllowedPairsRaiseTheFormat) {
  Scene scene = embedded_scene();
  const auto format = [&] {
    const std::string bytes = bytes_of(scene);
    return format::GetScene(bytes.data())->format();
  };
  EXPECT_EQ(format(), 2u);
  scene.allowed_pairs = std::make_shared<const AllowedPairs>();
  EXPECT_EQ(format(), 3u);
}

TEST_F(IntakeSceneFile, AllowedPairsOfObjectsThatAreNotThereAreRefused) {
  for (const auto& [numbers, flaw] :
       {std::pair(std::vector<std::uint32_t>{0, 1}, "allowed pair 0 has object 1, allowed are those before 1"),
        std::pair(std::vector<std::uint32_t>{0, 0, 0}, "3 numbers of allowed pairs, allowed are twos")}) {
    flatbuffers::FlatBufferBuilder builder;
    const auto center = format::Sphere({0, 0, 0}, 1);
    const std::vector<format::Sphere> spheres{center};
    const auto shape = format::CreateShape(builder, builder.CreateVectorOfStructs(spheres));
    const std::vector objects{format::CreateObject(builder, builder.CreateString("ball"), shape)};
    const auto object_vector = builder.CreateVector(objects);
    const auto pairs = builder.CreateVector(numbers);
    const auto name = builder.CreateString("s");
    format::FinishSceneBuffer(builder,
                              format::CreateScene(builder, 3, name, 0, 0, object_vector, 0, kIsChecksum, pairs));
    std::string bytes(reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize());
    seal_scene(std::as_writable_bytes(std::span(bytes)));
    EXPECT_NE(complaint("s.cscene", bytes).find(flaw), std::string::npos) << complaint("s.cscene", bytes);
  }
}

TEST_F(IntakeSceneFile, AnEmptySceneIsAScene) {
  save_scene(path_, Scene{.name = "void"});
  LoadReport report;
  EXPECT_TRUE(load_scene(path_, {}, report).objects.empty());
}

TEST_F(IntakeSceneFile, VerticesThatNoTriangleHasComeBackToo) {
  Scene scene{.name = "points"};
  scene.mesh.vertices = {{1, 2, 3}, {0.1, 0, 0}, {0, 5e-324, -0.0}};
  save_scene(path_, scene);
  LoadReport report;
  expect_same(scene, load_scene(path_, {}, report));
}

// A vertex goes once: there are never more collapses than vertices.
TEST_F(IntakeSceneFile, MoreCollapsesThanVerticesAreRefused) {
  Scene scene = embedded_scene();
  scene.collapses.assign(scene.mesh.vertices.size() + 1, {0, 1});
  EXPECT_NE(
      save_complaint(scene).find("402 numbers of collapses, allowed are twos, at most one for each of 200 vertices"),
      std::string::npos)
      << save_complaint(scene);
}

TEST_F(IntakeSceneFile, ManyPiecesFitIntoWhatIsReservedForThem) {
  Scene scene = embedded_scene();
  Part& part = scene.parts.back();
  part.cut.piece_of = std::make_shared<const std::vector<std::uint32_t>>(part.triangle_count / 2, 0);
  SceneObject object{.name = "cut"};
  object.shape.mesh = std::make_shared<const TriangleMesh>(latitude_longitude_sphere(1, 64, 64));
  const auto count = static_cast<std::uint32_t>(object.shape.mesh->triangles.size());
  object.cut.piece_of = std::make_shared<const std::vector<std::uint32_t>>(count / 2, 0);
  scene.objects.push_back(object);
  const std::uint64_t reserved = encoded_bytes(scene);
  EXPECT_LE(bytes_of(scene).size(), reserved);
  scene.objects.back().cut = {};
  EXPECT_EQ(reserved - encoded_bytes(scene), 4u * (count / 2));
  const std::uint64_t with_part = encoded_bytes(scene);
  scene.parts.back().cut = {};
  EXPECT_EQ(with_part - encoded_bytes(scene), 4u * (scene.parts.back().triangle_count / 2));
}

// A floor whose top is at 0, walls round 16 x 12 m, four shelves and six pallets.
TEST(IntakeEmbeddedScene, EverythingStandsWhereItIsDrawn) {
  const Scene scene = embedded_scene();
  const auto bounds_of_parts = [&](const std::string& head) {
    Aabb all;
    for (const Part& part : scene.parts) {
      if (!part.name.starts_with("warehouse/" + head)) continue;
      for (std::uint32_t i = 0; i < part.triangle_count; ++i) {
        const Triangle t = scene.mesh.triangle(part.first_triangle + i);
        for (const Vec3& corner : {t.a, t.b, t.c}) all.extend(corner);
      }
    }
    return all;
  };
  const auto expect_bounds = [&](const std::string& head, const Vec3& low, const Vec3& high) {
    const Aabb all = bounds_of_parts(head);
    EXPECT_NEAR((all.low - low).norm() + (all.high - high).norm(), 0, 1e-12) << head;
  };
  expect_bounds("floor", {-8.2, -6.2, -0.2}, {8.2, 6.2, 0});
  expect_bounds("wall_north", {-8.2, 6, 0}, {8.2, 6.2, 4});
  expect_bounds("wall_south", {-8.2, -6.2, 0}, {8.2, -6, 4});
  expect_bounds("wall_east", {8, -6, 0}, {8.2, 6, 4});
  expect_bounds("wall_west", {-8.2, -6, 0}, {-8, 6, 4});
  const Vec3 half(1.2, 0.4, 0);
  const Vec3 places[] = {{-4, -3, 0}, {4, -3, 0}, {0, 0, 0}, {0, 4, 0}};
  for (int i = 0; i < 4; ++i) {
    const std::string shelf = "shelf_" + std::to_string(i + 1);
    expect_bounds(shelf, places[i] - half, places[i] + half + Vec3(0, 0, 1.2));
    expect_bounds(shelf + "/bottom", places[i] - half + Vec3(0, 0, 0.16), places[i] + half + Vec3(0, 0, 0.2));
    expect_bounds(shelf + "/middle", places[i] - half + Vec3(0, 0, 0.66), places[i] + half + Vec3(0, 0, 0.7));
    expect_bounds(shelf + "/top", places[i] - half + Vec3(0, 0, 1.16), places[i] + half + Vec3(0, 0, 1.2));
    expect_bounds(shelf + "/left", places[i] - half, places[i] + Vec3(-1.16, 0.4, 1.16));
    expect_bounds(shelf + "/right", places[i] + Vec3(1.16, -0.4, 0), places[i] + half + Vec3(0, 0, 1.16));
  }
  const double loads_m[] = {0, 0.6, 0.9, 0, 1.2, 0.3};
  ASSERT_EQ(scene.objects.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const SceneObject& pallet = scene.objects[i];
    EXPECT_EQ(pallet.name, "pallet_0" + std::to_string(i + 1));
    EXPECT_EQ(pallet.pose.position, Vec3(i % 2 == 0 ? -5 : 5, 1.5 * static_cast<double>(i / 2), 0));
    ASSERT_EQ(pallet.shape.primitives.size(), loads_m[i] > 0 ? 2u : 1u);
    EXPECT_EQ(std::get<Box>(pallet.shape.primitives[0]).half_m, Vec3(0.6, 0.4, 0.072));
    if (loads_m[i] == 0) continue;
    const Box& load = std::get<Box>(pallet.shape.primitives[1]);
    EXPECT_EQ(load.half_m, Vec3(0.55, 0.35, loads_m[i] / 2));
    EXPECT_NEAR(load.center.z() - load.half_m.z(), 0.144, 1e-15) << "it stands on the deck";
  }
}

TEST_F(IntakeSceneFile, AnotherNameMovesThePartsWithIt) {
  save_scene(path_, embedded_scene());
  LoadReport report;
  const Scene scene = load_scene(path_, {.name = "hall"}, report);
  EXPECT_EQ(scene.name, "hall");
  EXPECT_EQ(scene.parts[0].name, "hall/floor");
  EXPECT_EQ(scene.objects[0].name, "pallet_01");
}

TEST_F(IntakeSceneFile, UnitsAndAxesReachShapesAndPoses) {
  Scene scene{.name = "mm"};
  scene.objects.push_back({.name = "ball", .pose = {.position = {1000, 2000, 3000}}});
  scene.objects[0].shape.primitives.push_back(Sphere{{0, 500, 0}, 250});
  save_scene(path_, scene);
  LoadReport report;
  const Scene loaded = load_scene(path_, {.unit_m = 0.5, .up = 'y'}, report);
  EXPECT_EQ(loaded.objects[0].pose.position, Vec3(500, -1500, 1000));
  const Sphere& ball = std::get<Sphere>(loaded.objects[0].shape.primitives[0]);
  EXPECT_EQ(ball.radius_m, 125);
  EXPECT_EQ(ball.center, Vec3(0, 250, 0));
  EXPECT_TRUE((loaded.objects[0].pose.rotation * ball.center).isApprox(Vec3(0, 0, 250), 1e-15));
}

TEST_F(IntakeSceneFile, WhatLoadingWouldRefuseIsNotWritten) {
  Scene scene = embedded_scene();
  scene.parts[1].name = scene.parts[0].name;
  EXPECT_EQ(save_complaint(scene).substr(save_complaint(scene).find(": ")),
            ": two parts or objects have the name 'warehouse/floor'. Nothing was written.");
  scene = embedded_scene();
  scene.parts.pop_back();
  EXPECT_NE(save_complaint(scene).find("parts cover 288 of 300 triangles"), std::string::npos);
  scene = embedded_scene();
  scene.parts[2].first_triangle += 1;
  EXPECT_NE(save_complaint(scene).find("parts must follow each other"), std::string::npos);
  scene = embedded_scene();
  scene.mesh.vertices[3][1] = std::numeric_limits<double>::infinity();
  EXPECT_NE(save_complaint(scene).find("vertex 3 is ("), std::string::npos);
  scene = embedded_scene();
  scene.mesh.triangles[7][2] = 240 * 8;
  EXPECT_NE(save_complaint(scene).find("triangle 7: corner 2 is vertex 1920 of 200"), std::string::npos);
  scene = embedded_scene();
  scene.objects[0].pose.rotation = Quat(0.87, 0, 0, 0);
  EXPECT_NE(save_complaint(scene).find("object 'pallet_01': rotation has quaternion norm 0.87"), std::string::npos);
  scene = embedded_scene();
  std::get<Box>(scene.objects[1].shape.primitives[1]).half_m[2] = -1;
  EXPECT_NE(save_complaint(scene).find("box 1: half size -1 m"), std::string::npos);
  scene = embedded_scene();
  scene.objects[2].name = "caf\xe9";
  EXPECT_NE(save_complaint(scene).find("is not UTF-8 at byte 3"), std::string::npos);
  scene = embedded_scene();
  scene.objects[2].name = std::string(256, 'x');
  EXPECT_NE(save_complaint(scene).find("has 256 bytes, limit 255"), std::string::npos);
  scene = embedded_scene();
  scene.objects[2].shape = {};
  EXPECT_NE(save_complaint(scene).find("shape of nothing"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(IntakeSceneFile, AQuaternionOfSevenDigitsIsTaken) {
  Scene scene{.name = "s"};
  scene.objects.push_back({.name = "ball", .pose = {.rotation = Quat(0.7071068, 0.7071068, 0, 0)}});
  scene.objects[0].shape.primitives.push_back(Sphere{{0, 0, 0}, 1});
  save_scene(path_, scene);
  LoadReport report;
  EXPECT_NEAR(load_scene(path_, {}, report).objects[0].pose.rotation.norm(), 1, 1e-15);
}

TEST_F(IntakeSceneFile, EveryCutIsRefused) {
  const std::string whole = bytes_of(embedded_scene());
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    EXPECT_NE(complaint("cut.cscene", std::string_view(whole).substr(0, size)), "loaded") << size;
  }
}

TEST_F(IntakeSceneFile, BytesAtAnyAlignmentAreRead) {
  const std::string whole = bytes_of(varied_scene());
  for (std::size_t shift = 0; shift < 8; ++shift) {
    const std::string shifted = std::string(shift, 'x') + whole;
    expect_same(varied_scene(), test::load("a.cscene", std::string_view(shifted).substr(shift)).scene);
  }
}

TEST_F(IntakeSceneFile, LimitsAreKept) {
  save_scene(path_, embedded_scene());
  LoadReport report;
  EXPECT_THROW(load_scene(path_, {.max_triangles = 299}, report), LoadError);
  EXPECT_THROW(load_scene(path_, {.max_file_bytes = 1000}, report), LoadError);
  EXPECT_THROW(load_scene(path_, {.unit_m = 0}, report), LoadError);
  EXPECT_THROW(load_scene(path_, {.up = 'x'}, report), LoadError);
  EXPECT_THROW(load_scene(path_, {.cancelled = [] { return true; }}, report), LoadError);
  EXPECT_THROW(load_scene(path_ + ".none.cscene", {}, report), LoadError);
  EXPECT_THROW(load_scene(std::filesystem::temp_directory_path().string() + "/.", {}, report), LoadError);
}

// The scene's own mesh and those of its objects share one limit.
TEST_F(IntakeSceneFile, TheTrianglesOfAllMeshesCountTogether) {
  Scene scene{.name = "two"};
  scene.mesh = latitude_longitude_sphere(1, 4, 3);
  const auto count = static_cast<std::uint32_t>(scene.mesh.triangles.size());
  scene.parts.push_back({.name = "ball", .triangle_count = count});
  for (const char* name : {"a", "b"}) {
    scene.objects.push_back({.name = name});
    scene.objects.back().shape.mesh = std::make_shared<const TriangleMesh>(scene.mesh);
  }
  const std::string bytes = bytes_of(scene);
  EXPECT_EQ(complaint("two.cscene", bytes, {.max_triangles = 3 * count}), "loaded");
  EXPECT_EQ(complaint("two.cscene", bytes, {.max_triangles = 3 * count - 1}),
            "two.cscene: object 'b': " + std::to_string(count) + " triangles, " + std::to_string(count - 1) +
                " more are allowed. Nothing was loaded.");
  EXPECT_EQ(complaint("two.cscene", bytes, {.max_triangles = 2 * count - 1}),
            "two.cscene: object 'a': " + std::to_string(count) + " triangles, " + std::to_string(count - 1) +
                " more are allowed. Nothing was loaded.");
}

TEST(IntakeShape, PrimitivesOfEveryKindCountTogether) {
  const Shape shape{{Sphere{{0, 0, 0}, 1}, Sphere{{1, 0, 0}, 1}, Box{.center = {0, 0, 0}, .half_m = {1, 1, 1}},
                     Capsule{{0, 0, 0}, {0, 0, 1}, 1}},
                    nullptr};
  const std::vector<std::byte> bytes = encode_shape(shape);
  EXPECT_TRUE(decode_shape(bytes, {.max_primitives = 4}).shape);
  for (const std::uint64_t most : {3, 2, 1}) {
    const DecodedShape decoded = decode_shape(bytes, {.max_primitives = most});
    EXPECT_FALSE(decoded.shape);
    EXPECT_NE(decoded.refusal.find(" more are allowed"), std::string::npos) << decoded.refusal;
  }
}

TEST(IntakeShape, ComesBackBitForBit) {
  for (const SceneObject& object : varied_scene().objects) {
    const DecodedShape decoded = decode_shape(encode_shape(object.shape));
    ASSERT_TRUE(decoded.shape) << decoded.refusal;
    expect_same(object.shape, *decoded.shape);
  }
}

TEST(IntakeShape, RefusalsSayWhat) {
  const auto of = [](std::vector<Primitive> primitives) { return Shape{std::move(primitives), nullptr}; };
  const auto of_mesh = [](const TriangleMesh& mesh) { return Shape{{}, std::make_shared<const TriangleMesh>(mesh)}; };
  const auto refusal = [](const Shape& shape, const ShapeLimits& limits = {}) {
    return decode_shape(encode_shape(shape), limits).refusal;
  };
  EXPECT_EQ(refusal(Shape{}), "shape of nothing");
  EXPECT_EQ(refusal(of({Sphere{{0, 0, 0}, -1}})), "sphere 0: radius -1 m, allowed are finite sizes of 0 and more");
  EXPECT_EQ(refusal(of({Sphere{{0, 0, 0}, 1}, Capsule{{0, 0, 0}, {0, std::nan(""), 0}, 1}})),
            "capsule 0: end b is (0, nan, 0) m, allowed are numbers up to 1e290");
  EXPECT_EQ(refusal(of({Box{.center = {0, 0, 0}, .axes = 2 * Mat3::Identity()}})).substr(0, 12), "box 0: axes ");
  for (int axis = 0; axis < 3; ++axis) {
    for (const double size : {0.0, -1.0}) {
      Vec3 half_m(1, 2, 3);
      half_m[axis] = size;
      EXPECT_EQ(refusal(of({Ellipsoid{.center = Vec3::Zero(), .half_m = half_m}})),
                "ellipsoid 0: half size " + std::string(size == 0 ? "0" : "-1") + " m, allowed are sizes above 0");
    }
  }
  EXPECT_EQ(refusal(of_mesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}}})),
            "triangle 0: corner 2 is vertex 3 of 3");
  const Shape ball = of_mesh(latitude_longitude_sphere(1, 16, 9));
  EXPECT_EQ(refusal(ball, {.max_triangles = 255}), "256 triangles, 255 more are allowed");
  EXPECT_NE(refusal(ball, {.max_bytes = 100}).find("limit 100"), std::string::npos);
  EXPECT_EQ(decode_shape({}).refusal, "not a shape, or a damaged one: its tables do not check out");
}

}  // namespace
}  // namespace collided::engine
