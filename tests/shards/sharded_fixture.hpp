#pragma once

#include <cstdint>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "collided/shards.hpp"
#include "idl/shards/shard_map.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided::testing_support {

/// The servers of a map's shards, and one server beside them that holds the whole world.
class ShardedWorldTest : public ServerTest {
 protected:
  static constexpr double kReach_m = 10;  // scenes fill the cube of this half length

  std::string write_map(const std::string& text, const std::string& name = "map.json") {
    return map_file_ = folder_.write(name, text);
  }
  ChildProcess& start_shard(const std::string& name, std::vector<std::string> options = {}) {
    options.insert(options.end(), {"--shard", map_file_ + ':' + name, "--member", name});
    return start(options, "shard_" + name);
  }
  Client connect_to_shard(const std::string& name) { return connect("collided/shard_" + name); }
  ShardedClient connect_sharded() {
    Result<ShardedClient> client = ShardedClient::connect(map_file_, {.domain = domain_, .wait = seconds(10)});
    EXPECT_TRUE(client) << client.error().message;
    return std::move(*client);
  }

  /// A number on a grid of eighths now and then, so that things touch and lie on borders.
  static double number(std::mt19937_64& random, double reach_m) {
    const double any = std::uniform_real_distribution(-reach_m, reach_m)(random);
    return random() % 4 == 0 ? std::round(any * 8) / 8 : any;
  }
  static Vec3 vector(std::mt19937_64& random, double reach_m) {
    return {number(random, reach_m), number(random, reach_m), number(random, reach_m)};
  }
  static Quat rotation(std::mt19937_64& random) {
    if (random() % 3 == 0) return Quat::Identity();
    std::normal_distribution<double> normal;
    return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
  }

  /// A map of so many shards, split at random planes.
  static std::string random_map(std::mt19937_64& random, std::size_t count, double margin_m);
  /// A scene file of small closed meshes and single triangles, each a part.
  std::string write_random_scene(std::mt19937_64& random, int count);

  std::string map_file_;
};

}  // namespace collided::testing_support
