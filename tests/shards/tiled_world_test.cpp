// Shards that each hold a part of a scene in tiles, beside one server that holds the file as a whole.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/intake/scene.hpp"
#include "server/intake/tiles/tile_writer.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/eventually.hpp"
#include "tests/shards/same_answers.hpp"
#include "tests/shards/sharded_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing_support::are_equal;

std::string tiled_text_of(const Answer& answer) {
  json text{{"verdict", static_cast<int>(answer.verdict)}, {"reason", static_cast<int>(answer.reason)}};
  for (const Hit& hit : answer.hits)
    text["hits"].push_back(
        {hit.object, hit.triangle, hit.distance_m, hit.error_m, hit.point.x(), hit.point.y(), hit.point.z()});
  return text.dump();
}

class TiledWorld : public testing_support::ShardedWorldTest {
 protected:
  /// Starts four shards and a server without a shard on tiles, and the whole on the file that the tiles were made of.
  void start_all(std::mt19937_64& random) {
    write_map(random_map(random, 4, 0.5));
    map_ = shards::ShardMap::read(map_file_);
    const std::string scene = write_ground_and_blocks(random);
    const std::string tiles = write_tiles_of(scene, random);
    start({scene, "--member", "whole"}, "whole");
    start({tiles, "--namespace", "tiled", "--member", "tiled"}, "tiled");
    std::uint64_t held = 0;
    for (std::size_t place = 0; place < map_->size(); ++place) {
      const std::string& name = map_->at(place).name;
      start_shard(name, {tiles});
      held += connect_to_shard(name).status()->static_triangles;
    }
    whole_ = std::make_unique<Client>(connect());
    tiled_ = std::make_unique<Client>(connect("tiled"));
    sharded_ = std::make_unique<ShardedClient>(connect_sharded());
    const std::uint64_t all = whole_->status()->static_triangles;
    EXPECT_EQ(tiled_->status()->static_triangles, all);
    EXPECT_GE(held, all);
    EXPECT_LT(held, 3 * all) << "each holds about its part";
  }

  /// A ground that is one part and reaches through all shards, and small closed parts on it.
  std::string write_ground_and_blocks(std::mt19937_64& random) {
    constexpr int kCells = 24;
    std::ostringstream text;
    text.precision(17);
    text << "o ground\n";
    for (int i = 0; i <= kCells; ++i) {
      for (int k = 0; k <= kCells; ++k) {
        const double step_m = 2 * kReach_m / kCells;
        text << "v " << step_m * i - kReach_m << ' ' << step_m * k - kReach_m << ' ' << number(random, 1) << '\n';
      }
    }
    const auto corner = [](int i, int k) { return i * (kCells + 1) + k + 1; };
    for (int i = 0; i < kCells; ++i) {
      for (int k = 0; k < kCells; ++k) {
        text << "f " << corner(i, k) << ' ' << corner(i + 1, k) << ' ' << corner(i + 1, k + 1) << '\n';
        text << "f " << corner(i, k) << ' ' << corner(i + 1, k + 1) << ' ' << corner(i, k + 1) << '\n';
      }
    }
    for (int part = 0; part < 40; ++part) {
      const Vec3 center = vector(random, kReach_m);
      const double size_m = random() % 8 == 0 ? 6 : 0.7;
      text << "o block_" << part << '\n';
      for (int i = 0; i < 4; ++i) {
        const Vec3 point = center + vector(random, size_m);
        text << "v " << point.x() << ' ' << point.y() << ' ' << point.z() << '\n';
      }
      text << "f -4 -3 -2\nf -4 -2 -1\nf -4 -1 -3\nf -3 -1 -2\n";
    }
    return folder_.write("yard.obj", text.str());
  }

