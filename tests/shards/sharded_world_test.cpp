// What several servers answer together, beside one server with the same world.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/oracle/seed.hpp"
#include "tests/service/eventually.hpp"
#include "tests/shards/same_answers.hpp"
#include "tests/shards/sharded_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing_support::are_equal;

constexpr const char* kHalves = R"({"margin_m": 1, "shards": [
  {"name": "west", "low": [null, null, null], "high": [0, null, null]},
  {"name": "east", "low": [0, null, null], "high": [null, null, null]}]})";

std::string text_of(const Answer& answer) {
  json text{{"verdict", static_cast<int>(answer.verdict)}, {"reason", static_cast<int>(answer.reason)}};
  for (const Hit& hit : answer.hits) text["hits"].push_back({hit.object, hit.triangle, hit.distance_m, hit.error_m});
  return text.dump();
}

class ShardedWorld : public testing_support::ShardedWorldTest {
 protected:
  /// Starts four shards and the whole, with a scene and objects of all kinds, many of them across borders.
  void start_all(std::mt19937_64& random) {
    write_map(random_map(random, 4, 0.5));
    map_ = shards::ShardMap::read(map_file_);
    const std::string scene = write_random_scene(random, 150);
    start({scene, "--member", "whole"}, "whole");
    for (std::size_t place = 0; place < map_->size(); ++place) start_shard(map_->at(place).name, {scene});
    whole_ = std::make_unique<Client>(connect());
    for (std::size_t place = 0; place < map_->size(); ++place)
      shards_.push_back(std::make_unique<Client>(connect_to_shard(map_->at(place).name)));
    for (int i = 0; i < 150; ++i) add(random_object(random, i));
    sharded_ = std::make_unique<ShardedClient>(connect_sharded());
  }

  static ObjectOptions random_object(std::mt19937_64& random, int number_of_it) {
    ObjectOptions object{.name = "object_" + std::to_string(number_of_it),
                         .pose = {.position = vector(random, kReach_m), .rotation = rotation(random)}};
    const double size_m = random() % 8 == 0 ? 3 : 0.4;
    if (random() % 2 == 0) object.shape = {SphereShape{.radius_m = size_m}};
    else object.shape = {BoxShape{.half_m = Vec3(size_m, size_m / 2, size_m / 3)}};
    object.moving = random() % 2 == 0;
    return object;
  }

  /// To the whole, and to those shards that must hold it.
  void add(const ObjectOptions& object) {
    ASSERT_TRUE(whole_->add(object));
    const double reach_m = 1.001 * std::sqrt(3.0) * 3;
    shards::ShardBox bounds;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds.low[axis] = object.pose.position[static_cast<Eigen::Index>(axis)] - reach_m;
      bounds.high[axis] = object.pose.position[static_cast<Eigen::Index>(axis)] + reach_m;
    }
    const shards::ShardSet holders = map_->holders_of(bounds);
    for (std::size_t place = 0; place < shards_.size(); ++place) {
      if ((holders >> place & 1) != 0) { ASSERT_TRUE(shards_[place]->add(object)); }
    }
  }

  RayQuestion random_ray(std::mt19937_64& random) const {
    RayQuestion ray{.origin = vector(random, 1.3 * kReach_m), .direction = vector(random, 1)};
    if (random() % 4 == 0) ray.direction[static_cast<Eigen::Index>(random() % 3)] = 0;
    if (ray.direction.isZero()) ray.direction = Vec3(0, 0, -1);
    if (random() % 4 == 0) put_on_border(ray, random);
    if (random() % 3 == 0) ray.length_m = std::abs(number(random, 2 * kReach_m));
    return ray;
  }
  /// It begins in a plane between shards, and sometimes stays there.
  void put_on_border(RayQuestion& ray, std::mt19937_64& random) const {
    const shards::ShardBox& box = map_->at(random() % map_->size()).box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(box.low[axis])) continue;
      const auto at = static_cast<Eigen::Index>(axis);
      ray.origin[at] = box.low[axis];
      if (random() % 2 == 0) ray.direction[at] = 0;
    }
    if (ray.direction.isZero()) ray.direction = Vec3(1, 1, 1);
  }

  template <class Q>
  void expect_same(const std::vector<Q>& questions, const AskOptions& options) {
    const Result<Answers> from_one = whole_->ask(questions, options);
    const Result<Answers> from_all = sharded_->ask(questions, options);
    ASSERT_TRUE(from_one) << from_one.error().message;
    ASSERT_TRUE(from_all) << from_all.error().message;
    for (std::size_t i = 0; i < questions.size(); ++i) {
      const Answer& one = from_one->answers[i];
      const Answer& all = from_all->answers[i];
      hit_count_ += one.verdict == Verdict::hit ? 1 : 0;
      undecided_count_ += one.verdict == Verdict::undecided ? 1 : 0;
      const bool is_same = options.mode == HitMode::any ? one.verdict == all.verdict : are_equal(one, all);
      if (!is_same) ADD_FAILURE() << i << ": " << text_of(one) << " but of the shards " << text_of(all);
      if (::testing::Test::HasFailure()) return;
    }
  }

  std::optional<shards::ShardMap> map_;
  std::unique_ptr<Client> whole_;
  std::vector<std::unique_ptr<Client>> shards_;
  std::unique_ptr<ShardedClient> sharded_;
  std::size_t hit_count_ = 0;
  std::size_t undecided_count_ = 0;
};

