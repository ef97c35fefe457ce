#include <gtest/gtest.h>

#include <set>

#include "server/world/groups/clearance.hpp"
#include "server/world/objects/pair_rules.hpp"
#include "server/world/query/why_not_meeting.hpp"
#include "server/world/world.hpp"

// Pairs that are allowed to touch.
namespace collided::engine {
namespace {

PairRule rule(const char* a, const char* b, bool is_allowed = true) {
  return {.a = a, .b = b, .because = "", .allows = is_allowed};
}

bool allows(const std::vector<PairRule>& rules, const char* a, const char* b) {
  const PairRules made(rules);
  const bool there = made.allows(made.fit_of(a), made.fit_of(b));
  EXPECT_EQ(there, made.allows(made.fit_of(b), made.fit_of(a))) << "symmetric";
  return there;
}

TEST(PairRules, TheLastRuleThatFitsDecides) {
  EXPECT_FALSE(allows({}, "a", "b"));
  EXPECT_TRUE(allows({rule("a", "b")}, "a", "b"));
  EXPECT_FALSE(allows({rule("a", "b")}, "a", "a"));
  EXPECT_FALSE(allows({rule("a", "b")}, "b", "b"));
  const std::vector<PairRule> three{rule("arm/*", "*"), rule("human_*", "*", false), rule("human_7", "arm/hand")};
  EXPECT_TRUE(allows(three, "arm/base", "floor"));
  EXPECT_FALSE(allows(three, "arm/base", "human_1"));
  EXPECT_FALSE(allows(three, "arm/base", "human_7"));
  EXPECT_TRUE(allows(three, "arm/hand", "human_7"));
  EXPECT_FALSE(allows(three, "floor", "wall"));
}

class RulesInTheWorld : public testing::Test {
 protected:
  ObjectId ball(const char* name, double x, Filter filter = {}) {
    ObjectDefinition object;
    object.name = name;
    object.shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 1});
    object.pose.position = {x, 0, 0};
    object.filter = filter;
    return std::get<ObjectId>(world_.define(object));
  }
  struct Told {
    EventKind kind;
    EndReason reason;
    bool operator==(const Told&) const = default;
  };
  std::vector<Told> step() {
    world_.step(++time_ns_, 1, {});
    std::vector<Told> told;
    for (const Event& event : world_.events()) told.push_back({event.kind, event.reason});
    return told;
  }

  World world_{WorldOptions{}};
  std::int64_t time_ns_ = 0;
};

TEST_F(RulesInTheWorld, AContactEndsWhenItIsAllowedAndBeginsWhenItIsNoLonger) {
  ball("a", 0);
  ball("b", 1);
  const ObjectId c = ball("c", 10);
  const std::vector<Told> began{{EventKind::began, EndReason::none}};
  EXPECT_EQ(step(), began);
  world_.set_pair_rules({rule("a", "[bc]")});
  EXPECT_EQ(step(), (std::vector<Told>{{EventKind::ended, EndReason::allowed}}));
  EXPECT_TRUE(world_.contacts().empty());
  EXPECT_TRUE(step().empty());
  // Also for what comes to touch later: c meets a and b, and only b counts.
  world_.move(c, {.position = {1, 0.5, 0}}, time_ns_ + 1, false);
  EXPECT_EQ(step(), began);
  ASSERT_EQ(world_.contacts().size(), 1u);
  world_.set_pair_rules({});
  EXPECT_EQ(step(), (std::vector<Told>{began[0], began[0]}));
  EXPECT_EQ(world_.contacts().size(), 3u);
}

// A slot that is used again has another object, whose name counts.
TEST_F(RulesInTheWorld, ANameIsThatOfTheObjectNotOfItsPlace) {
  ball("a", 0);
  world_.set_pair_rules({rule("a", "b")});
  const ObjectId b = ball("b", 1);
  EXPECT_TRUE(step().empty());
  world_.remove(b, EndReason::removed);
  step();
  ASSERT_EQ(slot_of(ball("c", 1)), slot_of(b));
  EXPECT_EQ(step(), (std::vector<Told>{{EventKind::began, EndReason::none}}));
}

// Two robots from one file: each has pairs of links that may touch, and either touches the other.
TEST_F(RulesInTheWorld, AllowedPairsAreThoseOfOneLoadingOfAScene) {
  const auto load = [&](const std::string& name) {
    Scene robot{.name = name, .is_moving = true};
    for (const char* link : {"fore", "hand", "tool"}) {
      robot.objects.push_back({.name = name + "/" + link, .number = static_cast<std::uint32_t>(robot.objects.size())});
      robot.objects.back().shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 1});
    }
    robot.allowed_pairs = std::make_shared<const AllowedPairs>(std::vector<NumberPair>{{0, 1}, {1, 2}});
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world_.add_scene(World::index_scene(std::move(robot), {}))));
  };
  const auto touching = [&] {
    step();
    std::set<std::pair<std::string, std::string>> names;
    for (const OpenContact& contact : world_.contacts())
      names.insert(std::minmax(world_.info(contact.a)->name, world_.info(contact.b)->name));
    return names;
  };
  using Names = std::set<std::pair<std::string, std::string>>;
  load("left");
  EXPECT_EQ(touching(), (Names{{"left/fore", "left/tool"}}));
  load("right");
  Names all{{"left/fore", "left/tool"}, {"right/fore", "right/tool"}};
  for (const char* left : {"left/fore", "left/hand", "left/tool"}) {
    for (const char* right : {"right/fore", "right/hand", "right/tool"}) all.emplace(left, right);
  }
  EXPECT_EQ(touching(), all);
  // An object that is defined again, as by a publisher that claims it, keeps its pairs.
  const ObjectId hand = *world_.find("left/hand");
  const ObjectDefinition again = definition_of(*world_.info(hand), {});
  world_.remove(hand, EndReason::geometry_changed);
  ASSERT_TRUE(std::holds_alternative<ObjectId>(world_.define(again)));
  EXPECT_EQ(touching(), all);
  PartMeshes part_meshes;
  ClearanceAsk ask{.from = {*world_.find("left/hand")}, .to = {*world_.find("left/fore"), *world_.find("right/fore")}};
  const GroupClearance clearance = clearance_of(*world_.newest(), ask, part_meshes);
  EXPECT_EQ(clearance.filtered, 1u);
  ASSERT_EQ(clearance.pairs.size(), 1u);
  EXPECT_EQ(clearance.pairs[0].b, *world_.find("right/fore"));
  EXPECT_EQ(why_not_meeting(*world_.newest(), *world_.find("left/hand"), *world_.find("left/fore")),
            std::vector<std::string>{"scene 'left' allows them to touch, by its SRDF file"});
  EXPECT_TRUE(why_not_meeting(*world_.newest(), *world_.find("left/hand"), *world_.find("right/fore")).empty());
}

TEST_F(RulesInTheWorld, GroupQuestionsLeaveAllowedPairsOutToo) {
  const ObjectId a = ball("a", 0);
  const ObjectId b = ball("b", 1);
  world_.set_pair_rules({rule("?", "b")});
  step();
  PartMeshes part_meshes;
  ClearanceAsk ask{.from = {a}, .to = {b}};
  const GroupClearance without = clearance_of(*world_.newest(), ask, part_meshes);
  EXPECT_TRUE(without.pairs.empty());
  EXPECT_EQ(without.filtered, 1u);
  ask.with_filtered = true;
  EXPECT_EQ(clearance_of(*world_.newest(), ask, part_meshes).touches, Decision::yes);
}

}  // namespace
}  // namespace collided::engine
