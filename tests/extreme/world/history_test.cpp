// An index that is updated in place remembers its past: after inserts, removals and moves in any order it may hold ghosts
// or miss the living. The same world built afresh is the judge.
#include <gtest/gtest.h>

#include <map>

#include "tests/extreme/worlds.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::history_test {
namespace {

struct Body {
  Shape shape;
  Pose pose;
};

std::multiset<std::string> named_hits(const extreme::Stage& stage, const std::vector<double>& ball) {
  std::multiset<std::string> names;
  for (const AnswerHit& hit : stage.ask(QuestionKind::sphere, ball).hits) {
    names.insert(stage.world.info(hit.object)->name + " " + std::to_string(hit.distance_m));
  }
  return names;
}

/// Balls and boxes on a lattice of halves: a good part of the pairs touches exactly.
Body body_on_lattice(std::mt19937_64& random) {
  const auto step = [&] { return 0.5 * static_cast<double>(std::uniform_int_distribution<int>(-8, 8)(random)); };
  const Pose pose = extreme::at({step(), step(), step()});
  return {random() % 2 == 0 ? extreme::ball_shape(0.5) : extreme::box_shape({0.5, 0.25, 0.5}), pose};
}

TEST(ExtremeWorldHistory, AnyOrderOfChangesEqualsAFreshWorld) {
  std::mt19937_64 random = oracle::seeded(401);
  extreme::Stage lived;
  std::map<std::string, std::pair<ObjectId, Body>> alive;
  std::size_t contacts_seen = 0;
  for (int round = 0; round < 40; ++round) {
    std::set<std::string> moved;
    for (int change = 0; change < 30; ++change) {
      const std::string name = "body" + std::to_string(random() % 60);
      const auto found = alive.find(name);
      if (found == alive.end()) {
        const Body body = body_on_lattice(random);
        alive[name] = {lived.add(name, body.shape, body.pose), body};
        moved.insert(name);
      } else if (random() % 3 == 0) {
        lived.world.remove(found->second.first, EndReason::removed);
        alive.erase(found);
      } else if (moved.insert(name).second) {
        found->second.second.pose = body_on_lattice(random).pose;
        lived.move(found->second.first, found->second.second.pose, random() % 2 == 0);
      }
    }
    lived.step();
    extreme::Stage fresh;
    for (const auto& [name, entry] : alive) fresh.add(name, entry.second.shape, entry.second.pose);
    fresh.step();
    ASSERT_EQ(extreme::named_contacts(lived.world), extreme::named_contacts(fresh.world)) << "round " << round;
    contacts_seen += extreme::named_contacts(fresh.world).size();
    for (const double x : {-3.0, 0.0, 3.0}) {
      ASSERT_EQ(named_hits(lived, {x, 0, 0, 2}), named_hits(fresh, {x, 0, 0, 2})) << "round " << round;
    }
  }
  EXPECT_GT(contacts_seen, 200u) << "the scene must be worth testing";
}

// Out and back in reverse order leaves what was there, to the bit.
TEST(ExtremeWorldHistory, UndoneChangesLeaveNoTrace) {
  extreme::Stage stage;
  std::vector<ObjectId> balls;
  for (int i = 0; i < 50; ++i) balls.push_back(stage.ball("ball" + std::to_string(i), {1.0 * i, 0, 0}, 0.5));
  stage.step();
  const std::vector<double> along{-9, 0.125, 0.0625, 1, 0, 0, extreme::kEndless};
  const auto before = extreme::bits_of(stage.ask(QuestionKind::ray, along, HitMode::all));
  const auto pairs = extreme::open_pairs(stage.world);
  EXPECT_EQ(pairs.size(), 49u) << "a chain: each touches the next";
  for (const ObjectId ball : balls) stage.move(ball, extreme::at({0, 0, 1e9}));
  stage.step();
  EXPECT_EQ(extreme::open_pairs(stage.world).size(), 50u * 49 / 2);
  for (int i = 49; i >= 0; --i) stage.move(balls[static_cast<std::size_t>(i)], extreme::at({1.0 * i, 0, 0}), true);
  stage.step();
  EXPECT_EQ(extreme::open_pairs(stage.world), pairs);
  EXPECT_EQ(extreme::bits_of(stage.ask(QuestionKind::ray, along, HitMode::all)), before);
}

}  // namespace
}  // namespace collided::engine::history_test