std::size_t ray_count() {
  const char* asked = std::getenv("COLLIDED_RAYS");
  return asked != nullptr ? std::strtoull(asked, nullptr, 10) : 20'000;
}

TEST_F(ShardedWorld, RaysAreAsOnOneServer) {
  std::mt19937_64 random = oracle::seeded(28);
  ASSERT_NO_FATAL_FAILURE(start_all(random));
  constexpr HitMode kModes[] = {HitMode::closest, HitMode::closest, HitMode::closest,
                                HitMode::all,     HitMode::any,     HitMode::verdict};
  std::size_t asked = 0;
  for (int batch = 0; asked < ray_count() && !HasFailure(); ++batch) {
    std::vector<RayQuestion> rays(batch % 7 == 0 ? 1 : 500);
    for (RayQuestion& ray : rays) ray = random_ray(random);
    expect_same(rays, {.mode = kModes[random() % std::size(kModes)], .timeout = 60s});
    asked += rays.size();
  }
  EXPECT_GT(hit_count_, asked / 10);
  EXPECT_LT(hit_count_, asked - asked / 10);
  std::printf("%zu rays: %zu hit, %zu undecided, all the same\n", asked, hit_count_, undecided_count_);
}

TEST_F(ShardedWorld, WhatSpheresBoxesAndPointsMeetIsAsOnOneServer) {
  std::mt19937_64 random = oracle::seeded(29);
  ASSERT_NO_FATAL_FAILURE(start_all(random));
  constexpr HitMode kModes[] = {HitMode::closest, HitMode::all, HitMode::any, HitMode::verdict};
  for (int batch = 0; batch < 16 && !HasFailure(); ++batch) {
    const AskOptions options{.mode = kModes[batch % 4], .timeout = 60s};
    std::vector<SphereQuestion> spheres(200);
    for (SphereQuestion& one : spheres)
      one = {.center = vector(random, kReach_m), .radius_m = std::abs(number(random, random() % 8 == 0 ? 9 : 1))};
    expect_same(spheres, options);
    std::vector<BoxQuestion> boxes(200);
    for (BoxQuestion& one : boxes)
      one = {.center = vector(random, kReach_m), .half_m = vector(random, 2).cwiseAbs(), .rotation = rotation(random)};
    expect_same(boxes, options);
    std::vector<InsideQuestion> points(200);
    for (InsideQuestion& one : points) one = {.point = vector(random, kReach_m)};
    expect_same(points, options);
  }
  EXPECT_GT(hit_count_, 1000u);
}

TEST_F(ShardedWorld, TheNearestIsAsOnOneServer) {
  std::mt19937_64 random = oracle::seeded(30);
  ASSERT_NO_FATAL_FAILURE(start_all(random));
  for (int batch = 0; batch < 20 && !HasFailure(); ++batch) {
    AskOptions options{.mode = batch % 2 == 0 ? HitMode::closest : HitMode::signed_near, .timeout = 60s};
    if (batch % 3 != 0) options.max_hits = static_cast<std::uint32_t>(1 + random() % 40);
    std::vector<NearQuestion> points(200);
    for (NearQuestion& one : points) {
      one = {.point = vector(random, 1.5 * kReach_m)};
      if (random() % 2 == 0) one.within_m = std::abs(number(random, 5));
    }
    expect_same(points, options);
  }
  EXPECT_GT(hit_count_, 1000u);
}

