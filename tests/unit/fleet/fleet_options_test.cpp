#include "server/fleet/fleet_options.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <unistd.h>

namespace collided::engine::service {
namespace {

using Variables = std::map<std::string, std::string>;

struct Parsed {
  FleetOptions fleet;
  Options options;
};

Parsed parse(const std::vector<std::string>& arguments, const Variables& variables = {}) {
  Parsed parsed;
  parsed.options = parse_options(
                       arguments,
                       [&](const char* name) {
                         const auto found = variables.find(name);
                         return found == variables.end() ? nullptr : found->second.c_str();
                       },
                       [&](Options& options, const Setting& setting, std::span<const std::string> values) {
                         return apply_fleet_setting(parsed.fleet, options, setting, values);
                       })
                       .options;
  return parsed;
}

constexpr const char* kHalves = R"({"margin_m": 2, "shards": [
  {"name": "west", "low": [null, null, null], "high": [0, null, null]},
  {"name": "east", "low": [0, null, null], "high": [null, null, null]}]})";

class FleetSettingsFile : public ::testing::Test {
 protected:
  void write(const std::string& text) { std::ofstream(path) << text; }
  void TearDown() override { std::filesystem::remove(path); }
  const std::string path =
      (std::filesystem::temp_directory_path() / ("collided_fleet_options_" + std::to_string(getpid()) + ".json"))
          .string();
};

