// A car with a ray under each wheel: + a gap, 0 touching, - below the ground, as the closed form says.  // A46
#include <gtest/gtest.h>

#include "server/world/query/probes.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using extreme::Stage;

std::vector<ProbeReading> read(Probes& probes, const World& world) {
  std::vector<ProbeReading> readings;
  probes.read(
      *world.newest(), [&](std::string_view name) { return world.find(name); }, readings);
  return readings;
}

void set(Probes& probes, const ProbeDefinition& probe) {
  const std::optional<Refusal> refusal = probes.set(probe);
  ASSERT_FALSE(refusal) << refusal->reason;
}

void add_wheels(Probes& probes, const std::string& object, double reach_m = 10, double back_m = 2) {
  const Vec3 wheel[4] = {{1.2, 0.7, -0.5}, {1.2, -0.7, -0.5}, {-1.2, 0.7, -0.5}, {-1.2, -0.7, -0.5}};
  for (int i = 0; i < 4; ++i) {
    set(probes, {.name = object + "/wheel" + std::to_string(i),
                 .object = object,
                 .origin = wheel[i],
                 .direction = -Vec3::UnitZ(),
                 .reach_m = reach_m,
                 .back_m = back_m});
  }
}

/// z = slope_x x + slope_y y over [-20, 20]^2 in cells that the wheels cross, each of two triangles.
TriangleMesh hillside(double slope_x, double slope_y) {
  TriangleMesh mesh;
  constexpr std::uint32_t kSide = 41;
  for (std::uint32_t i = 0; i < kSide; ++i) {
    for (std::uint32_t j = 0; j < kSide; ++j) {
      const double x = i - 20.0;
      const double y = j - 20.0;
      mesh.vertices.emplace_back(x, y, slope_x * x + slope_y * y);
    }
  }
  for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
    for (std::uint32_t j = 0; j + 1 < kSide; ++j) {
      const std::uint32_t a = i * kSide + j;
      mesh.triangles.push_back({a, a + kSide, a + kSide + 1});
      mesh.triangles.push_back({a, a + kSide + 1, a + 1});
    }
  }
  return mesh;
}

/// Signed distance along the unit direction from p to the plane n . x = h.
double along_to_plane(const Vec3& p, const Vec3& direction, const Vec3& n, double h) {
  return (h - n.dot(p)) / n.dot(direction);
}

struct Terrain {
  const char* name;
  Vec3 normal;
  double height = 0;
};

/// Drives a turning, pitching car up and down through the ground and compares each wheel.
void drive(Stage& stage, const Terrain& terrain) {
  Probes probes;
  const ObjectId car = stage.add("car", extreme::box_shape({1.5, 0.8, 0.3}), extreme::at({0, 0, 2}));
  add_wheels(probes, "car");
  stage.step();
  std::mt19937_64 generator = oracle::seeded(46);
  std::uniform_real_distribution<double> any(-1, 1);
  int below = 0;
  int above = 0;
  for (int i = 0; i < 500; ++i) {
    const Quat turn = Quat(1, 0.1 * any(generator), 0.1 * any(generator), any(generator)).normalized();
    const Vec3 position(12 * any(generator), 12 * any(generator), 0);
    const double ground = (terrain.height - terrain.normal.dot(position)) / terrain.normal.z();
    const Pose pose{.position = position + Vec3(0, 0, ground + 0.5 + any(generator)), .rotation = turn};
    stage.move(car, pose);
    stage.step();
    const std::vector<ProbeReading> readings = read(probes, stage.world);
    ASSERT_EQ(readings.size(), 4u);
    for (std::size_t wheel = 0; wheel < 4; ++wheel) {
      const Vec3 origin = pose.position + turn * probes.definition(wheel).origin;
      const double truth = along_to_plane(origin, turn * Vec3(0, 0, -1), terrain.normal, terrain.height);
      const ProbeReading& reading = readings[wheel];
      ASSERT_NEAR(reading.clearance_m, truth, 1e-9) << terrain.name << " pose " << i << " wheel " << wheel;
      ASSERT_LE(std::abs(reading.clearance_m - truth), reading.error_m + 1e-13) << terrain.name;
      ASSERT_EQ(reading.state, truth > 0 ? ProbeState::gap : ProbeState::collision) << truth;
      (truth > 0 ? above : below) += 1;
    }
  }
  EXPECT_GT(below, 300) << "wheels that have sunk in";
  EXPECT_GT(above, 300);
}

