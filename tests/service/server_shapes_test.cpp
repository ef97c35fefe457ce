#include <algorithm>
#include <cstdio>
#include <map>

#include <nlohmann/json.hpp>
#include <thread>

#include "client/library/commands/geometry_decoding.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerShapes : public testing_support::ServerTest {
 protected:
  static ShownObjects shapes(Client& client, const ShapesOptions& options = {}, const ShownObjects* earlier = nullptr) {
    Result<ShownObjects> shown = client.shapes(options, earlier);
    EXPECT_TRUE(shown) << shown.error().message;
    return shown ? std::move(*shown) : ShownObjects{};
  }
  static const ShownObject& named(const ShownObjects& shown, const std::string& name) {
    const auto found =
        std::find_if(shown.objects.begin(), shown.objects.end(), [&](const auto& o) { return o.name == name; });
    EXPECT_NE(found, shown.objects.end()) << name;
    return found == shown.objects.end() ? shown.objects.at(0) : *found;
  }
  static std::size_t count_of(const Surface& surface, std::uint8_t kinds) {
    return static_cast<std::size_t>(std::count_if(surface.edges.begin(), surface.edges.end(),
                                                  [&](const SurfaceEdge& e) { return (e.kinds & kinds) != 0; }));
  }
  void load(Client& client, const std::string& path) {
    const Result<std::string> loaded = client.command("load", "{\"path\": \"" + path + "\"}", {}, 60s);
    ASSERT_TRUE(loaded) << loaded.error().message;
  }
};

// A number with all its digits, far from the origin: nothing on the way rounds it.
constexpr double kOdd = 4649000.1234567891;

TEST_F(ServerShapes, EveryKindComesBackAsItWasGiven) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "maker");
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  const Shape many{SphereShape{0.25, {1, 2, kOdd}},         BoxShape{{1, 2, 3}, {0.1, 0.2, 0.3}, turn},
                   CapsuleShape{{0, 0, 0}, {0, 0, 1}, 0.5}, CylinderShape{{1, 0, 0}, {0, 1, 0}, 0.125},
                   ConeShape{{0, 0, 2}, {0, 0, 1}, 0.3},    EllipsoidShape{{1, 2, 3}, {4, 5, 6}, turn}};
  const Pose pose{{kOdd, -3, 1e-3}, turn};
  ASSERT_TRUE(publisher.add({.name = "compound",
                             .shape = many,
                             .pose = pose,
                             .layers = 6,
                             .mask = 5,
                             .group = 4,
                             .lost_policy = LostPolicy::hold}));
  ASSERT_TRUE(publisher.add({.name = "hull",
                             .shape = {HullShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.1, 0.1, 0.1}}}},
                             .scale = {2, 2, 2},
                             .moving = false,
                             .lost_policy = LostPolicy::hold}));
  ASSERT_TRUE(publisher.add(
      {.name = "field", .shape = {HeightFieldShape{2, 1, 1, {0, 0, 0, 0.5}}}, .lost_policy = LostPolicy::hold}));
  ASSERT_TRUE(publisher.add({.name = "cloud",
                             .shape = {CloudShape{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, 0.1}},
                             .lost_policy = LostPolicy::hold}));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));

  const ShownObjects shown = shapes(client, {.edges = true});
  const ShownObject& compound = named(shown, "compound");
  EXPECT_TRUE(compound.moving);
  EXPECT_EQ(compound.layers, 6U);
  EXPECT_EQ(compound.mask, 5U);
  EXPECT_EQ(compound.group, 4U);
  EXPECT_EQ(compound.pose.position, pose.position);
  EXPECT_TRUE(compound.pose.rotation.isApprox(turn, 1e-15));
  ASSERT_EQ(compound.parts.size(), many.size());
  EXPECT_EQ(std::get<SphereShape>(compound.parts[0]).center, std::get<SphereShape>(many[0]).center);
  EXPECT_EQ(std::get<SphereShape>(compound.parts[0]).radius_m, 0.25);
  EXPECT_EQ(std::get<BoxShape>(compound.parts[1]).half_m, Vec3(1, 2, 3));
  EXPECT_TRUE(
      std::get<BoxShape>(compound.parts[1]).rotation.toRotationMatrix().isApprox(turn.toRotationMatrix(), 1e-15));
  EXPECT_EQ(std::get<CapsuleShape>(compound.parts[2]).b, Vec3(0, 0, 1));
  EXPECT_EQ(std::get<CylinderShape>(compound.parts[3]).radius_m, 0.125);
  EXPECT_EQ(std::get<ConeShape>(compound.parts[4]).apex, Vec3(0, 0, 2));
  EXPECT_EQ(std::get<EllipsoidShape>(compound.parts[5]).half_m, Vec3(1, 2, 3));
  const ShownObject& hull = named(shown, "hull");
  ASSERT_EQ(hull.runs.size(), 1U);
  EXPECT_FALSE(hull.moving);
  EXPECT_TRUE(hull.runs[0].is_hull);
  EXPECT_EQ(hull.runs[0].triangle_count, 4U);  // the fifth point is inside
  EXPECT_EQ(hull.runs[0].surface->edges.size(), 6U);
  double largest = 0;
  for (const Vec3& v : hull.runs[0].surface->vertices) largest = std::max(largest, v.maxCoeff());
  EXPECT_EQ(largest, 2) << "scaled";
  EXPECT_EQ(named(shown, "field").runs.at(0).triangle_count, 2U);
  EXPECT_EQ(named(shown, "cloud").parts.size(), 3U);
}