// Each word of the configuration lands in the one field that it is about, by flag and by variable.
TEST_F(FleetSettingsFile, EverySettingSetsItsOwnFieldAndNoOther) {
  write(kHalves);
  const std::string west = path + ":west";
  const Parsed plain = parse({});
  struct Row {
    const char* key;
    const char* text;
    std::function<bool(const Parsed&)> is_set;
  };
  const Row rows[] = {
      {"server.standby_of", "yard", [](const Parsed& p) { return p.fleet.standby_of == "yard"; }},
      {"server.join", "yard", [](const Parsed& p) { return p.fleet.joins && p.options.name_space == "yard"; }},
      {"server.replica_of", "yard",
       [](const Parsed& p) { return p.fleet.replica_of == "yard" && p.options.name_space == "yard"; }},
      {"server.etcd_keys", "/usr", [](const Parsed& p) { return p.fleet.etcd_keys == "/usr"; }},
      {"server.shard", west.c_str(),
       [](const Parsed& p) {
         return p.options.shard && p.options.shard->name == "west" && p.fleet.shard_map != 0 &&
                p.options.name_space == "collided/shard_west";
       }},
      {"server.take_over_after", "3s", [](const Parsed& p) { return p.fleet.take_over_ns == 3'000'000'000; }},
      {"server.authority", "etcd://a:1/k",
       [](const Parsed& p) { return p.fleet.authority && p.fleet.authority->key == "k"; }},
      {"server.authority_mode", "fast", [](const Parsed& p) { return p.fleet.authority_mode == TakeOverMode::fast; }},
      {"server.authority_lease", "5s", [](const Parsed& p) { return p.fleet.authority_lease_s == 5; }},
      {"server.member", "north-1", [](const Parsed& p) { return p.fleet.member == "north-1"; }},
  };
  EXPECT_EQ(static_cast<std::ptrdiff_t>(std::size(rows)),
            std::ranges::count_if(settings(), [](const Setting& s) { return s.apply == nullptr; }))
      << "a setting without a row here";
  for (const Row& row : rows) {
    const auto setting =
        std::ranges::find_if(settings(), [&](const Setting& s) { return s.key == std::string(row.key); });
    ASSERT_NE(setting, settings().end()) << row.key;
    EXPECT_FALSE(row.is_set(plain)) << row.key;
    for (const Parsed& parsed : {parse({}, {{setting->variable, row.text}}), parse({setting->flag, row.text})}) {
      for (const Row& other : rows) EXPECT_EQ(other.is_set(parsed), &other == &row) << other.key << " by " << row.key;
    }
  }
}

TEST(FleetSettings, EveryOneRefusesNonsense) {
  for (const Setting& setting : settings()) {
    if (setting.apply != nullptr) continue;
    EXPECT_THROW(parse({}, {{setting.variable, "<&>"}}), OptionsError) << setting.key;
  }
}

TEST(FleetSettings, AStandbyServesTheNamespaceThatItStandsByFor) {
  EXPECT_EQ(parse({"--standby-of", "hall"}).options.name_space, "hall");
  EXPECT_EQ(parse({"--namespace", "yard", "--standby-of", "hall"}).options.name_space, "hall");
  EXPECT_EQ(parse({"--namespace", "yard", "--standby-of", ""}).options.name_space, "yard");
  EXPECT_EQ(parse({"--join", "hall"}).options.name_space, "hall");
  EXPECT_FALSE(parse({"--join", ""}).fleet.joins);
  EXPECT_EQ(parse({"--take-over-after", "never"}).fleet.take_over_ns, 0);
  EXPECT_THROW(parse({"--take-over-after", "199ms"}), OptionsError);
  EXPECT_THROW(parse({"--standby-of", "hall", "--join", "hall"}), OptionsError);
  EXPECT_THROW(parse({"--standby-of", "hall", "--replica-of", "hall"}), OptionsError);
  EXPECT_THROW(parse({"--join", "hall", "--replica-of", "hall"}), OptionsError);
}

TEST_F(FleetSettingsFile, AShardServesItsOwnNamespaceAndHoldsItsBox) {
  write(kHalves);
  const std::string west = path + ":west";
  const Options alone = parse({"--shard", west, "--namespace", "yard"}).options;
  EXPECT_EQ(alone.name_space, "yard/shard_west");
  EXPECT_EQ(alone.shard->held.high.x(), std::nextafter(2.0, 3.0));
  EXPECT_TRUE(std::isinf(alone.shard->held.low.x()));
  const Parsed waiting = parse({"--shard", west, "--standby-of", "yard"});
  EXPECT_EQ(waiting.options.name_space, "yard/shard_west");
  EXPECT_EQ(waiting.fleet.standby_of, "yard/shard_west");
  EXPECT_EQ(parse({"--shard", west, "--join", "yard"}).options.name_space, "yard/shard_west");
  for (const std::vector<std::string>& bad : {std::vector<std::string>{"--shard", west, "--replica-of", "yard"},
                                              {"--shard", path + ":north"},
                                              {"--shard", path},
                                              {"--shard", path + ".none:west"},
                                              {"--shard", west, "--covers", "0,0,0:1,1,1"}})
    EXPECT_THROW(parse(bad), OptionsError) << bad[1];
  write("[]");
  EXPECT_THROW(parse({"--shard", west}), OptionsError);
}

// etcd is not asked before the server starts.
TEST(FleetSettings, AShardOfAMapInEtcdIsAnAddressWithAKeyAndAName) {
  const Parsed parsed = parse({"--shard", "etcd://a:1,[::1]:2/plant/yard:west", "--namespace", "yard"});
  const Options& options = parsed.options;
  EXPECT_EQ(parsed.fleet.shard_map_address, "etcd://a:1,[::1]:2/plant/yard");
  EXPECT_EQ(options.shard->name, "west");
  EXPECT_EQ(options.name_space, "yard/shard_west");
  for (const char* bad : {"etcd://a:1:west", "etcd://a:1/:west", "etcd://a/yard:west", "etcd://a:1/yard"})
    EXPECT_THROW(parse({"--shard", bad}), OptionsError) << bad;
}

TEST(FleetSettings, AnAuthorityIsAnAddressAndItsLeaseWholeSeconds) {
  EXPECT_FALSE(parse({}).fleet.authority);
  EXPECT_EQ(parse({}).fleet.authority_lease_s, 3);
  EXPECT_EQ(parse({"--authority", "etcd://a:1,b:2"}).fleet.authority->endpoints.size(), 2U);
  for (const std::vector<std::string>& bad : {std::vector<std::string>{"--authority", "http://a:1"},
                                              {"--authority-mode", "slow"},
                                              {"--authority-lease", "1s"},
                                              {"--authority-lease", "2500ms"},
                                              {"--authority-lease", "61s"}}) {
    EXPECT_THROW(parse(bad), OptionsError) << bad[1];
  }
}

}  // namespace
}  // namespace collided::engine::service
