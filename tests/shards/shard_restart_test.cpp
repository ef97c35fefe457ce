// A shard whose server is started again has missed what happened meanwhile; that its place was taken by a standby, which tells
// that, is in map_in_etcd_test.cpp.
#include <chrono>
#include <csignal>
#include <optional>

#include <gtest/gtest.h>

#include "collided/shards.hpp"
#include "tests/service/eventually.hpp"
#include "tests/shards/sharded_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ShardRestart : public testing_support::ShardedWorldTest {};

TEST_F(ShardRestart, AServerThatIsStartedAgainIsAGap) {
  write_map(R"({"margin_m": 2, "shards": [
      {"name": "west", "low": [null, null, null], "high": [0, null, null]},
      {"name": "east", "low": [0, null, null], "high": [null, null, null]}]})");
  start_shard("west");
  testing_support::ChildProcess& east = start_shard("east");
  ShardedClient client = connect_sharded();
  Result<ShardedWatch> watch = client.watch();
  ASSERT_TRUE(watch) << watch.error().message;
  ASSERT_TRUE(test::eventually([&] { return watch->settled() > 0s; }));
  EXPECT_EQ(watch->gaps(), 0U);
  east.signal(SIGKILL);
  east.wait(5s);
  start_shard("east");
  EXPECT_TRUE(test::eventually([&] { return watch->gaps() > 0; }, 20s));
}

}  // namespace
}  // namespace collided
