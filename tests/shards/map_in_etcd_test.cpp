// The shard map is in etcd: servers and clients read it there, and a split puts the next one in its place.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "collided/fleet.hpp"
#include "idl/etcd/etcd_address.hpp"
#include "idl/etcd/etcd_client.hpp"
#include "idl/shards/shard_map_store.hpp"
#include "tests/service/etcd_process.hpp"
#include "tests/service/eventually.hpp"
#include "tests/shards/sharded_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using shards::ShardMap;
using shards::ShardMapStore;
using testing_support::ChildProcess;
using testing_support::EtcdCluster;

constexpr const char* kHalvesInEtcd = R"({"margin_m": 1, "shards": [
  {"name": "west", "low": [null, null, null], "high": [0, null, null]},
  {"name": "east", "low": [0, null, null], "high": [null, null, null]}]})";
constexpr const char* kThirdsInEtcd = R"({"margin_m": 1, "shards": [
  {"name": "west", "low": [null, null, null], "high": [0, null, null]},
  {"name": "near", "low": [0, null, null], "high": [10, null, null]},
  {"name": "far", "low": [10, null, null], "high": [null, null, null]}]})";

class MapInEtcd : public testing_support::ShardedWorldTest {
 protected:
  void SetUp() override {
    if (!testing_support::has_etcd()) GTEST_SKIP() << "etcd-server is not installed";
    etcd_ = std::make_unique<EtcdCluster>(1, folder_.path());
    ASSERT_TRUE(etcd_->is_ready(30s)) << etcd_->member(0).output();
    map_file_ = etcd_->address() + "/plant/yard";
    store_ = std::make_unique<ShardMapStore>(map_file_, shards::MapAccess{.etcd_keys = {}, .patience = 5s});
    ASSERT_TRUE(store_->write(halves_, 0));
  }
  void stop_etcd() {
    etcd_->member(0).signal(SIGKILL);
    etcd_->member(0).wait(5s);
  }
  void put_next() {
    ASSERT_TRUE(ShardMapStore(map_file_ + "/next", {.etcd_keys = {}, .patience = 5s}).write(thirds_, 0));
  }
  /// A server that is not waited for.
  ChildProcess& begin(const std::string& shard, const std::string& source) {
    servers_.push_back(std::make_unique<ChildProcess>(
        std::vector<std::string>{COLLIDED_SERVER, "--domain", std::to_string(domain_), "--shard", source + ':' + shard,
                                 "--state-dir", folder_.path() + "/begun_" + shard},
        folder_.path(), "begun_" + shard));
    return *servers_.back();
  }
  Result<ShardSplitReport> split(ShardSplitOptions how = {}) {
    return split_shard(map_file_, "", {.domain = domain_, .wait = 2s}, how);
  }
  std::string first_hit(ShardedClient& client) {
    const Result<Answer> answer = client.ask(RayQuestion{.origin = {-50, 0, 0.1}, .direction = {1, 0, 0}});
    if (!answer) return answer.error().message;
    return answer->hits.empty() ? "nothing" : answer->hits[0].object;
  }

  const ShardMap halves_ = ShardMap::parse(kHalvesInEtcd);
  const ShardMap thirds_ = ShardMap::parse(kThirdsInEtcd);
  std::unique_ptr<EtcdCluster> etcd_;
  std::unique_ptr<ShardMapStore> store_;
};

TEST_F(MapInEtcd, ServersAndClientsReadItThereAndGoOnWithoutEtcd) {
  for (const char* shard : {"west", "east"}) start_shard(shard);
  ShardedClient client = connect_sharded();
  const std::string hit = first_hit(client);
  EXPECT_EQ(hit.find("warehouse/"), 0U) << hit;
  stop_etcd();
  EXPECT_EQ(first_hit(client), hit);
  for (const ShardState& shard : client.shards()) EXPECT_TRUE(shard.is_there) << shard.fault;
  const Result<ShardedClient> late = ShardedClient::connect(map_file_, {.domain = domain_, .wait = 1s});
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::no_server);
  EXPECT_EQ(late.error().message.find(map_file_ + ": etcd does not answer: 127.0.0.1:"), 0U) << late.error().message;
  ChildProcess& server = begin("west", map_file_);
  EXPECT_EQ(server.wait(20s), 3) << "another start may find etcd there";
  EXPECT_NE(server.errors().find("error: " + map_file_ + ": etcd does not answer: "), std::string::npos)
      << server.errors();
}