bool are_same(const PairAnswer& x, const PairAnswer& y) {
  return x.verdict == y.verdict && x.distance_m == y.distance_m && x.depth_m == y.depth_m && x.error_m == y.error_m &&
         x.on_a == y.on_a && x.on_b == y.on_b && x.point == y.point && x.normal == y.normal &&
         x.a_triangle == y.a_triangle && x.b_triangle == y.b_triangle;
}

TEST_F(ShardedWorld, PairsAreAsOnOneServerOrFartherApartThanTheMargin) {
  std::mt19937_64 random = oracle::seeded(33);
  ASSERT_NO_FATAL_FAILURE(start_all(random));
  const auto any_name = [&] {
    const std::uint64_t number = random() % 150;
    return random() % 3 == 0 ? "scene/part_" + std::to_string(number) : "object_" + std::to_string(number);
  };
  std::size_t same_count = 0;
  std::size_t far_count = 0;
  for (int i = 0; i < 400 && !HasFailure(); ++i) {
    const std::string a = any_name();
    const std::string b = any_name();
    if (a == b) continue;
    const Result<PairAnswer> one = whole_->pair(a, b);
    const Result<ShardedPairAnswer> all = sharded_->pair(a, b);
    ASSERT_TRUE(one) << one.error().message;
    ASSERT_TRUE(all) << all.error().message;
    if (all->farther_than_m > 0) {
      EXPECT_EQ(all->verdict, Verdict::undecided);
      EXPECT_EQ(all->reason, UndecidedReason::not_covered);
      EXPECT_EQ(one->verdict, Verdict::miss) << a << ' ' << b;
      EXPECT_GE(one->distance_m + one->error_m, all->farther_than_m) << a << ' ' << b;
      ++far_count;
    } else {
      EXPECT_TRUE(are_same(*one, *all)) << a << ' ' << b << ": " << one->distance_m << ' ' << all->distance_m;
      ++same_count;
    }
  }
  EXPECT_GT(same_count, 40U);
  EXPECT_GT(far_count, 40U);
  std::printf("%zu pairs the same, %zu in no shard together\n", same_count, far_count);
  const Result<ShardedPairAnswer> unknown = sharded_->pair("object_1", "nobody");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().message, "no shard has an object 'nobody'");
}

