// Generated crossings of fences, standing and carried, beside the oracle in rationals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "server/world/fences/fences.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/meeting_oracle.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/world/common_time_arrivals.hpp"

namespace collided::engine {
namespace {

/// As many as are asked for by that variable of the environment, for the long form of a test; else the given number.
int fences_asked(int fallback) {
  const char* text = std::getenv("COLLIDED_FENCES");
  return text != nullptr ? std::atoi(text) : fallback;
}

using Form = std::variant<double, Vec3>;

/// A mover and a fence. carrier: whose instants the fence has; without, it stands in the world.
struct FenceCrossing {
  MovingBody mover;
  MovingBody fence;
  bool is_carried = false;
};

double in(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Vec3 vector_in(std::mt19937_64& random, double size) {
  return {in(random, -size, size), in(random, -size, size), in(random, -size, size)};
}

Form random_form(std::mt19937_64& random, bool box, double size) {
  if (!box) return size * in(random, 0.2, 1);
  return Vec3(size * in(random, 0.2, 1), size * in(random, 0.2, 1), size * in(random, 0.2, 1));
}

/// Past the origin, with a bend there.
std::vector<Instant> random_flight(std::mt19937_64& random, double size, double speed) {
  const double period_ns = 1e9 / std::exp(in(random, std::log(5.0), std::log(240.0)));
  const Vec3 summand = vector_in(random, 1.2 * size);
  const Vec3 velocity = vector_in(random, speed);
  const Vec3 bend = vector_in(random, 0.3 * speed);
  std::vector<Instant> instants{{kStart + 1'000, summand + velocity * -0.25 + bend * 0.25}};
  double time_ns = 2'000 + in(random, 0, period_ns);
  while (time_ns < 0.5e9 || instants.size() < 2) {
    const double s = 1e-9 * time_ns - 0.25;
    instants.push_back({kStart + static_cast<std::int64_t>(time_ns), summand + velocity * s + bend * std::abs(s)});
    time_ns += period_ns * in(random, 0.7, 1.3);
  }
  return instants;
}

FenceCrossing random_fence_crossing(std::mt19937_64& random, bool boxes, bool is_carried) {
  const double speed = std::exp(in(random, -3, 5));
  const double size = std::exp(in(random, -3, 0));
  FenceCrossing crossing{.mover = {.form = random_form(random, boxes, size), .instants = {}},
                         .fence = {.form = random_form(random, boxes, size), .instants = {}},
                         .is_carried = is_carried};
  crossing.mover.instants = random_flight(random, size, speed);
  if (is_carried) {
    crossing.fence.instants = random_flight(random, size, speed);
  } else {
    crossing.fence.instants = {{kStart, Vec3::Zero()}, {crossing.mover.instants.back().time_ns, Vec3::Zero()}};
  }
  return crossing;
}

/// A world with one mover of publisher 1, one fence, and its carrier, if there is one, of publisher 2.
class OneFence {
 public:
  explicit OneFence(const FenceCrossing& crossing) : crossing_(crossing) {
    ids_[0] = define("mover", crossing.mover, 1);
    if (crossing.is_carried) ids_[1] = define("carrier", crossing.fence, 2);
    FenceDefinition definition{.name = "fence", .shape = shape_of(crossing.fence)};
    if (crossing.is_carried) definition.carrier = "carrier";
    EXPECT_TRUE(std::holds_alternative<ObjectId>(world_.add_fence(definition)));
    step();
  }

  /// Publishers' batches in a random order; steps come with that chance after each, and where an object would move twice.
  std::vector<Told> tell(std::mt19937_64& random, double step_chance) {
    std::vector<std::size_t> order(crossing_.mover.instants.size(), 0);
    if (crossing_.is_carried) order.insert(order.end(), crossing_.fence.instants.size(), 1);
    std::shuffle(order.begin(), order.end(), random);
    std::size_t next[2] = {0, 0};
    for (const std::size_t who : order) {
      const MovingBody& body = who == 0 ? crossing_.mover : crossing_.fence;
      if (world_.has_moved(ids_[who])) step();
      const Instant& instant = body.instants[next[who]++];
      const ObjectId ids[] = {ids_[who]};
      const Pose poses[] = {{.position = instant.position}};
      bool moved[1];
      world_.move(ids, poses, instant.time_ns, false, moved);
      world_.advance(who + 1, instant.time_ns);
      if (std::bernoulli_distribution(step_chance)(random)) step();
    }
    step();
    return told_;
  }

 private:
  ObjectId define(const std::string& name, const MovingBody& body, std::uint64_t publisher) {
    ObjectDefinition definition;
    definition.name = name;
    // A carrier may be anything: it is not in its own fence.
    definition.shape = shape_of(body);
    definition.publisher = publisher;
    definition.pose.position = body.instants.front().position;
    definition.filter.group = 1;
    return std::get<ObjectId>(world_.define(definition));
  }

  void step() {
    EXPECT_TRUE(world_.step(++now_ns_, 1, {}));
    EXPECT_TRUE(world_.events().empty());
    const auto time = [&](double seconds_ago) { return now_ns_ - std::llround(seconds_ago * 1e9); };
    for (const Event& event : world_.fences()->events()) {
      EXPECT_EQ(event.of.a, ids_[0]);
      EXPECT_EQ(event.of.doubt, Doubt::none);
      EXPECT_EQ(event.sequence, ++last_sequence_);
      told_.push_back({.kind = event.kind,
                       .reason = event.reason,
                       .low_ns = time(event.bracket_low_s),
                       .high_ns = time(event.bracket_high_s)});
    }
  }

  FenceCrossing crossing_;
  World world_{WorldOptions{}};
  ObjectId ids_[2] = {0, 0};
  std::int64_t now_ns_ = kStart;
  std::uint64_t last_sequence_ = 0;
  std::vector<Told> told_;
};

std::vector<oracle::ToldMeeting> stays_of(const std::vector<Told>& told) {
  std::vector<oracle::ToldMeeting> stays;
  for (const Told& event : told) {
    if (event.kind == EventKind::began) stays.push_back({.began = {event.low_ns, event.high_ns}, .ended = {}});
    else stays.back().ended = {event.low_ns, event.high_ns};
  }
  return stays;
}

// No passage is missed, none is invented, and brackets contain what the poses say, whoever moves.
TEST(FenceCrossings, AreToldAsTheOracleFindsThem) {
  const int count = fences_asked(2'000) / 4;
  for (const bool is_carried : {false, true}) {
    for (const bool boxes : {false, true}) {
      std::mt19937_64 random = oracle::seeded(2701 + (boxes ? 1 : 0) + (is_carried ? 2 : 0));
      oracle::MeetingTally tally;
      for (int i = 0; i < count; ++i) {
        const FenceCrossing crossing = random_fence_crossing(random, boxes, is_carried);
        const std::vector<Told> told = OneFence(crossing).tell(random, 0.5);
        oracle::compare(crossing.mover, crossing.fence, stays_of(told), tally);
        ASSERT_EQ(tally.lies(), 0) << "crossing " << i << (boxes ? " of boxes" : " of balls")
                                   << (is_carried ? ", carried: " : ": ") << tally.missed << " missed, "
                                   << tally.invented << " invented, " << tally.wrong_brackets
                                   << " brackets beside the truth";
      }
      std::printf("%s%s=%d stays=%d missed=%d invented=%d wrong_brackets=%d too_near=%d\n", boxes ? "boxes" : "balls",
                  is_carried ? "_carried" : "", count, tally.meetings, tally.missed, tally.invented,
                  tally.wrong_brackets, tally.too_near);
      EXPECT_GT(tally.meetings, count / 5) << "crossings must be worth it";
      EXPECT_LT(tally.too_near, 10 + count / 100);
    }
  }
}

// Arrival order and steps do not show: events are equal to the bit.
TEST(FenceCrossings, AnyArrivalOrderTellsTheSame) {
  std::mt19937_64 random = oracle::seeded(2705);
  std::size_t events = 0;
  for (int i = 0; i < 200; ++i) {
    const FenceCrossing crossing = random_fence_crossing(random, i % 2 == 0, true);
    const std::vector<Told> first = OneFence(crossing).tell(random, 1);
    events += first.size();
    for (int order = 0; order < 5; ++order) ASSERT_EQ(first, OneFence(crossing).tell(random, 0.3)) << "crossing " << i;
  }
  EXPECT_GT(events, 40u);
}

}  // namespace
}  // namespace collided::engine