TEST_F(MapInEtcd, AServerSaysWhatIsWrongWithTheMapAndWithItsPlaceThere) {
  ChildProcess& stranger = begin("north", map_file_);
  EXPECT_EQ(stranger.wait(20s), 2);
  EXPECT_NE(stranger.errors().find(map_file_ + ": revision 2 has no shard 'north', nor has the map before it"),
            std::string::npos)
      << stranger.errors();
  const std::string none = etcd_->address() + "/plant/none";
  ChildProcess& lost = begin("west", none);
  EXPECT_EQ(lost.wait(20s), 2);
  EXPECT_NE(lost.errors().find(none + ": etcd has no such key"), std::string::npos) << lost.errors();
  etcd::EtcdClient raw(*etcd::parse_etcd_address(etcd_->address()), 5'000'000'000);
  static_cast<void>(raw.transact({.conditions = {}, .writes = {{"plant/yard", R"({"shards": []})"}}, .reads = {}}));
  ChildProcess& misled = begin("east", map_file_);
  EXPECT_EQ(misled.wait(20s), 2);
  EXPECT_NE(misled.errors().find("key 'plant/yard', revision 3: "), std::string::npos) << misled.errors();
  const Result<ShardedClient> client = ShardedClient::connect(map_file_, {.domain = domain_, .wait = 1s});
  ASSERT_FALSE(client);
  EXPECT_EQ(client.error().code, ErrorCode::bad_input);
  EXPECT_NE(client.error().message.find("key 'plant/yard', revision 3: "), std::string::npos) << client.error().message;
}

TEST_F(MapInEtcd, ASplitPutsTheNextMapInThePlaceOfTheOneBefore) {
  for (const char* shard : {"west", "east"}) start_shard(shard);
  ShardedClient client = connect_sharded();
  const std::string hit = first_hit(client);
  put_next();
  // They find their boxes in the map that does not hold yet.
  for (const char* shard : {"near", "far"}) start_shard(shard);
  const Result<ShardSplitReport> report = split();
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->into, (std::vector<std::string>{"near", "far"}));
  EXPECT_EQ(store_->read()->map.fingerprint(), thirds_.fingerprint());
  EXPECT_EQ(store_->read(ShardMapStore::Which::before)->map.fingerprint(), halves_.fingerprint());
  EXPECT_EQ(first_hit(client), hit);
  ShardedClient late = connect_sharded();
  EXPECT_EQ(late.shards().size(), 3U);
  EXPECT_EQ(first_hit(late), hit);
  // The server of the shard that was split finds its box in the map before, and that it holds nothing in its own journal.
  servers_[1]->signal(SIGKILL);
  servers_[1]->wait(5s);
  start_shard("east");
  EXPECT_TRUE(test::eventually([&] {
    const Result<Answer> answer = connect_to_shard("east").ask(SphereQuestion{.center = {20, 0, 9}, .radius_m = 1});
    return answer && answer->reason == UndecidedReason::not_covered;
  }));
  const Result<ShardSplitReport> again = split();
  EXPECT_TRUE(again) << again.error().message << ": what is done may be done again";
  const Result<ShardSplitReport> back = split({.undo = true});
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::refused);
}

TEST_F(MapInEtcd, WhereAnotherMapWasPutThereMeanwhileTheSplitIsTakenBack) {
  for (const char* shard : {"west", "east"}) start_shard(shard);
  put_next();
  for (const char* shard : {"near", "far"}) start_shard(shard);
  const ShardMap other = ShardMap::parse(R"({"shards": [{"name": "all", "low": [null, null, null],
    "high": [null, null, null]}]})");
  bool is_put = false;
  const Result<ShardSplitReport> report = split({.said = [&](const std::string&) {
    if (!is_put) is_put = store_->write(other, store_->revision()).has_value();
  }});
  EXPECT_TRUE(is_put);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::refused);
  EXPECT_NE(report.error().message.find("somebody has put another map there since. It was taken back"),
            std::string::npos)
      << report.error().message;
  EXPECT_EQ(store_->read()->map.fingerprint(), other.fingerprint());
}