TEST_F(ShardedWorld, ClearancesUpToTheMarginAreAsOnOneServer) {
  std::mt19937_64 random = oracle::seeded(34);
  ASSERT_NO_FATAL_FAILURE(start_all(random));
  const auto any_group = [&]() -> std::string {
    if (random() % 4 == 0) return "scene";
    return (random() % 3 == 0 ? "scene/part_" : "object_") + std::to_string(random() % 15) + "*";
  };
  const auto names = [](const ClearancePair& pair) { return std::minmax(pair.a, pair.b); };
  std::size_t pair_count = 0;
  std::size_t incomplete_count = 0;
  for (int i = 0; i < 60 && !HasFailure(); ++i) {
    const std::string from = any_group();
    const bool is_near = random() % 2 == 0;
    ClearanceOptions options{.to = any_group(), .most = is_near ? 10'000U : 1U};
    if (is_near) options.nearer_m = std::abs(number(random, 0.5));
    const Result<ClearanceAnswer> one = whole_->clearance(from, options);
    const Result<ShardedClearanceAnswer> all = sharded_->clearance(from, options);
    if (!one || !all) {
      // No shard has objects of both groups.
      const bool is_near_one = one && !one->pairs.empty();
      EXPECT_GE(is_near_one ? one->pairs[0].clearance_m + one->pairs[0].error_m : 0.5, 0.5) << from << options.to;
      continue;
    }
    if (std::isfinite(all->complete_to_m)) {
      EXPECT_FALSE(is_near);
      EXPECT_EQ(all->verdict, Verdict::undecided);
      ASSERT_FALSE(one->pairs.empty());
      EXPECT_GE(one->pairs[0].clearance_m + one->pairs[0].error_m, all->complete_to_m);
      ++incomplete_count;
      continue;
    }
    EXPECT_EQ(one->verdict, all->verdict);
    ASSERT_EQ(one->pairs.size(), all->pairs.size()) << from << " and " << options.to;
    auto expected = one->pairs;
    std::ranges::sort(expected, [&](const ClearancePair& x, const ClearancePair& y) {
      return std::tuple(x.clearance_m, x.a, x.b) < std::tuple(y.clearance_m, y.a, y.b);
    });
    for (std::size_t k = 0; k < expected.size(); ++k) {
      EXPECT_EQ(expected[k].clearance_m, all->pairs[k].clearance_m);
      EXPECT_EQ(expected[k].error_m, all->pairs[k].error_m);
      const bool is_tie = (k > 0 && expected[k - 1].clearance_m == expected[k].clearance_m) ||
                          (k + 1 < expected.size() && expected[k + 1].clearance_m == expected[k].clearance_m);
      if (!is_tie && options.most > 1) { EXPECT_EQ(names(expected[k]), names(all->pairs[k])) << k; }
    }
    pair_count += expected.size();
  }
  EXPECT_GT(pair_count, 100U);
  EXPECT_GT(incomplete_count, 0U);
  std::printf("%zu pairs within the margin, the same\n", pair_count);
}

TEST_F(ShardedWorld, APairThatASilentShardMayHoldIsUndecided) {
  write_map(kHalves);
  for (const char* shard : {"west", "east"}) start_shard(shard);
  ShardedClient client = connect_sharded();
  const auto ball = [](const char* name, double x) {
    return ObjectOptions{
        .name = name, .shape = {SphereShape{.radius_m = 0.1}}, .pose = {.position = {x, 0, 40}}, .moving = false};
  };
  Client west = connect_to_shard("west");
  for (const auto& one : {ball("here", -20), ball("there", -19), ball("beside", -18)}) ASSERT_TRUE(west.add(one));
  ASSERT_TRUE(connect_to_shard("east").add(ball("yonder", 20)));
  EXPECT_NEAR(client.pair("here", "there")->distance_m, 0.8, 1e-9);
  EXPECT_EQ(client.pair("here", "yonder")->farther_than_m, 1);
  EXPECT_EQ(client.clearance("here", {.to = "there", .nearer_m = 0.9})->pairs.size(), 1U);
  EXPECT_EQ(client.clearance("here", {.to = ""}).error().code, ErrorCode::bad_input);
  servers_[1]->signal(SIGKILL);
  servers_[1]->wait(5s);
  EXPECT_TRUE(test::eventually([&] { return !client.shards()[1].is_there; }));
  EXPECT_NEAR(client.pair("here", "there")->distance_m, 0.8, 1e-9) << "a shard that holds both decides";
  const Result<ShardedPairAnswer> gone = client.pair("here", "yonder");
  ASSERT_TRUE(gone) << gone.error().message;
  EXPECT_EQ(gone->verdict, Verdict::undecided);
  EXPECT_EQ(gone->farther_than_m, 0) << "nothing is known of the other one";
  EXPECT_EQ(client.clearance("here", {.to = "beside", .nearer_m = 0.5})->reason, UndecidedReason::not_covered);
}

// The box meets the unknown object at its end, in the west; nearer to its middle is another one, beyond the border, that it
// does not meet. That the other shard answers for that one says nothing of the first.
TEST_F(ShardedWorld, UnknownSpaceThatABoxMeetsIsNotHiddenByOneBeyondTheBorder) {
  write_map(kHalves);
  for (const char* shard : {"west", "east"}) start_shard(shard);
  ShardedClient client = connect_sharded();
  Result<ShardedPublisher> publisher = client.publish("scanner", {.lease = 600s});
  ASSERT_TRUE(publisher) << publisher.error().message;
  const auto add = [&](const std::string& name, const Vec3& where) {
    ASSERT_TRUE(publisher->add({.name = name,
                                .shape = {SphereShape{.radius_m = 0.1}},
                                .pose = {.position = where},
                                .moving = false,
                                .unknown = true}));
    ASSERT_TRUE(publisher->flush());
    ASSERT_TRUE(publisher->wait_applied(10s));
  };
  const BoxQuestion box{.center = {-0.2, 0, 40}, .half_m = {0.1, 5, 0.1}};
  const BoxQuestion free{.center = {-0.2, -4, 40}, .half_m = {0.1, 5, 0.1}};
  add("met", {-0.2, 4.5, 40});
  EXPECT_EQ(client.ask(box)->reason, UndecidedReason::not_covered);
  add("nearer", {0.95, 0, 40});
  EXPECT_EQ(client.ask(box)->verdict, Verdict::undecided);
  EXPECT_EQ(client.ask(box)->reason, UndecidedReason::not_covered);
  EXPECT_EQ(client.ask(free)->verdict, Verdict::miss) << "it meets neither";
}

TEST_F(ShardedWorld, WhatReachesUnknownSpaceIsAsOnOneServer) {
  std::mt19937_64 random = oracle::seeded(32);
  ASSERT_NO_FATAL_FAILURE(start_all(random));
  Result<Publisher> of_whole = whole_->publish("scanner", {.lease = 600s});
  Result<ShardedPublisher> of_shards = sharded_->publish("scanner", {.lease = 600s});
  ASSERT_TRUE(of_whole && of_shards);
  for (int i = 0; i < 60; ++i) {
    ObjectOptions object = random_object(random, 1'000 + i);
    object.moving = false;
    object.unknown = true;
    ASSERT_TRUE(of_whole->add(object));
    ASSERT_TRUE(of_shards->add(object));
  }
  ASSERT_TRUE(of_whole->flush() && of_shards->flush());
  ASSERT_TRUE(of_whole->wait_applied(60s) && of_shards->wait_applied(60s));
  for (int batch = 0; batch < 10 && !HasFailure(); ++batch) {
    const AskOptions options{.timeout = 60s};
    std::vector<BoxQuestion> boxes(500);
    for (BoxQuestion& one : boxes) {
      one = {
          .center = vector(random, kReach_m), .half_m = vector(random, 0.5).cwiseAbs(), .rotation = rotation(random)};
      one.half_m[static_cast<Eigen::Index>(random() % 3)] = std::abs(number(random, 6));
    }
    expect_same(boxes, options);
    std::vector<SphereQuestion> spheres(200);
    for (SphereQuestion& one : spheres)
      one = {.center = vector(random, kReach_m), .radius_m = std::abs(number(random, 1))};
    expect_same(spheres, options);
    std::vector<RayQuestion> rays(200);
    for (RayQuestion& ray : rays) ray = random_ray(random);
    expect_same(rays, options);
    std::vector<NearQuestion> points(200);
    for (NearQuestion& one : points) one = {.point = vector(random, kReach_m), .within_m = std::abs(number(random, 2))};
    expect_same(points, options);
  }
  EXPECT_GT(undecided_count_, 500u);
}

TEST_F(ShardedWorld, OfAShardThatDiedNothingBecomesAMiss) {
  std::mt19937_64 random = oracle::seeded(31);
  ASSERT_NO_FATAL_FAILURE(start_all(random));
  servers_[2]->signal(SIGKILL);
  servers_[2]->wait(5s);
  EXPECT_TRUE(test::eventually([&] { return !sharded_->shards()[1].is_there; }));
  std::vector<RayQuestion> rays(2'000);
  for (RayQuestion& ray : rays) ray = random_ray(random);
  std::size_t same_count = 0;
  std::size_t open_count = 0;
  const Result<Answers> from_one = whole_->ask(rays);
  const Result<Answers> from_all = sharded_->ask(rays);
  ASSERT_TRUE(from_one && from_all);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Answer& all = from_all->answers[i];
    if (all.verdict == Verdict::undecided) {
      ++open_count;
      EXPECT_EQ(all.reason, UndecidedReason::not_covered);
      EXPECT_TRUE(all.uncovered);
      continue;
    }
    EXPECT_TRUE(are_equal(from_one->answers[i], all)) << text_of(from_one->answers[i]) << ' ' << text_of(all);
    ++same_count;
  }
  EXPECT_GT(same_count, 100u);
  EXPECT_GT(open_count, 100u);
  std::printf("%zu as before, %zu undecided\n", same_count, open_count);
}

TEST_F(ShardedWorld, OneShardAloneSaysThatTheRestIsNotCovered) {
  write_map(kHalves);
  const std::string scene = folder_.write("row.obj",
                                          "o far_west\nv -9 0 0\nv -9 1 0\nv -9 0 1\nf 1 2 3\n"
                                          "o middle\nv 0.5 0 0\nv 0.5 1 0\nv 0.5 0 1\nf 4 5 6\n"
                                          "o far_east\nv 9 0 0\nv 9 1 0\nv 9 0 1\nf 7 8 9\n");
  testing_support::ChildProcess& server = start_shard("west", {scene});
  EXPECT_NE(server.output().find("shard 'west' leaves out 1 part and 0 objects"), std::string::npos) << server.output();
  Client west = connect_to_shard("west");
  EXPECT_EQ(west.status()->static_triangles, 2u);
  const RayQuestion eastward{.origin = {-5, 0.25, 0.25}, .direction = {1, 0, 0}};
  EXPECT_EQ(west.ask(eastward)->verdict, Verdict::hit);
  EXPECT_EQ(west.ask(eastward)->hits[0].object, "row/middle");
  const Result<Answer> beyond = west.ask(RayQuestion{.origin = {-5, 0.9, 0.9}, .direction = {1, 0, 0}});
  EXPECT_EQ(beyond->verdict, Verdict::undecided);
  EXPECT_EQ(beyond->reason, UndecidedReason::not_covered);
  ASSERT_TRUE(beyond->uncovered);
  EXPECT_NEAR(beyond->uncovered->covered_m, 6, 1e-9);
  EXPECT_EQ(west.ask(RayQuestion{.origin = {-5, 0.9, 0.9}, .direction = {1, 0, 0}, .length_m = 5})->verdict,
            Verdict::miss);
  EXPECT_EQ(west.ask(SphereQuestion{.center = {-5, 0, 0}, .radius_m = 1})->verdict, Verdict::miss);
  EXPECT_EQ(west.ask(SphereQuestion{.center = {5, 0, 0}, .radius_m = 1})->reason, UndecidedReason::not_covered);
  const Result<std::string> refused =
      west.command("load", json{{"path", scene}, {"name", "again"}, {"covers", {{0, 0, 0, 1, 1, 1}}}}.dump());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::refused);
  ASSERT_TRUE(west.load(scene, {.name = "again"}));
  EXPECT_TRUE(test::eventually([&] { return west.status()->static_triangles == 4u; }));
}

TEST_F(ShardedWorld, AShardOfAnotherMapIsNotOne) {
  write_map(R"({"margin_m": 2, "shards": [
    {"name": "west", "low": [null, null, null], "high": [0, null, null]},
    {"name": "east", "low": [0, null, null], "high": [null, null, null]}]})",
            "other.json");
  start_shard("east");
  write_map(kHalves);
  testing_support::ChildProcess& west = start_shard("west");
  ShardedClient client = connect_sharded();
  std::vector<ShardState> states = client.shards();
  EXPECT_TRUE(states[0].is_there) << states[0].fault;
  EXPECT_FALSE(states[1].is_there);
  EXPECT_NE(states[1].fault.find("shard 'east' of another map"), std::string::npos) << states[1].fault;
  const RayQuestion eastward{.origin = {-30, 0, 30}, .direction = {1, 0, 0}};
  const Result<Answer> answer = client.ask(eastward);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->reason, UndecidedReason::not_covered);
  ASSERT_TRUE(answer->uncovered);
  EXPECT_NEAR(answer->uncovered->covered_m, 30, 1e-9) << "where the ray enters the other shard's box";
  // Another map comes into a shard's place while a client is there.
  west.signal(SIGTERM);
  west.wait(10s);
  write_map(R"({"shards": [{"name": "west", "low": [null, null, null], "high": [null, null, null]}]})", "third.json");
  start_shard("west");
  EXPECT_TRUE(test::eventually([&] { return client.shards()[0].fault.find("another map") != std::string::npos; }));
  const Result<Answer> later = client.ask(eastward);
  ASSERT_TRUE(later) << later.error().message;
  EXPECT_EQ(later->reason, UndecidedReason::not_covered);
  EXPECT_EQ(later->uncovered->covered_m, 0);
}

