// A step's events, contacts and costs are the same to the bit however many threads decide them.
#include <gtest/gtest.h>

#include <bit>
#include <memory>
#include <vector>

#include "server/geometry/convex_hull.hpp"
#include "server/world/fences/fences.hpp"
#include "server/world/solids/declared.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

/// FNV-1a over everything that a step has found, and what it cost.
class StepDigest {
 public:
  void add(const World& world) {
    for (const Event& event : world.events()) add(event);
    for (const OpenContact& contact : world.contacts()) add(contact);
    if (const Fences* fences = world.fences()) {
      for (const Event& event : fences->events()) add(event);
    }
    const StepCost& cost = world.cost();
    for (const std::uint32_t count : {cost.candidate_pairs, cost.exact_tests, cost.undecided, cost.swept, cost.filtered,
                                      cost.kept_apart, cost.sweeps_skipped, cost.sweep_looks, cost.contacts})
      add(count);
    add(cost.truncated ? 1 : 0);
  }
  std::uint64_t value() const { return value_; }

 private:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3; }
  void add_number(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(const Contact& contact) {
    for (const Vec3& v : {contact.point, contact.normal}) {
      for (const double x : v) add_number(x);
    }
    for (const double x : {contact.depth_m, contact.depth_error_m}) add_number(x);
  }
  void add(const OpenContact& of) {
    for (const std::uint64_t word : {of.a, of.b, std::uint64_t{of.a_triangle}, std::uint64_t{of.b_triangle}, of.episode,
                                     static_cast<std::uint64_t>(of.began_ns), static_cast<std::uint64_t>(of.doubt),
                                     static_cast<std::uint64_t>(of.contained)})
      add(word);
    add(of.contact);
    add(of.surface);
  }
  void add(const Event& event) {
    add(static_cast<std::uint64_t>(event.kind));
    add(static_cast<std::uint64_t>(event.reason));
    add(event.sequence);
    add(event.of);
    for (const double x : {event.bracket_low_s, event.bracket_high_s, event.velocity_error}) add_number(x);
    for (const double x : event.relative_velocity) add_number(x);
  }
  std::uint64_t value_ = 0xcbf29ce484222325;
};