// A62: a cube has 12 creases, each of two triangles; the diagonals of its sides are none.
TEST_F(ServerShapes, ScenePartsShareOneSurfaceAndItsEdgesKnowCreaseBoundaryAndMaterial) {
  const std::string path =
      folder_.write("cube.obj",
                    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                    "usemtl wood\nf 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nusemtl steel\nf 5 6 7 8\n");
  start({path});
  Client client = connect();
  const ShownObjects shown = shapes(client, {.edges = true});
  ASSERT_EQ(shown.objects.size(), 2U);
  EXPECT_EQ(shown.objects[0].runs.at(0).surface, shown.objects[1].runs.at(0).surface);
  EXPECT_EQ(shown.objects[0].runs[0].triangle_count + shown.objects[1].runs[0].triangle_count, 12U);
  const Surface& cube = *shown.objects[0].runs[0].surface;
  EXPECT_EQ(cube.edges.size(), 18U);
  EXPECT_EQ(count_of(cube, kCreaseEdge), 12U);
  EXPECT_EQ(count_of(cube, kBoundaryEdge), 0U);
  EXPECT_EQ(count_of(cube, kMaterialEdge), 4U);
  for (const SurfaceEdge& edge : cube.edges) {
    const bool on_lid = cube.vertices[edge.ends[0]].z() == 1 && cube.vertices[edge.ends[1]].z() == 1;
    const bool along = (cube.vertices[edge.ends[0]] - cube.vertices[edge.ends[1]]).norm() == 1;
    EXPECT_EQ((edge.kinds & kMaterialEdge) != 0, on_lid && along);
    EXPECT_EQ((edge.kinds & kCreaseEdge) != 0, along);
  }
  EXPECT_TRUE(shapes(client).objects[0].runs[0].surface->edges.empty()) << "nobody asked for them";
  EXPECT_EQ(shapes(client, {.only = "*steel*"}).objects.size(), 1U);
  EXPECT_EQ(shapes(client, {.skip = "*"}).objects.size(), 0U);
}

// A61
TEST_F(ServerShapes, AnOpenBoxHasFourBoundaryEdges) {
  const std::string path = folder_.write("open.obj",
                                         "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                                         "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  start({path});
  Client client = connect();
  const ShownObjects shown = shapes(client, {.edges = true});
  EXPECT_EQ(count_of(*shown.objects.at(0).runs.at(0).surface, kBoundaryEdge), 4U);
}

TEST_F(ServerShapes, ASharedMeshComesOnceAndIsNotFetchedAgain) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "twins");
  const MeshShape tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, kOdd}},
                              {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}}};
  for (const char* name : {"one", "two"})
    ASSERT_TRUE(publisher.add({.name = name, .shape = {tetrahedron}, .lost_policy = LostPolicy::hold}));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  const ShownObjects first = shapes(client, {.moving = true});
  ASSERT_EQ(first.objects.size(), 2U);
  EXPECT_EQ(first.objects[0].runs.at(0).surface, first.objects[1].runs.at(0).surface);
  EXPECT_EQ(first.objects[0].runs[0].surface->vertices, tetrahedron.vertices);
  EXPECT_EQ(first.objects[0].runs[0].surface->triangles, tetrahedron.triangles);
  ASSERT_TRUE(publisher.add({.name = "three", .shape = {SphereShape{0.1}}, .lost_policy = LostPolicy::hold}));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  const ShownObjects second = shapes(client, {.moving = true, .edges = false}, &first);
  EXPECT_NE(second.table_version, first.table_version);
  EXPECT_EQ(named(second, "two").runs.at(0).surface, first.objects[0].runs[0].surface);
}