// What is attached in one shard would stay where its parent left that shard, and its space count as free.
TEST_F(ShardedWorld, NothingIsAttachedToWhatGoesFromShardToShard) {
  write_map(kHalves);
  start_shard("west");
  start_shard("east");
  ShardedClient client = connect_sharded();
  Client west = connect_to_shard("west");
  const Shape ball{SphereShape{.radius_m = 0.1}};
  ASSERT_TRUE(west.add({.name = "load", .shape = ball, .pose = {.position = {-6, 0, 41}}}));
  Result<ShardedPublisher> drives = client.publish("drives", {.lease = 60s});
  ASSERT_TRUE(drives) << drives.error().message;
  ASSERT_TRUE(drives->add({.name = "truck", .shape = ball, .pose = {.position = {-6, 0, 40}}}));
  ASSERT_TRUE(drives->flush());
  ASSERT_TRUE(drives->wait_applied(10s));
  const Result<Attached> refused = west.attach("load", "truck");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("moves that from shard to shard"), std::string::npos)
      << refused.error().message;
  // What a publisher of that shard alone moves stays there.
  Publisher stays = publish(west, "stays");
  add_ball(stays, "cart", at(-6, 0, 42));
  ASSERT_TRUE(stays.flush());
  ASSERT_TRUE(stays.wait_applied(10s));
  const Result<Attached> attached = west.attach("load", "cart");
  EXPECT_TRUE(attached) << attached.error().message;
}

