#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

// A triangle that clipped splits hold in several leaves is one triangle to whoever asks.
namespace collided::engine {
namespace {

class WorldSplitIndex : public testing::Test {
 protected:
  /// Long slanted triangles among dust; a moving ball of triangles.
  void fill(World& world, BvhForm form) {
    std::mt19937_64 random(5);
    Scene scene{.name = "s", .mesh = scenes::scattered(600, 0.03, random())};
    scenes::append(scene.mesh, scenes::slanted(20, 1, random()));
    scene.parts = {{"s/dust", 0, 600, {}}, {"s/bars", 600, 20, {}}};
    auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}, .form = form});
    EXPECT_EQ(indexed.geometry->tree.report().split_triangles > 0, form == BvhForm::best);
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(indexed)));
    const auto ball = std::make_shared<const TriangleMesh>(scenes::icosphere(2, 0.4));
    ball_ =
        std::get<ObjectId>(world.define({.name = "ball", .scene = {}, .shape = {{}, ball}, .pose = {}, .filter = {}}));
    world.step(1, 1, {});
  }
  void SetUp() override {
    fill(fast_, BvhForm::fast);
    fill(best_, BvhForm::best);
  }
  static Answers ask(const World& world, const Questions& questions) {
    Answers answers;
    QueryScratch scratch;
    answer(*world.newest(), questions, answers, scratch);
    return answers;
  }
  void expect_same(const Questions& questions) const {
    const Answers fast = ask(fast_, questions);
    const Answers best = ask(best_, questions);
    EXPECT_EQ(fast.answers, best.answers);
    EXPECT_EQ(fast.hit_counts, best.hit_counts);
    ASSERT_EQ(fast.hits.size(), best.hits.size());
    EXPECT_GT(fast.hits.size(), 50u);
    for (std::size_t i = 0; i < fast.hits.size(); ++i) {
      EXPECT_EQ(fast.hits[i].object, best.hits[i].object);
      EXPECT_EQ(fast.hits[i].triangle, best.hits[i].triangle);
      EXPECT_EQ(fast.hits[i].distance_m, best.hits[i].distance_m);
      EXPECT_EQ(fast.hits[i].point, best.hits[i].point);
    }
  }

  World fast_{WorldOptions{}};
  World best_{WorldOptions{}};
  ObjectId ball_ = 0;
};

TEST_F(WorldSplitIndex, EveryQuestionHasTheSameAnswer) {
  std::mt19937_64 random = oracle::seeded(8);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto three = [&](std::vector<double>& to, double scale) {
    for (int k = 0; k < 3; ++k) to.push_back(scale * number(random));
  };
  for (const HitMode mode : {HitMode::closest, HitMode::all}) {
    std::vector<double> rays;
    for (int i = 0; i < 2000; ++i) {
      three(rays, 1.5);
      three(rays, 1);
      rays.push_back(INFINITY);
    }
    Questions questions{.kind = QuestionKind::ray, .max_hits = 1000, .numbers = rays};
    questions.mode = mode;
    expect_same(questions);
  }
  std::vector<double> spheres;
  std::vector<double> boxes;
  std::vector<double> points;
  for (int i = 0; i < 300; ++i) {
    three(spheres, 1);
    spheres.push_back(0.3);
    three(boxes, 1);
    boxes.insert(boxes.end(), {0.2, 0.3, 0.1, 1, 0, 0, 0});
    three(points, 1);
    points.push_back(INFINITY);
  }
  expect_same({.kind = QuestionKind::sphere, .max_hits = 1000, .numbers = spheres});
  expect_same({.kind = QuestionKind::box, .max_hits = 1000, .numbers = boxes});
  expect_same({.kind = QuestionKind::near, .max_hits = 2, .numbers = points});
}

TEST_F(WorldSplitIndex, AMovingMeshMeetsTheSameParts) {
  std::mt19937_64 random = oracle::seeded(9);
  std::uniform_real_distribution<double> number(-1, 1);
  std::size_t contacts = 0;
  for (std::int64_t step = 2; step < 40; ++step) {
    Pose pose;
    pose.position = {number(random), number(random), number(random)};
    pose.rotation = Quat(1, number(random), number(random), number(random)).normalized();
    for (World* world : {&fast_, &best_}) {
      ASSERT_TRUE(world->move(ball_, pose, step, false));
      ASSERT_TRUE(world->step(step, 1, {}));
    }
    ASSERT_EQ(fast_.events().size(), best_.events().size());
    for (std::size_t i = 0; i < fast_.events().size(); ++i) {
      EXPECT_EQ(fast_.events()[i].kind, best_.events()[i].kind);
      EXPECT_EQ(fast_.events()[i].of.a, best_.events()[i].of.a);
      EXPECT_EQ(fast_.events()[i].of.b, best_.events()[i].of.b);
    }
    contacts += fast_.contacts().size();
  }
  EXPECT_GT(contacts, 10u);
}

}  // namespace
}  // namespace collided::engine
