#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/intake/scene.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

std::shared_ptr<const TriangleMesh> rock(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> size(0.8, 1.2);
  TriangleMesh mesh = scenes::icosphere(1, 1, Vec3::Zero());
  for (Vec3& vertex : mesh.vertices) vertex *= size(random);
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

bool meet(const TriangleMesh& a, const Frame& frame_a, const TriangleMesh& b, const Frame& frame_b) {
  for (std::uint32_t i = 0; i < a.triangles.size(); ++i) {
    const Triangle own = place(frame_a, a.triangle(i));
    for (std::uint32_t k = 0; k < b.triangles.size(); ++k) {
      if (overlaps(own, place(frame_b, b.triangle(k))).yes()) return true;
    }
  }
  return false;
}

/// Rocks that drift and turn slowly by each other over a rough ground.
class Drift {
 public:
  explicit Drift(std::mt19937_64& random) : random_(random) {
    Scene scene;
    scene.name = "ground";
    scene.mesh = ground_ = scenes::terrain(8, 12, 5);
    scene.parts = {{.name = "ground",
                    .first_triangle = 0,
                    .triangle_count = static_cast<std::uint32_t>(ground_.triangles.size()),
                    .filter = {}}};
    EXPECT_TRUE(std::holds_alternative<std::uint32_t>(world_.add_scene(World::index_scene(scene, {}))));
    for (std::uint64_t i = 0; i < 4; ++i) add(i);
    world_.step(next_ns(), 1, {});
  }
  void step() {
    for (Rock& one : rocks_) {
      one.pose.position += one.displacement;
      one.pose.rotation = (Quat(Eigen::AngleAxisd(0.01, one.axis)) * one.pose.rotation).normalized();
      EXPECT_TRUE(world_.move(one.id, one.pose, now_ns_, false));
    }
    world_.step(next_ns(), 1, {});
    kept_apart += world_.cost().kept_apart;
    tests += world_.cost().exact_tests;
  }
  /// Elsewhere at once: what was known of it is worth nothing.
  void teleport(std::size_t which, const Vec3& position) {
    rocks_[which].pose.position = position;
    EXPECT_TRUE(world_.move(rocks_[which].id, rocks_[which].pose, now_ns_, true));
  }
  void check(int step) {
    for (std::size_t i = 0; i < rocks_.size(); ++i) {
      for (std::size_t k = i + 1; k < rocks_.size(); ++k) {
        const bool truth = meet(*rocks_[i].mesh, frame(i), *rocks_[k].mesh, frame(k));
        ASSERT_EQ(holds(rocks_[i].id, rocks_[k].id), truth) << "rocks " << i << ' ' << k << ", step " << step;
        contacts += truth ? 1 : 0;
      }
      const ObjectId ground = world_.newest()->scenes[0]->part_objects[0];
      const bool truth = meet(*rocks_[i].mesh, frame(i), ground_, Frame{});
      ASSERT_EQ(holds(ground, rocks_[i].id), truth) << "rock " << i << ", ground, step " << step;
      contacts += truth ? 1 : 0;
    }
  }
  std::uint64_t kept_apart = 0;
  std::uint64_t tests = 0;
  std::uint64_t contacts = 0;

 private:
  struct Rock {
    ObjectId id;
    std::shared_ptr<const TriangleMesh> mesh;
    Pose pose;
    Vec3 displacement;
    Vec3 axis;
  };
  void add(std::uint64_t i) {
    std::uniform_real_distribution<double> part(-1, 1);
    const auto any = [&] {
      const double x = part(random_), y = part(random_);
      return Vec3(x, y, part(random_));
    };
    Rock one{.id = 0, .mesh = rock(i), .pose = {}, .displacement = 0.02 * any(), .axis = any().normalized()};
    one.pose.position = Vec3(i % 2 == 0 ? -1.4 : 1.4, i < 2 ? -1.4 : 1.4, 2.5) + 0.2 * any();
    ObjectDefinition definition;
    definition.name = "rock" + std::to_string(i);
    definition.shape.mesh = one.mesh;
    definition.pose = one.pose;
    const auto id = world_.define(definition);
    one.id = std::get<ObjectId>(id);
    rocks_.push_back(one);
  }
  Frame frame(std::size_t i) const { return frame_of(rocks_[i].pose); }
  bool holds(ObjectId a, ObjectId b) const {
    for (const OpenContact& contact : world_.contacts()) {
      if ((contact.a == a && contact.b == b) || (contact.a == b && contact.b == a)) return true;
    }
    return false;
  }
  std::int64_t next_ns() { return now_ns_ += 20'000'000; }

  std::mt19937_64& random_;
  World world_{WorldOptions{}};
  TriangleMesh ground_;
  std::vector<Rock> rocks_;
  std::int64_t now_ns_ = 0;
};

TEST(WorldKeptApart, NoContactIsMissedForWhatIsRemembered) {
  std::mt19937_64 random = oracle::seeded(91);
  Drift drift(random);
  for (int step = 0; step < 120; ++step) {
    if (step == 60) drift.teleport(0, {1.0, -1.2, 2.6});
    drift.step();
    drift.check(step);
  }
  std::printf("%llu pairs kept apart, %llu tests, %llu contacts\n", static_cast<unsigned long long>(drift.kept_apart),
              static_cast<unsigned long long>(drift.tests), static_cast<unsigned long long>(drift.contacts));
  EXPECT_GT(drift.kept_apart, 50U);
  EXPECT_GT(drift.contacts, 20U) << "the scene must be worth testing";
}

// Boxes of the two overlap, the rocks do not: remembered as apart, until one of them is put into the other.
TEST(WorldKeptApart, NothingIsRememberedOfWhatWasPutElsewhere) {
  World world{WorldOptions{}};
  const auto ball = std::make_shared<const TriangleMesh>(scenes::icosphere(2, 1, Vec3::Zero()));
  std::vector<ObjectId> ids;
  for (const double x : {0.0, 1.6}) {
    ObjectDefinition definition;
    definition.name = "ball" + std::to_string(ids.size());
    definition.shape.mesh = ball;
    definition.pose.position = Vec3(x, x, 0);
    ids.push_back(std::get<ObjectId>(world.define(definition)));
  }
  std::int64_t now_ns = 1;
  EXPECT_TRUE(world.step(now_ns, 1, {}));
  std::uint64_t kept_apart = 0;
  for (int step = 1; step <= 5; ++step) {
    EXPECT_TRUE(world.move(ids[1], {.position = Vec3(1.6 - 1e-3 * step, 1.6, 0)}, now_ns, false));
    EXPECT_TRUE(world.step(now_ns += 20'000'000, 1, {}));
    kept_apart += world.cost().kept_apart;
  }
  EXPECT_EQ(kept_apart, 4U);
  EXPECT_TRUE(world.move(ids[1], {.position = Vec3(0.5, 0.5, 0)}, now_ns, true));
  EXPECT_TRUE(world.step(now_ns += 20'000'000, 1, {}));
  EXPECT_EQ(world.contacts().size(), 1U);
}

}  // namespace
}  // namespace collided::engine