TEST_F(ShardedWorld, ASettledInstantIsThatOfTheSlowestPublisher) {
  write_map(kHalves);
  start_shard("west");
  start_shard("east");
  Client west = connect_to_shard("west");
  Client east = connect_to_shard("east");
  ShardedClient client = connect_sharded();
  const AskOptions settled{.as_of = {.kind = Instant::Kind::settled}};
  const NearQuestion nearest{.point = {0, 0, 40}};
  ASSERT_TRUE(client.ask(nearest, settled)) << "nobody publishes: the newest state of each is settled";
  Publisher slow = publish(west, "slow");
  Publisher quick = publish(east, "quick");
  const Publisher::Object behind = add_ball(slow, "behind", at(-1, 0, 40));
  const Publisher::Object ahead = add_ball(quick, "ahead", at(1, 0, 40));
  const auto began = std::chrono::system_clock::now();
  for (int i = 1; i <= 10; ++i) {
    const auto instant = began + i * 20ms;
    std::this_thread::sleep_until(instant);
    ASSERT_TRUE(quick.move(ahead, at(1 + i, 0, 40)));
    ASSERT_TRUE(quick.flush(instant.time_since_epoch()));
    if (i > 4) continue;
    ASSERT_TRUE(slow.move(behind, at(-1 - 0.5 * i, 0, 40)));
    ASSERT_TRUE(slow.flush(instant.time_since_epoch()));
  }
  ASSERT_TRUE(quick.wait_applied(10s));
  ASSERT_TRUE(slow.wait_applied(10s));
  const auto settled_time = (began + 80ms).time_since_epoch();
  const AskOptions both_then{.max_hits = 2, .as_of = settled.as_of};
  EXPECT_TRUE(test::eventually([&] {
    const Result<Answers> answers = client.ask(std::vector{nearest}, both_then);
    return answers && answers->world_time == settled_time;
  }));
  const Result<Answer> then = client.ask(nearest, both_then);
  ASSERT_TRUE(then) << then.error().message;
  ASSERT_EQ(then->hits.size(), 2u);
  EXPECT_EQ(then->hits[0].object, "behind");
  EXPECT_NEAR(then->hits[0].distance_m, 2.9, 1e-6);
  EXPECT_NEAR(then->hits[1].distance_m, 4.9, 1e-6) << "where it was then, not where it is now";
  const Result<Answer> now = client.ask(nearest, {.max_hits = 2});
  ASSERT_TRUE(now);
  EXPECT_NEAR(now->hits[1].distance_m, 10.9, 1e-6);
  const Result<Answer> asked_at = client.ask(
      nearest, {.max_hits = 2, .as_of = {.kind = Instant::Kind::at, .time = (began + 60ms).time_since_epoch()}});
  ASSERT_TRUE(asked_at) << asked_at.error().message;
  EXPECT_NEAR(asked_at->hits[0].distance_m, 2.4, 1e-6);
}

}  // namespace
}  // namespace collided
