// Generated motions of many objects about one, beside brute force over their poses, for every order of arrival.
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
#include "tests/oracle/nearest_oracle.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/world/common_time_arrivals.hpp"

namespace collided::engine {
namespace {

/// As many as are asked for by that variable of the environment, for the long form of a test; else the given number.
int scenes_asked(int fallback) {
  const char* text = std::getenv("COLLIDED_NEAREST");
  return text != nullptr ? std::atoi(text) : fallback;
}

double drawn(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Balls of several publishers, and the question which of them is nearest to one of them or to a point.
struct NearestScene {
  MovingBody about;
  bool is_point = false;
  std::vector<MovingBody> balls;
  std::vector<std::size_t> publishers;  // of the balls; that of `about` is 0
  NearestRule rule;
  bool is_streamed = false;
  bool is_compound = false;  // each ball is two in one place, so that it does not pass for one convex body
};

std::vector<std::int64_t> random_times(std::mt19937_64& random) {
  const double period_ns = drawn(random, 2e7, 1.8e8);
  std::vector<std::int64_t> times;
  for (double time_ns = 1'000; time_ns < 1.2e9 || times.size() < 3; time_ns += period_ns * drawn(random, 0.7, 1.3))
    times.push_back(kStart + static_cast<std::int64_t>(time_ns));
  return times;
}

MovingBody random_ball(std::mt19937_64& random, const std::vector<std::int64_t>& times, double size, double speed) {
  const auto vector = [&](double most) {
    return Vec3(drawn(random, -most, most), drawn(random, -most, most), drawn(random, -most, most));
  };
  MovingBody ball{.form = size * drawn(random, 0.005, 0.05), .instants = {}};
  Vec3 at = vector(size);
  std::int64_t before_ns = times.front();
  for (const std::int64_t time_ns : times) {
    const Vec3 velocity = vector(speed) - at * (speed / (2 * size));
    // Some rest for a while: then a batch leaves them out.
    if (std::bernoulli_distribution(0.8)(random)) at += velocity * (1e-9 * static_cast<double>(time_ns - before_ns));
    before_ns = time_ns;
    ball.instants.push_back({time_ns, at});
  }
  return ball;
}

NearestScene random_scene(std::mt19937_64& random) {
  const double size = std::exp(drawn(random, 0, 4));
  const double speed = size * std::exp(drawn(random, 0, 2));
  NearestScene scene;
  const std::size_t publishers = std::uniform_int_distribution<std::size_t>(1, 3)(random);
  std::vector<std::vector<std::int64_t>> times;
  for (std::size_t i = 0; i < publishers; ++i) times.push_back(random_times(random));
  scene.is_point = std::bernoulli_distribution(0.3)(random);
  scene.about = random_ball(random, times.front(), size, speed);
  if (scene.is_point) {
    const Vec3 point = scene.about.instants.front().position;
    scene.about = {.form = 0.0, .instants = {{kStart, point}, {times.front().back() + 1'000'000'000, point}}};
  }
  const int count = std::uniform_int_distribution<int>(2, 7)(random);
  for (int i = 0; i < count; ++i) {
    scene.publishers.push_back(std::uniform_int_distribution<std::size_t>(0, publishers - 1)(random));
    scene.balls.push_back(random_ball(random, times[scene.publishers.back()], size, speed));
  }
  scene.rule.within_m = size * drawn(random, 0.4, 3);
  if (std::bernoulli_distribution(0.5)(random)) scene.rule.hysteresis_m = size * drawn(random, 0, 0.3);
  scene.is_streamed = std::bernoulli_distribution(0.25)(random);
  scene.is_compound = std::bernoulli_distribution(0.2)(random);
  return scene;
}

/// Who is nearest from then on; -1: nobody.
struct ToldNearest {
  int who = -1;
  std::int64_t low_ns = 0;
  std::int64_t high_ns = 0;
  double distance_m = 0;
  double error_m = 0;
  bool operator==(const ToldNearest&) const = default;
};

class OneQuestion {
 public:
  explicit OneQuestion(const NearestScene& scene) : scene_(scene) {
    if (!scene.is_point) bodies_.push_back({define("about", scene.about, 0), 0, &scene.about});
    for (std::size_t i = 0; i < scene.balls.size(); ++i)
      bodies_.push_back({define("ball_" + std::to_string(i), scene.balls[i], scene.publishers[i]), scene.publishers[i],
                         &scene.balls[i]});
    FenceDefinition question{.name = "near", .only = "ball_*", .nearest = scene.rule};
    question.shape.primitives.emplace_back(
        Sphere{scene.is_point ? scene.about.instants.front().position : Vec3::Zero(), 0});
    if (!scene.is_point) question.carrier = "about";
    EXPECT_TRUE(std::holds_alternative<ObjectId>(world_.add_fence(question)));
    for (const Body& body : bodies_) {
      for (std::size_t i = 0; i < body.moving->instants.size(); ++i)
        batches_[body.publisher][body.moving->instants[i].time_ns].push_back(&body);
    }
    step();
  }

  /// Publishers' batches in a random order; steps come with that chance after each, and where an object would move twice.
  std::vector<ToldNearest> tell(std::mt19937_64& random, double step_chance) {
    std::vector<std::size_t> order;
    for (const auto& [publisher, batches] : batches_) order.insert(order.end(), batches.size(), publisher);
    std::shuffle(order.begin(), order.end(), random);
    std::map<std::size_t, std::size_t> next;
    for (const std::size_t publisher : order) {
      const auto batch = std::next(batches_[publisher].begin(), static_cast<std::ptrdiff_t>(next[publisher]++));
      send(publisher, batch->first, batch->second);
      if (std::bernoulli_distribution(step_chance)(random)) step();
    }
    step();
    return told_;
  }
  bool is_any_in_doubt() const { return is_any_in_doubt_; }

 private:
  struct Body {
    ObjectId id = 0;
    std::size_t publisher = 0;
    const MovingBody* moving = nullptr;

    Vec3 at(std::int64_t time_ns) const {
      for (const Instant& instant : moving->instants) {
        if (instant.time_ns == time_ns) return instant.position;
      }
      return Vec3::Zero();
    }
  };

  ObjectId define(const std::string& name, const MovingBody& body, std::size_t publisher) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape = shape_of(body);
    if (scene_.is_compound) definition.shape.primitives.push_back(definition.shape.primitives.front());
    definition.publisher = publisher + 1;
    definition.pose.position = body.instants.front().position;
    return std::get<ObjectId>(world_.define(definition));
  }

  /// What rests since the batch before is left out of a framed batch.
  void send(std::size_t publisher, std::int64_t time_ns, const std::vector<const Body*>& moving) {
    std::vector<ObjectId> ids;
    std::vector<Pose> poses;
    bool is_any_moved = false;
    for (const Body* body : moving) {
      Vec3& before = last_.try_emplace(body->id, body->at(time_ns)).first->second;
      const Vec3 at = body->at(time_ns);
      if (at == before && !scene_.is_streamed) continue;
      before = at;
      is_any_moved = is_any_moved || world_.has_moved(body->id);
      ids.push_back(body->id);
      poses.push_back({.position = at});
    }
    if (is_any_moved) step();
    const auto moved = std::make_unique<bool[]>(ids.size() + 1);
    world_.move(ids, poses, time_ns, false, {moved.get(), ids.size()}, scene_.is_streamed);
    world_.advance(publisher + 1, time_ns);
  }

  void step() {
    EXPECT_TRUE(world_.step(++now_ns_, 1, {}));
    const auto time = [&](double seconds_ago) { return now_ns_ - std::llround(seconds_ago * 1e9); };
    for (const Event& event : world_.fences()->events()) {
      EXPECT_EQ(event.sequence, ++last_sequence_);
      is_any_in_doubt_ = is_any_in_doubt_ || event.of.doubt != Doubt::none;
      ToldNearest told{.low_ns = time(event.bracket_low_s), .high_ns = time(event.bracket_high_s)};
      if (event.kind == EventKind::ended && event.of.b_triangle == kNearestGoesOn) continue;
      if (event.kind == EventKind::began) {
        told.who = number_of(event.of.a);
        told.distance_m = -event.of.contact.depth_m;
        told.error_m = event.of.contact.depth_error_m;
      }
      told_.push_back(told);
    }
  }

  int number_of(ObjectId id) const {
    const int first = scene_.is_point ? 0 : 1;
    for (int i = first; i < static_cast<int>(bodies_.size()); ++i) {
      if (bodies_[static_cast<std::size_t>(i)].id == id) return i - first;
    }
    return -2;
  }

  const NearestScene& scene_;
  World world_{WorldOptions{}};
  std::deque<Body> bodies_;
  std::map<std::size_t, std::map<std::int64_t, std::vector<const Body*>>> batches_;
  std::map<ObjectId, Vec3> last_;
  std::int64_t now_ns_ = kStart;
  std::uint64_t last_sequence_ = 0;
  std::vector<ToldNearest> told_;
  bool is_any_in_doubt_ = false;
};

struct NearestTally {
  int scenes = 0;
  int changes = 0;
  int wide_brackets = 0;
  int too_near = 0;  // scenes that doubles or whole nanoseconds cannot be held to; not compared
};

std::string text_of(const std::vector<ToldNearest>& told, const std::vector<oracle::NearestStay>& stays) {
  std::string text = "told:";
  for (const ToldNearest& one : told)
    text += " " + std::to_string(one.who) + "@" + std::to_string(one.low_ns - kStart) + ".." +
            std::to_string(one.high_ns - kStart);
  text += "\ntruth:";
  for (const oracle::NearestStay& stay : stays)
    text += " " + std::to_string(stay.who) + "@" + std::to_string(static_cast<double>(stay.began_ns - kStart));
  return text;
}

void compare(const NearestScene& scene, const std::vector<ToldNearest>& told, NearestTally& tally) {
  double closest_m = 1e300;
  double closest_ns = 1e300;
  const std::vector<oracle::NearestStay> stays = oracle::nearest_stays(
      scene.about, scene.balls, {scene.rule.within_m, scene.rule.hysteresis_m}, closest_m, closest_ns);
  ++tally.scenes;
  if (closest_m < 1e-9 || closest_ns < 50) {
    ++tally.too_near;
    return;
  }
  // Streamed objects are known only up to a while ago, so the last changes may not be told.
  ASSERT_LE(told.size(), stays.size()) << text_of(told, stays);
  ASSERT_TRUE(scene.is_streamed || told.size() == stays.size()) << text_of(told, stays);
  for (std::size_t i = 0; i < told.size(); ++i) {
    const auto truth_ns = stays[i].began_ns;
    ASSERT_EQ(told[i].who, stays[i].who) << "change " << i << "\n" << text_of(told, stays);
    // The first may have been so before all were known.
    if (i == 0 && truth_ns <= static_cast<long double>(kStart + 1'000)) continue;
    ASSERT_LE(static_cast<long double>(told[i].low_ns), truth_ns + 0.01L) << i << "\n" << text_of(told, stays);
    ASSERT_GE(static_cast<long double>(told[i].high_ns), truth_ns - 0.01L) << i << "\n" << text_of(told, stays);
    tally.wide_brackets += told[i].high_ns - told[i].low_ns > 1'000 ? 1 : 0;
    if (told[i].who < 0) continue;
    const double distance_m = static_cast<double>(
        oracle::distance_at(scene.about, scene.balls[static_cast<std::size_t>(told[i].who)], told[i].high_ns));
    EXPECT_LE(std::abs(told[i].distance_m - distance_m), told[i].error_m + 1e-15) << i;
    EXPECT_LE(told[i].error_m, 1e-9);
  }
  tally.changes += static_cast<int>(told.size());
}

// No change is missed, none is invented, and brackets contain what the poses say.
TEST(NearestCrossings, AreToldAsTheOracleFindsThem) {
  const int count = scenes_asked(500);
  std::mt19937_64 random = oracle::seeded(2721);
  NearestTally tally;
  for (int i = 0; i < count; ++i) {
    const NearestScene scene = random_scene(random);
    OneQuestion world(scene);
    const std::vector<ToldNearest> told = world.tell(random, 0.5);
    EXPECT_FALSE(world.is_any_in_doubt()) << "scene " << i;
    compare(scene, told, tally);
    ASSERT_FALSE(testing::Test::HasFailure())
        << "scene " << i << (scene.is_point ? ", a point" : "") << (scene.is_streamed ? ", streamed" : "")
        << (scene.is_compound ? ", compound" : "") << ", hysteresis " << scene.rule.hysteresis_m << ", publishers of "
        << testing::PrintToString(scene.publishers);
  }
  std::printf("scenes=%d changes=%d wrong=0 wide_brackets=%d too_near=%d\n", tally.scenes, tally.changes,
              tally.wide_brackets, tally.too_near);
  EXPECT_GT(tally.changes, 2 * count) << "scenes must be worth it";
  EXPECT_LT(tally.too_near, 10 + count / 20);
  EXPECT_LT(tally.wide_brackets, 10 + tally.changes / 50);
}

// Arrival order and steps do not show: events are equal to the bit.
TEST(NearestCrossings, AnyArrivalOrderTellsTheSame) {
  std::mt19937_64 random = oracle::seeded(2722);
  std::size_t changes = 0;
  for (int i = 0; i < 100; ++i) {
    const NearestScene scene = random_scene(random);
    const std::vector<ToldNearest> first = OneQuestion(scene).tell(random, 1);
    changes += first.size();
    for (int order = 0; order < 5; ++order)
      ASSERT_EQ(first, OneQuestion(scene).tell(random, 0.3))
          << "scene " << i << "\n"
          << text_of(first, {}) << (scene.is_streamed ? " streamed" : "");
  }
  EXPECT_GT(changes, 200u);
}

}  // namespace
}  // namespace collided::engine