TEST(Probes, FollowTheClosedFormOverAHillsideOfTriangles) {
  Stage stage;
  stage.load("hill", hillside(0.25, -0.125));
  drive(stage, {"static mesh", Vec3(-0.25, 0.125, 1)});
}

// The winding says nothing of where the ground is: the look from behind does.
TEST(Probes, FollowItOverAHillsideThatIsWoundTheOtherWay) {
  Stage stage;
  TriangleMesh hill = hillside(0.1, 0.2);
  for (auto& triangle : hill.triangles) std::swap(triangle[1], triangle[2]);
  stage.add("hill", extreme::mesh_shape(std::move(hill)), extreme::at({0, 0, -0.25}), false);
  drive(stage, {"placed mesh, wound downwards", Vec3(-0.1, -0.2, 1), -0.25});
}

TEST(Probes, FollowItOverAHalfSpace) {
  Stage stage;
  Shape ground;
  ground.primitives = {HalfSpace{.point = {0, 0, 0.5}, .normal = {0.1, -0.3, 1}}};
  stage.add("ground", ground, extreme::at(Vec3::Zero()), false);
  Probes probes;
  const ObjectId car = stage.add("car", extreme::box_shape({1.5, 0.8, 0.3}), extreme::at({0, 0, 2}));
  add_wheels(probes, "car", 10, 4);
  for (const double z : {3.0, 0.7, 0.0, -0.5}) {
    stage.move(car, extreme::at({1, 2, z}));
    stage.step();
    const std::vector<ProbeReading> readings = read(probes, stage.world);
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const Vec3 origin = Vec3(1, 2, z) + probes.definition(i).origin;
      const double truth = along_to_plane(origin, -Vec3::UnitZ(), Vec3(0.1, -0.3, 1), 0.5);
      EXPECT_NEAR(readings[i].clearance_m, truth, 1e-9);
      EXPECT_EQ(readings[i].state, truth > 0 ? ProbeState::gap : ProbeState::collision);
    }
  }
}

// One double above, on, and below the ground: the sign is exact.
TEST(Probes, TheSignIsExactAboutTouching) {
  Stage stage;
  stage.load("flat", hillside(0, 0));
  Probes probes;
  const ObjectId car = stage.ball("car", {0.25, 0.5, 1}, 0.1);
  set(probes, {.name = "wheel", .object = "car", .origin = Vec3::Zero(), .direction = -Vec3::UnitZ(), .back_m = 1});
  const auto state_at = [&](double z) {
    stage.move(car, extreme::at({0.25, 0.5, z}));
    stage.step();
    return read(probes, stage.world).at(0);
  };
  EXPECT_EQ(state_at(0).state, ProbeState::touching);
  EXPECT_EQ(state_at(0).clearance_m, 0);
  EXPECT_EQ(state_at(0).error_m, 0);
  EXPECT_EQ(state_at(0x1p-50).state, ProbeState::gap);
  EXPECT_GT(state_at(0x1p-50).clearance_m, 0);
  EXPECT_EQ(state_at(-0x1p-50).state, ProbeState::collision);
  EXPECT_LT(state_at(-0x1p-50).clearance_m, 0);
  EXPECT_EQ(state_at(30).state, ProbeState::nothing) << "beyond its reach";
}