TEST_F(ServerShapes, PosesAreThoseThatWerePublishedAndTellOfChanges) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "movers");
  std::map<std::string, Pose> expected;
  std::vector<Publisher::Object> objects;
  for (int i = 0; i < 2'000; ++i)
    objects.push_back(add_ball(publisher, "ball_" + std::to_string(i), at(i, 0, 50), LostPolicy::hold));
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Pose pose = at(static_cast<double>(i), kOdd, 60);
    expected["ball_" + std::to_string(i)] = pose;
    ASSERT_TRUE(publisher.move(objects[i], pose));
  }
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(10s));
  const ShownObjects shown = shapes(client, {.moving = true});
  const Result<Poses> poses = client.poses();
  ASSERT_TRUE(poses) << poses.error().message;
  EXPECT_EQ(poses->table_version, shown.table_version);
  ASSERT_EQ(poses->ids.size(), 2'000U);
  std::map<std::uint64_t, std::string> names;
  for (const ShownObject& object : shown.objects) names[object.id] = object.name;
  for (std::size_t i = 0; i < poses->ids.size(); ++i) {
    EXPECT_EQ(poses->poses[i].position, expected.at(names.at(poses->ids[i])).position);
    EXPECT_EQ(poses->stale[i], 0);
  }
  // 30 frames a second are a frame in 33 ms; printed, since it depends on the machine.
  const auto start_time = std::chrono::steady_clock::now();
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(client.poses());
  std::printf("2000 poses: %.2f ms a call\n",
              std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_time).count() / 30);
  ASSERT_TRUE(publisher.remove(objects[0]));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  EXPECT_NE(client.poses()->table_version, shown.table_version);
}

// 200,000 triangles are several pages; questions go on being answered meanwhile.
TEST_F(ServerShapes, AMeshOfManyPagesComesWhole) {
  constexpr int kSide = 317;
  std::string text;
  char line[96];
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      std::snprintf(line, sizeof line, "v %d %d %.17g\n", i, j, 0.1 * ((i * 7 + j * 13) % 11));
      text += line;
    }
  }
  for (int i = 0; i + 1 < kSide; ++i) {
    for (int j = 0; j + 1 < kSide; ++j) {
      const int a = i * kSide + j + 1;
      std::snprintf(line, sizeof line, "f %d %d %d\nf %d %d %d\n", a, a + kSide, a + kSide + 1, a, a + kSide + 1,
                    a + 1);
      text += line;
    }
  }
  start({folder_.write("ground.obj", text)});
  Client client = connect();
  const auto start_time = std::chrono::steady_clock::now();
  const ShownObjects shown = shapes(client, {.edges = true});
  std::printf("%d triangles: %.0f ms\n", 2 * (kSide - 1) * (kSide - 1),
              std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_time).count());
  const Surface& ground = *shown.objects.at(0).runs.at(0).surface;
  ASSERT_EQ(ground.vertices.size(), std::size_t{kSide} * kSide);
  ASSERT_EQ(ground.triangles.size(), std::size_t{2} * (kSide - 1) * (kSide - 1));
  EXPECT_EQ(count_of(ground, kBoundaryEdge), std::size_t{4} * (kSide - 1));
  for (std::size_t i = 0; i < ground.vertices.size(); ++i) {
    const int x = static_cast<int>(i) / kSide;
    const int y = static_cast<int>(i) % kSide;
    ASSERT_EQ(ground.vertices[i], Vec3(x, y, 0.1 * ((x * 7 + y * 13) % 11)));
  }
}

/// Bytes that a viewer would get, 0 where what it asks for is gone.
std::uint64_t reported_bytes(Client& client, const char* command, const nlohmann::json& arguments) {
  const Result<std::string> text = client.command(command, arguments.dump());
  EXPECT_TRUE(text) << text.error().message;
  std::string flaw;
  const auto page = client::decode_page(text ? *text : std::string(), flaw);
  EXPECT_TRUE(page) << flaw;
  return page ? page->total : 0;
}