// Until etcd has said that the next map holds, nobody goes by it; where it cannot be asked, the split waits to be gone on with.
TEST_F(MapInEtcd, WithoutEtcdASplitGoesNeitherOnNorBack) {
  for (const char* shard : {"west", "east"}) start_shard(shard);
  put_next();
  for (const char* shard : {"near", "far"}) start_shard(shard);
  ShardedClient client = connect_sharded();
  const std::string hit = first_hit(client);
  const Result<ShardSplitReport> report = split({.said = [&](const std::string&) { stop_etcd(); }});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::no_server);
  EXPECT_NE(report.error().message.find("Whether the next map is there is not known"), std::string::npos)
      << report.error().message;
  EXPECT_EQ(first_hit(client), hit);
  EXPECT_TRUE(test::eventually([&] { return client.shards().size() == 4; })) << "publishers still tell both";
}

// Its standby takes the place only once the lease is gone, after three seconds; what happens meanwhile is told then.
TEST_F(MapInEtcd, AWatchWaitsForAStandbyAsLongAsTheAuthorityDoes) {
  const std::vector<std::string> strict{"--authority", etcd_->address()};
  start_shard("west", strict);
  start_shard("east");
  servers_.push_back(std::make_unique<ChildProcess>(
      std::vector<std::string>{COLLIDED_SERVER, "--domain", std::to_string(domain_), "--standby-of", "collided",
                               "--shard", map_file_ + ":west", "--member", "west_2", "--state-dir",
                               folder_.path() + "/west_2", strict[0], strict[1]},
      folder_.path(), "west_2"));
  const auto said = [&] { return connect_to_shard("west").command("shard", "{}"); };
  ASSERT_TRUE(said());
  EXPECT_EQ(nlohmann::json::parse(*said())["replaced_within_ns"], 5'000'000'000);
  ShardedClient client = connect_sharded();
  Result<ShardedPublisher> publisher = client.publish("mover", {.lease = 60s});
  ASSERT_TRUE(publisher) << publisher.error().message;
  const auto ball = [](const char* name, double y) {
    return ObjectOptions{.name = name, .shape = {SphereShape{.radius_m = 0.1}}, .pose = {.position = {-30, y, 30}}};
  };
  const auto one = publisher->add(ball("one", 0));
  ASSERT_TRUE(one && publisher->add(ball("other", 5)) && publisher->flush());
  Result<ShardedWatch> watch = client.watch();
  ASSERT_TRUE(watch);
  ASSERT_TRUE(test::eventually([&] { return watch->settled() > 0s; }));
  ASSERT_TRUE(test::eventually(
      [&] {
        static_cast<void>(publisher->flush());
        const Result<Fleet> members = fleet({.domain = domain_, .name_space = "collided/shard_west"});
        return members && std::ranges::any_of(members->members, [](const FleetMember& member) {
                 return member.name == "west_2" && member.state == "ready" && member.hash_time != 0s;
               });
      },
      60s));
  servers_[0]->signal(SIGKILL);
  servers_[0]->wait(5s);
  // While nobody serves the shard they meet and part.
  for (const double y : {4.9, 0.0}) {
    ASSERT_TRUE(publisher->move(*one, {.position = {-30, y, 30}}));
    ASSERT_TRUE(publisher->flush());
  }
  std::vector<EventKind> kinds;
  EXPECT_TRUE(test::eventually(
      [&] {
        static_cast<void>(publisher->flush());
        while (const auto event = watch->next(10ms)) kinds.push_back(event->kind);
        return kinds.size() >= 2;
      },
      20s));
  EXPECT_EQ(kinds, (std::vector{EventKind::began, EventKind::ended}));
  EXPECT_EQ(watch->gaps(), 0U) << "nothing is missing";
}

}  // namespace
}  // namespace collided