TEST(Probes, SeeNeitherTheirObjectNorItsGroupNorOtherLayers) {
  Stage stage;
  stage.load("flat", hillside(0, 0));
  Probes probes;
  stage.add("car", extreme::box_shape({1, 1, 1}), extreme::at({0, 0, 5}), true, {.group = 7});
  stage.add("trailer", extreme::ball_shape(0.5), extreme::at({0, 0, 3}), true, {.group = 7});
  stage.add("ghost", extreme::ball_shape(0.5), extreme::at({0, 0, 2}), true, {.layers = 2, .mask = 2});
  set(probes, {.name = "down", .object = "car", .reach_m = extreme::kEndless, .back_m = 0});
  stage.step();
  const ProbeReading reading = read(probes, stage.world).at(0);
  EXPECT_EQ(stage.world.info(reading.met)->name, "flat");
  EXPECT_NEAR(reading.clearance_m, 5, 1e-12);
  stage.ball("ball", {0, 0, 1}, 0.25);
  stage.step();
  EXPECT_NEAR(read(probes, stage.world).at(0).clearance_m, 3.75, 1e-12) << "what comes later is seen";
}

TEST(Probes, BeginsInsideASolid) {
  Stage stage;
  stage.add("rock", extreme::ball_shape(10), extreme::at({0, 0, -10}), false);
  stage.ball("car", {0, 0, -5}, 0.1);
  Probes probes;
  set(probes, {.name = "short", .object = "car", .back_m = 1});
  set(probes, {.name = "long", .object = "car", .back_m = 6});
  stage.step();
  const std::vector<ProbeReading> readings = read(probes, stage.world);
  EXPECT_EQ(readings[0].state, ProbeState::deeper);
  EXPECT_EQ(readings[0].clearance_m, -1);
  EXPECT_EQ(readings[1].state, ProbeState::collision);
  EXPECT_NEAR(readings[1].clearance_m, -5, 1e-12);
}

// Objects come and go; a probe is bound by name.
TEST(Probes, WaitForTheirObject) {
  Stage stage;
  stage.load("flat", hillside(0, 0));
  Probes probes;
  set(probes, {.name = "down", .object = "car"});
  stage.step();
  EXPECT_EQ(read(probes, stage.world).at(0).state, ProbeState::absent);
  const ObjectId car = stage.ball("car", {0, 0, 2}, 0.1);
  stage.step();
  EXPECT_EQ(read(probes, stage.world).at(0).state, ProbeState::gap);
  stage.world.remove(car, EndReason::removed);
  stage.step();
  EXPECT_EQ(read(probes, stage.world).at(0).state, ProbeState::absent);
  EXPECT_EQ(probes.remove("d*"), std::vector<std::string>{"down"});
  EXPECT_TRUE(probes.empty());
  EXPECT_TRUE(read(probes, stage.world).empty());
}

TEST(Probes, RefuseWhatIsNoRay) {
  Probes probes;
  const double nan = std::nan("");
  EXPECT_TRUE(probes.set({.name = "p", .object = "o", .direction = Vec3::Zero()}));
  EXPECT_TRUE(probes.set({.name = "p", .object = "o", .origin = {0, nan, 0}}));
  EXPECT_TRUE(probes.set({.name = "p", .object = "o", .reach_m = -1}));
  EXPECT_TRUE(probes.set({.name = "p", .object = "o", .reach_m = nan}));
  EXPECT_TRUE(probes.set({.name = "p", .object = "o", .back_m = extreme::kEndless}));
  EXPECT_TRUE(probes.empty());
  for (std::uint32_t i = 0; i < kMaxProbes; ++i) {
    ASSERT_FALSE(probes.set({.name = std::to_string(i), .object = "o"}));
  }
  EXPECT_TRUE(probes.set({.name = "one more", .object = "o"}));
  EXPECT_FALSE(probes.set({.name = "7", .object = "another"})) << "one of that name is replaced";
}

}  // namespace
}  // namespace collided::engine
