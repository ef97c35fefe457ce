// Objects that leap: what a crowd finds in a step is what its objects find a few at a time, whose ways are not cut.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

struct Leaper {
  Primitive shape;
  Pose from;
  Pose to;
  bool leaps = true;
};

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}
Vec3 within(std::mt19937_64& random, const Vec3& half) {
  return {uniform(random, -half.x(), half.x()), uniform(random, -half.y(), half.y()),
          uniform(random, -half.z(), half.z())};
}
Pose pose_within(std::mt19937_64& random, const Vec3& half) {
  const Quat turned(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
  return {.position = within(random, half), .rotation = turned.normalized()};
}

/// A kind of leap each: balls, balls off their origin, boxes that go straight, bars that turn.
Leaper leaper(std::mt19937_64& random, std::size_t number, const Vec3& room, const Vec3& leap) {
  Leaper made{.shape = Sphere{Vec3::Zero(), 0.3}, .from = pose_within(random, room), .to = {}};
  made.to = made.from;
  made.to.position += within(random, leap);
  if (number % 4 == 1) made.shape = Sphere{{0.2, 0.1, 0}, uniform(random, 0.1, 0.4)};
  if (number % 4 == 2) made.shape = Box{.center = {0, 0.1, 0}, .half_m = {0.3, 0.2, 0.4}};
  if (number % 4 == 3) made.shape = Box{.center = {0.3, 0, 0}, .half_m = {0.7, 0.1, 0.1}};
  if (number % 4 == 1 || number % 4 == 3) made.to.rotation = pose_within(random, room).rotation;
  return made;
}

/// What one step finds, a line for each event; names stand for objects.
class Step {
 public:
  Step(const std::vector<Leaper>& all, const std::vector<std::size_t>& chosen) {
    std::vector<ObjectId> ids;
    for (const std::size_t i : chosen) {
      ObjectDefinition definition;
      definition.name = std::to_string(i);
      definition.pose = all[i].from;
      definition.shape.primitives = {all[i].shape};
      ids.push_back(std::get<ObjectId>(world_.define(definition)));
      names_[ids.back()] = definition.name;
    }
    go(1'000'000'000);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (all[chosen[i]].leaps) world_.move(ids[i], all[chosen[i]].to, 2'000'000'000, false);
    }
    go(2'000'000'000);
  }
  const std::vector<std::string>& lines() const { return lines_; }
  std::uint32_t candidates() const { return world_.cost().candidate_pairs; }

 private:
  void go(std::int64_t time_ns) {
    ASSERT_TRUE(world_.step(time_ns, 1, {.contacts = true, .persisted = false}));
    for (const Event& event : world_.events()) {
      char numbers[100];
      std::snprintf(numbers, sizeof numbers, " %d %d %a %a %a", static_cast<int>(event.kind),
                    static_cast<int>(event.reason), event.bracket_low_s, event.bracket_high_s,
                    event.of.contact.depth_m);
      lines_.push_back(names_.at(event.of.a) + " " + names_.at(event.of.b) + numbers);
    }
  }

  World world_{WorldOptions{}};
  std::map<ObjectId, std::string> names_;
  std::vector<std::string> lines_;
};

std::vector<std::size_t> numbers(std::size_t first, std::size_t end) {
  std::vector<std::size_t> all;
  for (; first < end; ++first) all.push_back(first);
  return all;
}

/// The lines of all pairs, found by steps of two groups each.
std::vector<std::string> in_groups(const std::vector<Leaper>& all, std::size_t group) {
  std::vector<std::string> lines;
  for (std::size_t a = 0; a < all.size(); a += group) {
    for (std::size_t b = a + group; b < all.size(); b += group) {
      std::vector<std::size_t> chosen = numbers(a, std::min(a + group, all.size()));
      const std::vector<std::size_t> second = numbers(b, std::min(b + group, all.size()));
      chosen.insert(chosen.end(), second.begin(), second.end());
      const Step step(all, chosen);
      lines.insert(lines.end(), step.lines().begin(), step.lines().end());
    }
  }
  std::ranges::sort(lines);
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  return lines;
}

std::vector<std::string> sorted(std::vector<std::string> lines) {
  std::ranges::sort(lines);
  return lines;
}

struct Leaps {
  Vec3 room;  // half of it
  Vec3 leap;  // at most, along each axis
};
constexpr double kFewRoom_m = 12;

TEST(LongWays, OfACrowdAreDecidedAsThoseOfAFewAtATime) {
  std::mt19937_64 random = oracle::seeded(20261151);
  const std::array<Leaps, 4> kinds{
      Leaps{Vec3::Constant(kFewRoom_m), Vec3::Constant(3)}, Leaps{Vec3::Constant(kFewRoom_m), Vec3::Constant(30)},
      Leaps{Vec3::Constant(kFewRoom_m), Vec3::Constant(300)}, Leaps{Vec3(40, 40, 1), Vec3(50, 50, 0.2)}};
  for (const Leaps& of : kinds) {
    std::vector<Leaper> all;
    for (std::size_t i = 0; i < 300; ++i) all.push_back(leaper(random, i, of.room, of.leap));
    const Step step(all, numbers(0, all.size()));
    EXPECT_GT(step.lines().size(), 20U) << of.leap.transpose();
    EXPECT_EQ(sorted(step.lines()), in_groups(all, 100)) << of.leap.transpose();
  }
}

TEST(LongWays, AmongThingsAtRestAreDecidedAsThoseOfAFewAtATime) {
  std::mt19937_64 random = oracle::seeded(20261152);
  std::vector<Leaper> all;
  for (std::size_t i = 0; i < 600; ++i) {
    all.push_back(leaper(random, i, Vec3::Constant(kFewRoom_m), Vec3::Constant(30)));
    all.back().leaps = i % 30 < 1;
  }
  const Step step(all, numbers(0, all.size()));
  EXPECT_GT(step.lines().size(), 20U);
  // So few that one mover is enough for all pairs to be compared at once.
  EXPECT_EQ(sorted(step.lines()), in_groups(all, 7));
}

TEST(LongWays, OfACrowdAreComparedWhereTheyAreNearAtATime) {
  std::mt19937_64 random = oracle::seeded(20261153);
  std::vector<Leaper> all;
  for (std::size_t i = 0; i < 2'000; ++i) all.push_back(leaper(random, 4 * i, Vec3::Constant(20), Vec3::Constant(100)));
  const Step step(all, numbers(0, all.size()));
  // Boxes around whole ways overlap in a third of the two million pairs.
  EXPECT_LT(step.candidates(), 60'000U);
}

}  // namespace
}  // namespace collided::engine