  std::string write_tiles_of(const std::string& file, std::mt19937_64& random) {
    engine::LoadReport report;
    const engine::Scene scene = engine::load_scene(file, {}, report);
    engine::TilingOptions options;
    options.most_triangles = 20 + random() % 300;
    if (random() % 2 == 0) options.size_m = std::exp2(std::uniform_real_distribution(0.0, 4.0)(random));
    const std::string path = folder_.path() + "/yard.ctiles";
    engine::HeldMeshSource mesh(scene.mesh);
    tile_count_ = engine::write_tiles(path, scene.name, "yard.obj", scene.parts, mesh, options).tiles;
    return path;
  }

  template <class Q>
  void expect_same(const std::vector<Q>& questions, const AskOptions& options) {
    const Result<Answers> from_whole = whole_->ask(questions, options);
    const Result<Answers> from_tiles = tiled_->ask(questions, options);
    const Result<Answers> from_shards = sharded_->ask(questions, options);
    ASSERT_TRUE(from_whole) << from_whole.error().message;
    ASSERT_TRUE(from_tiles) << from_tiles.error().message;
    ASSERT_TRUE(from_shards) << from_shards.error().message;
    for (std::size_t i = 0; i < questions.size(); ++i) {
      const Answer& whole = from_whole->answers[i];
      hit_count_ += whole.verdict == Verdict::hit ? 1 : 0;
      ++asked_count_;
      EXPECT_TRUE(are_equal(whole, from_tiles->answers[i]))
          << i << ": " << tiled_text_of(whole) << " but of the tiles " << tiled_text_of(from_tiles->answers[i]);
      const Answer& all = from_shards->answers[i];
      const bool is_same = options.mode == HitMode::any ? whole.verdict == all.verdict : are_equal(whole, all);
      EXPECT_TRUE(is_same) << i << ": " << tiled_text_of(whole) << " but of the shards " << tiled_text_of(all);
      if (HasFailure()) return;
    }
  }

  RayQuestion random_ray(std::mt19937_64& random) const {
    RayQuestion ray{.origin = vector(random, 1.3 * kReach_m), .direction = vector(random, 1)};
    if (random() % 4 == 0) ray.direction[2] = 0;
    if (ray.direction.isZero()) ray.direction = Vec3(0, 0, -1);
    if (random() % 3 == 0) ray.length_m = std::abs(number(random, 2 * kReach_m));
    return ray;
  }

  std::optional<shards::ShardMap> map_;
  std::unique_ptr<Client> whole_;
  std::unique_ptr<Client> tiled_;
  std::unique_ptr<ShardedClient> sharded_;
  std::size_t tile_count_ = 0;
  std::size_t asked_count_ = 0;
  std::size_t hit_count_ = 0;
};

std::size_t question_count() {
  const char* asked = std::getenv("COLLIDED_QUESTIONS");
  return asked != nullptr ? std::strtoull(asked, nullptr, 10) : 12'000;
}

TEST_F(TiledWorld, AnswersAreThoseOfTheWholeFile) {
  std::mt19937_64 random = oracle::seeded(281);
  ASSERT_NO_FATAL_FAILURE(start_all(random));
  constexpr HitMode kModes[] = {HitMode::closest, HitMode::closest, HitMode::all, HitMode::any, HitMode::verdict};
  while (asked_count_ < question_count() && !HasFailure()) {
    AskOptions options{.mode = kModes[random() % std::size(kModes)], .timeout = 60s};
    std::vector<RayQuestion> rays(500);
    for (RayQuestion& ray : rays) ray = random_ray(random);
    expect_same(rays, options);
    if (options.mode == HitMode::all) {
      AskOptions few = options;
      few.max_hits = static_cast<std::uint32_t>(1 + random() % 5);
      expect_same(rays, few);
    }
    std::vector<SphereQuestion> spheres(150);
    for (SphereQuestion& one : spheres)
      one = {.center = vector(random, kReach_m), .radius_m = std::abs(number(random, random() % 8 == 0 ? 9 : 1))};
    expect_same(spheres, options);
    std::vector<BoxQuestion> boxes(150);
    for (BoxQuestion& one : boxes)
      one = {.center = vector(random, kReach_m), .half_m = vector(random, 2).cwiseAbs(), .rotation = rotation(random)};
    expect_same(boxes, options);
    AskOptions nearest{.timeout = 60s};
    if (random() % 3 != 0) nearest.max_hits = static_cast<std::uint32_t>(1 + random() % 40);
    std::vector<NearQuestion> points(200);
    for (NearQuestion& one : points) {
      one = {.point = vector(random, 1.5 * kReach_m)};
      if (random() % 2 == 0) one.within_m = std::abs(number(random, 5));
    }
    expect_same(points, nearest);
  }
  EXPECT_GT(hit_count_, asked_count_ / 10);
  EXPECT_LT(hit_count_, asked_count_ - asked_count_ / 10);
  std::printf("%zu questions on %zu tiles: %zu hit, all the same\n", asked_count_, tile_count_, hit_count_);
}

