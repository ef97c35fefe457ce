// The verdict alone: what mode `any` says, without hits, whatever the kind of question and whatever else is in the world.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/world/audit/audit.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

struct Hall {
  explicit Hall(const std::mt19937_64& seeded) : random(seeded) {
    Scene scene{.name = "s", .mesh = scenes::scattered(200, 0.3, random())};
    scene.parts = {{"s/a", 0, 100, {}}, {"s/b", 100, 100, {}}};
    static_cast<void>(world.add_scene(
        World::index_scene(std::move(scene), {.threads = 1, .progress = {}, .cancelled = {}, .form = BvhForm::best})));
    for (int i = 0; i < 40; ++i) {
      Shape shape;
      if (i % 2 == 0) shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.25});
      else shape.primitives.emplace_back(Box{.center = Vec3::Zero(), .half_m = {0.1, 0.05, 0.2}});
      static_cast<void>(world.define({.name = "o" + std::to_string(i),
                                      .scene = {},
                                      .shape = shape,
                                      .pose = {.position = place()},
                                      .filter = {},
                                      .moving = true,
                                      .lost_policy = LostPolicy::freeze,
                                      .publisher = 1}));
    }
    world.step(1'000'000'000, 1, {});
  }
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  Vec3 place() {
    const double x = number();
    const double y = number();
    return {x, y, number()};
  }
  std::vector<double> question(QuestionKind kind) {
    std::vector<double> row;
    for (std::uint32_t i = 0; i < numbers_of(kind); ++i) row.push_back(number());
    if (kind == QuestionKind::ray) row[6] = 0.1 + std::abs(row[6]);
    if (kind == QuestionKind::sphere) row[3] = 0.3 * std::abs(row[3]);
    if (kind == QuestionKind::box) {
      for (std::size_t i = 3; i < 6; ++i) row[i] = 0.2 * std::abs(row[i]);
      const Quat turned = Quat(row[6], row[7], row[8], row[9]).normalized();
      row[6] = turned.w();
      row[7] = turned.x();
      row[8] = turned.y();
      row[9] = turned.z();
    }
    return row;
  }
  Answers ask(QuestionKind kind, std::span<const double> numbers, bool with_hits) {
    Answers answers;
    answer(*world.newest(), asked(kind, numbers, with_hits), answers, scratch);
    return answers;
  }
  static Questions asked(QuestionKind kind, std::span<const double> numbers, bool with_hits) {
    return {.kind = kind, .mode = HitMode::any, .with_hits = with_hits, .numbers = numbers};
  }

  std::mt19937_64 random;
  World world{WorldOptions{}};
  QueryScratch scratch;
};

class VerdictAlone : public testing::TestWithParam<QuestionKind> {};

TEST_P(VerdictAlone, IsThatOfModeAny) {
  Hall hall(oracle::seeded(20261128));
  int hits = 0;
  int misses = 0;
  std::vector<double> all;
  std::vector<Verdict> verdicts;
  for (int i = 0; i < 400; ++i) {
    const std::vector<double> numbers = hall.question(GetParam());
    const Answers expected = hall.ask(GetParam(), numbers, true);
    const Answers given = hall.ask(GetParam(), numbers, false);
    ASSERT_EQ(given.answers, expected.answers) << i;
    EXPECT_EQ(given.reasons, expected.reasons);
    EXPECT_EQ(given.oldest_pose_ns, expected.oldest_pose_ns) << "how old it is, is told all the same";
    EXPECT_TRUE(given.hits.empty() && given.hit_counts[0] == 0);
    EXPECT_EQ(audit(*hall.world.newest(), Hall::asked(GetParam(), numbers, false), given), "") << i;
    (given.answers[0] == Verdict::hit ? hits : misses) += 1;
    all.insert(all.end(), numbers.begin(), numbers.end());
    verdicts.push_back(given.answers[0]);
  }
  EXPECT_GT(hits, 20);
  EXPECT_GT(misses, 20);
  const Answers together = hall.ask(GetParam(), all, false);
  EXPECT_EQ(together.answers, verdicts);
  EXPECT_TRUE(together.hits.empty());
}

TEST_P(VerdictAlone, AWrongOneIsFoundByTheAudit) {
  Hall hall(oracle::seeded(20261128));
  for (int i = 0; i < 50; ++i) {
    const std::vector<double> numbers = hall.question(GetParam());
    Answers given = hall.ask(GetParam(), numbers, false);
    if (given.answers[0] != Verdict::hit && given.answers[0] != Verdict::miss) continue;
    given.answers[0] = given.answers[0] == Verdict::hit ? Verdict::miss : Verdict::hit;
    EXPECT_NE(audit(*hall.world.newest(), Hall::asked(GetParam(), numbers, false), given), "") << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, VerdictAlone,
                         testing::Values(QuestionKind::ray, QuestionKind::sphere, QuestionKind::box,
                                         QuestionKind::inside),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

}  // namespace
}  // namespace collided::engine