TEST_F(ServerShapes, ASurfaceGoesWithItsObjectAndIsNotTakenForAnotherServers) {
  start({"--memory", "off"});  // else it goes with what is remembered of its object
  Client client = connect();
  Publisher publisher = publish(client, "maker");
  const MeshShape triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}};
  const auto object = publisher.add({.name = "leaf", .shape = {triangle}, .lost_policy = LostPolicy::hold});
  ASSERT_TRUE(object);
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  const ShownObjects shown = shapes(client, {.only = "leaf"});
  const std::uint64_t number = shown.objects.at(0).runs.at(0).surface->number;
  const nlohmann::json wanted{{"surface", number}, {"epoch", shown.epoch}};
  EXPECT_GT(reported_bytes(client, "surface", wanted), 100U);
  EXPECT_EQ(reported_bytes(client, "surface", {{"surface", number}, {"epoch", shown.epoch + 1}}), 0U);
  EXPECT_EQ(reported_bytes(client, "surface", {{"surface", number + 1}, {"epoch", shown.epoch}}), 0U);
  ASSERT_TRUE(publisher.remove(*object));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  // States that still hold it are given up as newer ones come.
  const auto deadline = std::chrono::steady_clock::now() + 10s;
  Publisher::Object other = add_ball(publisher, "ball", at(0, 0, 9), LostPolicy::hold);
  while (reported_bytes(client, "surface", wanted) > 0 && std::chrono::steady_clock::now() < deadline) {
    move(publisher, other, at(0, 0, 10));
    ASSERT_TRUE(publisher.wait_applied(20s));
  }
  EXPECT_EQ(reported_bytes(client, "surface", wanted), 0U);
}

// Objects with meshes come and go while a viewer asks: it gets whole answers, each of one state.
TEST_F(ServerShapes, WhoeverAsksWhileObjectsComeAndGoGetsWholeAnswers) {
  start();
  Client client = connect();
  std::atomic<bool> stop{false};
  std::thread changing([&] {
    Client own = connect();
    Publisher publisher = publish(own, "restless");
    for (int i = 0; !stop; ++i) {
      const double size = 1 + i % 7;
      const MeshShape triangle{{{0, 0, 0}, {size, 0, 0}, {0, size, 0}}, {{{0, 1, 2}}}};
      const auto object = publisher.add({.name = "leaf", .shape = {triangle}, .pose = at(size, 0, 30)});
      if (!object || !publisher.flush()) break;
      // Some for as long as a viewer takes to fetch them, some for less.
      std::this_thread::sleep_for(std::chrono::microseconds(400 * (i % 16)));
      if (!publisher.remove(*object)) break;
    }
  });
  std::size_t seen = 0;
  // On a full machine the first objects may come after two hundred answers.
  const auto give_up = std::chrono::steady_clock::now() + 20s;
  for (int i = 0; i < 200 || (seen == 0 && std::chrono::steady_clock::now() < give_up); ++i) {
    for (const ShownObject& object : shapes(client, {.only = "leaf"}).objects) {
      ASSERT_EQ(object.runs.size(), 1U);
      EXPECT_EQ(object.runs[0].surface->vertices.at(1).x(), object.pose.position.x()) << "its own mesh";
      ++seen;
    }
  }
  stop = true;
  changing.join();
  EXPECT_GT(seen, 0U);
}

TEST_F(ServerShapes, WhatIsNotThereOrNotMeantIsSaid) {
  start();
  Client client = connect();
  EXPECT_EQ(client.command("shapes", R"({"nmae": "x"})").error().message,
            "server refused: shapes: unknown argument 'nmae'");
  EXPECT_EQ(client.command("surface", R"({"surface": 1, "crease_cosine": 2})").error().message.substr(0, 15),
            "server refused:");
  const Result<std::string> gone = client.command("more", R"({"transfer": 77, "first": 0})");
  ASSERT_TRUE(gone) << "an empty page";
  EXPECT_TRUE(shapes(client, {.only = "no such thing"}).objects.empty());
  EXPECT_TRUE(shapes(client, {.only = "\xff\xfe"}).objects.empty()) << "no text at all";
}

}  // namespace
}  // namespace collided