/// What a watch tells of the cart and the ground, until so many of it has come or nothing comes any more.
template <class AnyWatch>
std::vector<std::string> told_by(AnyWatch& watch, std::size_t count) {
  std::vector<std::string> told;
  const auto until = std::chrono::steady_clock::now() + 30s;
  while (told.size() < count && std::chrono::steady_clock::now() < until) {
    const std::optional<Event> event = watch.next(200ms);
    if (!event || (event->a != "yard/ground" && event->b != "yard/ground")) continue;
    if (event->kind == EventKind::began) told.emplace_back("began");
    if (event->kind == EventKind::ended) told.emplace_back("ended");
  }
  return told;
}

// A ball of three metres rolls through the borders, of which the margin is half a metre: it parts from what one shard holds
// of the ground while it touches what another one holds.
TEST_F(TiledWorld, AContactWithAPartOfSeveralShardsIsOne) {
  std::mt19937_64 random = oracle::seeded(282);
  write_map(R"({"margin_m": 0.5, "shards": [
    {"name": "west", "low": [null, null, null], "high": [-3, null, null]},
    {"name": "middle", "low": [-3, null, null], "high": [3, null, null]},
    {"name": "east", "low": [3, null, null], "high": [null, null, null]}]})");
  const std::string tiles = write_tiles_of(write_ground_and_blocks(random), random);
  start({tiles, "--member", "whole"}, "whole");
  for (const char* shard : {"west", "middle", "east"}) start_shard(shard, {tiles});
  Client whole = connect();
  ShardedClient sharded = connect_sharded();
  Watch of_whole = watch(whole);
  Result<ShardedWatch> of_shards = sharded.watch();
  ASSERT_TRUE(of_shards) << of_shards.error().message;
  ASSERT_TRUE(test::eventually([&] { return of_shards->settled() > 0s; }));  // it watches all of them
  Result<Publisher> to_whole = whole.publish("driver", {.lease = 60s});
  Result<ShardedPublisher> to_shards = sharded.publish("driver", {.lease = 60s});
  ASSERT_TRUE(to_whole && to_shards);
  const ObjectOptions ball{.name = "ball", .shape = {SphereShape{.radius_m = 3}}, .pose = at(-8, 0, 9)};
  const Result<Publisher::Object> own = to_whole->add(ball);
  const auto shared = to_shards->add(ball);
  ASSERT_TRUE(own && shared);
  // High, down on the ground, along it through both borders, high again.
  std::vector<Vec3> path{{-8, 0, 9}, {-8, 0, 2}};
  for (double x = -7; x <= 8; x += 1) path.emplace_back(x, 0, 2);
  path.insert(path.end(), {{8, 0, 9}, {0, 0, 9}, {0, 0, 2}, {0, 0, 9}});
  auto now = std::chrono::system_clock::now().time_since_epoch();
  for (const Vec3& position : path) {
    std::this_thread::sleep_for(20ms);
    now += 20ms;
    const Pose pose = at(position.x(), position.y(), position.z());
    ASSERT_TRUE(to_whole->move(*own, pose) && to_shards->move(*shared, pose));
    ASSERT_TRUE(to_whole->flush(now));
    ASSERT_TRUE(to_shards->flush(now));
  }
  ASSERT_TRUE(to_whole->wait_applied(10s));
  ASSERT_TRUE(to_shards->wait_applied(10s));
  const std::vector<std::string> of_one = told_by(of_whole, 4);
  EXPECT_EQ(of_one, (std::vector<std::string>{"began", "ended", "began", "ended"}));
  EXPECT_EQ(told_by(*of_shards, 4), of_one);
}