/// Spheres, boxes, hulls, meshes, declared solids and compounds of two publishers and of none over a rough floor, with
/// fences and a rule: they move, leap, turn, are placed elsewhere, lost, found again, removed and defined anew.
class RandomSteps {
 public:
  RandomSteps(std::uint64_t seed, const WorldOptions& options) : random_(seed), world_(options) {
    load_floor();
    for (int i = 0; i < kObjects; ++i) define(i);
    for (int i = 0; i < 4; ++i) {
      FenceDefinition fence;
      fence.name = "fence" + std::to_string(i);
      fence.shape.primitives.push_back(Box{.center = point(), .half_m = {1, 1, 1}});
      world_.add_fence(fence);
    }
    world_.set_pair_rules({{.a = "object1*", .b = "object2*", .because = "they may"}});
    step();
  }
  std::uint64_t run(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      if (round % 3 == 1) change_one(static_cast<std::size_t>(random_() % kObjects));
      for (std::uint64_t publisher = 0; publisher < 3; ++publisher) move_those_of(publisher, round);
      step();
    }
    return digest_.value();
  }
  std::uint64_t events() const { return world_.last_event_sequence(); }
  std::uint64_t truncated() const { return truncated_; }

 private:
  static constexpr int kObjects = 120;
  static constexpr std::int64_t kRoundNs = 20'000'000;

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  Vec3 point(double size = 1.6) { return {uniform(-size, size), uniform(-size, size), uniform(-0.4, size)}; }
  Pose pose() {
    const Quat turned(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    return {.position = point(), .rotation = turned.normalized()};
  }

  void load_floor() {
    Scene scene;
    scene.name = "floor";
    constexpr std::uint32_t kSide = 8;
    for (std::uint32_t y = 0; y <= kSide; ++y) {
      for (std::uint32_t x = 0; x <= kSide; ++x)
        scene.mesh.vertices.push_back({x / 2.0 - 2, y / 2.0 - 2, uniform(-0.5, -0.3)});
    }
    for (std::uint32_t y = 0; y < kSide; ++y) {
      const auto first = static_cast<std::uint32_t>(scene.mesh.triangles.size());
      for (std::uint32_t x = 0; x < kSide; ++x) {
        const std::uint32_t v = y * (kSide + 1) + x;
        scene.mesh.triangles.push_back({v, v + 1, v + kSide + 1});
        scene.mesh.triangles.push_back({v + 1, v + kSide + 2, v + kSide + 1});
      }
      scene.parts.push_back(
          {.name = "floor/" + std::to_string(y), .first_triangle = first, .triangle_count = 2 * kSide, .filter = {}});
    }
    world_.add_scene(World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}}));
  }

  std::shared_ptr<const TriangleMesh> tetrahedron(double size) {
    auto mesh = std::make_shared<TriangleMesh>();
    mesh->vertices = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
    mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return mesh;
  }

  void define(int i) {
    ObjectDefinition definition;
    definition.name = "object" + std::to_string(i);
    definition.pose = pose();
    definition.publisher = static_cast<std::uint64_t>(i % 3);
    definition.filter.group = i % 11 == 0 ? 1 : 0;
    Shape& shape = definition.shape;
    const int kind = i / 3 % 6;
    if (kind == 0 || kind == 5) shape.primitives.push_back(Sphere{point(0.05), uniform(0.05, 0.2)});
    if (kind == 1 || kind == 5)
      shape.primitives.push_back(Box{.center = point(0.05), .half_m = {0.1, uniform(0.05, 0.2), 0.15}});
    if (kind == 2) {
      const std::vector<Vec3> corners{point(0.2), point(0.2), point(0.2), point(0.2), point(0.2), point(0.2)};
      shape.primitives.push_back(Hull{std::make_shared<const TriangleMesh>(*convex_hull(corners))});
    }
    if (kind == 3 || kind == 4) shape.mesh = tetrahedron(kind == 3 ? 0.3 : 0.7);
    if (kind == 4) {
      // Declared once: how much is made of a solid depends on how long that takes.
      static const DeclaredMesh declared = declare_solid_at_once(tetrahedron(0.7));
      ASSERT_TRUE(declared.solid) << declared.refusal;
      shape.mesh = declared.indexed->mesh;
      definition.indexed = declared.indexed;
      definition.solid = declared.solid;
    }
    const auto defined = world_.define(definition);
    ASSERT_TRUE(std::holds_alternative<ObjectId>(defined)) << std::get<Refusal>(defined).reason;
    ids_[static_cast<std::size_t>(i)] = std::get<ObjectId>(defined);
    poses_[static_cast<std::size_t>(i)] = definition.pose;
  }

  void change_one(std::size_t number) {
    if (random_() % 2 == 0) {
      world_.remove(ids_[number], EndReason::removed);
      return define(static_cast<int>(number));
    }
    is_stale_[number] = !is_stale_[number];
    world_.set_stale(ids_[number], is_stale_[number]);
  }

  /// Publishers tell their instants apart; now and then one tells nothing in a round.
  void move_those_of(std::uint64_t publisher, int round) {
    if (publisher == 2 && round % 4 == 3) return;
    const std::int64_t time_ns = now_ns_ + kRoundNs / 2 + static_cast<std::int64_t>(publisher) * 3'000'000;
    for (std::size_t i = publisher; i < ids_.size(); i += 3) {
      if (random_() % 4 == 0) continue;
      Pose& to = poses_[i];
      const bool leaps = random_() % 8 == 0;
      to.position = leaps ? point() : Vec3(to.position + point(0.05) - Vec3(0, 0, 0.1));
      if (random_() % 2 == 0) to.rotation = pose().rotation;
      world_.move(ids_[i], to, time_ns, random_() % 16 == 0);
    }
    if (publisher > 0) world_.advance(publisher, time_ns);
  }

  void step() {
    now_ns_ += kRoundNs;
    ASSERT_TRUE(world_.step(now_ns_, 1, {.contacts = true, .persisted = random_() % 2 == 0}));
    digest_.add(world_);
    truncated_ += world_.cost().truncated ? 1 : 0;
  }

  std::mt19937_64 random_;
  World world_;
  std::vector<ObjectId> ids_ = std::vector<ObjectId>(kObjects);
  std::vector<Pose> poses_ = std::vector<Pose>(kObjects);
  std::vector<bool> is_stale_ = std::vector<bool>(kObjects);
  std::int64_t now_ns_ = 1'000'000'000'000;
  StepDigest digest_;
  std::uint64_t truncated_ = 0;
};

constexpr int kRounds = 5;

TEST(WorldStepThreads, FindTheSameToTheBitForAnyNumber) {
  const std::uint64_t seed = oracle::seeded(31)();
  RandomSteps alone(seed, {});
  const std::uint64_t expected = alone.run(kRounds);
  EXPECT_GT(alone.events(), 500U) << "there is much to find";
  EXPECT_EQ(alone.truncated(), 0U);
  for (const std::uint32_t threads : {2U, 4U, 8U, 16U}) {
    for (const std::uint32_t from : {0U, 500U}) {
      RandomSteps shared(seed, {.step_threads = threads, .step_alone = from});
      EXPECT_EQ(shared.run(kRounds), expected) << threads << " threads, from " << from << " pairs on";
    }
  }
}

// Which contacts a step leaves out at its limit depends on the order in which it decides.
TEST(WorldStepThreads, ReachTheLimitOfContactsWhereOneThreadDoes) {
  const std::uint64_t seed = oracle::seeded(32)();
  for (const std::uint32_t most : {20U, 60U, 120U}) {
    RandomSteps alone(seed, {.max_contacts = most});
    const std::uint64_t expected = alone.run(kRounds);
    EXPECT_GT(alone.truncated(), 0U) << most;
    RandomSteps shared(seed, {.max_contacts = most, .step_threads = 4, .step_alone = 0});
    EXPECT_EQ(shared.run(kRounds), expected) << most;
  }
}

}  // namespace
}  // namespace collided::engine