TEST_F(TiledWorld, WhatAShardHoldsOfTheTilesIsSaid) {
  std::mt19937_64 random = oracle::seeded(283);
  write_map(R"({"margin_m": 0.5, "shards": [
    {"name": "west", "low": [null, null, null], "high": [-3, null, null]},
    {"name": "east", "low": [-3, null, null], "high": [null, null, null]}]})");
  const std::string scene = write_ground_and_blocks(random);
  engine::LoadReport report;
  const engine::Scene loaded = engine::load_scene(scene, {}, report);
  engine::HeldMeshSource mesh(loaded.mesh);
  const std::string tiles = folder_.path() + "/yard.ctiles";
  const std::size_t count =
      engine::write_tiles(tiles, loaded.name, "yard.obj", loaded.parts, mesh, {.most_triangles = 100}).tiles;
  testing_support::ChildProcess& server = start_shard("west", {tiles});
  EXPECT_NE(server.output().find(" of " + std::to_string(count) + " tiles read"), std::string::npos) << server.output();
  EXPECT_NE(server.output().find("shard 'west' holds "), std::string::npos) << server.output();
  Client west = connect_to_shard("west");
  // Of a pair, triangles that it lacks could be the nearest.
  int refused = 0;
  for (int part = 0; part < 40; ++part) {
    const std::string block = "yard/block_" + std::to_string(part);
    const Result<PairAnswer> pair = west.pair("yard/ground", block);
    const Result<ClearanceAnswer> clearance = west.clearance("yard/ground", {.to = block});
    ASSERT_FALSE(pair) << block;
    ASSERT_FALSE(clearance) << block;
    EXPECT_NE(clearance.error().message.find("this shard holds"), std::string::npos) << clearance.error().message;
    const bool is_here = pair.error().message.find("this shard holds") != std::string::npos;
    EXPECT_TRUE(is_here || pair.error().message.find("is not in the world") != std::string::npos)
        << pair.error().message;
    refused += is_here ? 1 : 0;
  }
  EXPECT_GT(refused, 0);
  const Result<std::string> plan = west.command("plan", "{}");
  ASSERT_TRUE(plan) << plan.error().message;
  const json said = json::parse(*plan).at("scenes").at(0).at("tiles");
  EXPECT_EQ(said.at("of"), count);
  EXPECT_LT(said.at("read"), count);
  EXPECT_EQ(said.at("triangles_of_file"), loaded.mesh.triangles.size());
  const Result<std::string> figures = west.command("figures", "{}");
  ASSERT_TRUE(figures) << figures.error().message;
  const json held = json::parse(*figures).at("tiles");
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].at("scene"), "yard");
  EXPECT_EQ(held[0].at("read"), said.at("read"));
  EXPECT_EQ(held[0].at("of"), count);
  EXPECT_GT(held[0].at("triangles"), 0);
  EXPECT_LT(held[0].at("triangles"), loaded.mesh.triangles.size());
  EXPECT_EQ(held[0].at("triangles_of_file"), loaded.mesh.triangles.size());
  const Result<std::string> ground = west.command("get", R"({"name": "yard/ground"})");
  ASSERT_TRUE(ground) << ground.error().message;
  EXPECT_NE(ground->find("\"triangles_of_part\":1152"), std::string::npos) << *ground;
}

}  // namespace
}  // namespace collided
