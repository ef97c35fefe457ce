#include "server/service/options.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <unistd.h>

#include "server/service/nearest_word.hpp"
#include "server/service/quantities.hpp"

namespace collided::service {
namespace {

using Variables = std::map<std::string, std::string>;

ParsedOptions parse(const std::vector<std::string>& arguments, const Variables& variables = {}) {
  return parse_options(arguments, [&](const char* name) {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : found->second.c_str();
  });
}

std::string origin(const ParsedOptions& parsed, const std::string& key) {
  for (const Effective& effective : parsed.effective) {
    if (effective.setting->key == key) return effective.origin;
  }
  return "no such key";
}

class OptionsFile : public ::testing::Test {
 protected:
  void write(const std::string& text) { std::ofstream(path) << text; }
  void TearDown() override { std::filesystem::remove(path); }
  const std::string path =
      (std::filesystem::temp_directory_path() / ("collided_options_" + std::to_string(getpid()) + ".toml")).string();
};

TEST_F(OptionsFile, FlagBeforeVariableBeforeFileBeforeDefault) {
  write("[server]\nthreads = 3\nstep = \"10ms\"\n[dds]\ndomain = 5\n");
  const Variables variables{{"COLLIDED_CONFIG", path}, {"COLLIDED_THREADS", "4"}, {"COLLIDED_DOMAIN", "6"}};
  const ParsedOptions parsed = parse({"--domain", "7"}, variables);
  EXPECT_EQ(parsed.options.domain, 7);
  EXPECT_EQ(origin(parsed, "dds.domain"), "flag --domain");
  EXPECT_EQ(parsed.options.threads, 4U);
  EXPECT_EQ(origin(parsed, "server.threads"), "env COLLIDED_THREADS");
  EXPECT_EQ(parsed.options.step_ns, 10'000'000);
  EXPECT_EQ(origin(parsed, "server.step"), path + ":3");
  EXPECT_EQ(parsed.options.name_space, "collided");
  EXPECT_EQ(origin(parsed, "server.namespace"), "default");
}

TEST_F(OptionsFile, TheRosDomainCountsAfterOurOwn) {
  EXPECT_EQ(parse({}, {{"ROS_DOMAIN_ID", "9"}}).options.domain, 9);
  EXPECT_EQ(parse({}, {{"ROS_DOMAIN_ID", "9"}, {"COLLIDED_DOMAIN", "8"}}).options.domain, 8);
  write("[dds]\ndomain = 5\n");
  EXPECT_EQ(parse({"--config", path}, {{"ROS_DOMAIN_ID", "9"}}).options.domain, 5);
}

// What is printed may be kept as a file: it means the same.
TEST_F(OptionsFile, ThePrintedConfigReadsBack) {
  const ParsedOptions parsed = parse({"a.obj", "b \"c\".ply", "--step", "2ms", "--peers", "h1,h2", "--log-json"});
  write(print_config(parsed));
  const ParsedOptions again = parse({"--config", path});
  EXPECT_EQ(again.options.scenes, (std::vector<std::string>{"a.obj", "b \"c\".ply"}));
  EXPECT_EQ(again.options.step_ns, 2'000'000);
  EXPECT_EQ(again.options.peers, (std::vector<std::string>{"h1", "h2"}));
  EXPECT_TRUE(again.options.log_json);
  EXPECT_EQ(again.options.max_objects, 100'000U);
}

TEST(Options, NumbersAreNeverOptions) {
  try {
    parse({"--unit", "-.5"});
    FAIL();
  } catch (const OptionsError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 23), "world.unit is '-.5'; al");
  }
}

TEST(Options, EverySettingRefusesNonsense) {
  for (const Setting& setting : settings()) {
    if (std::string_view(setting.key) == "world.scenes" || std::string_view(setting.key) == "server.state_dir")
      continue;
    EXPECT_THROW(parse({}, {{setting.variable, "<&>"}}), OptionsError) << setting.key;
  }
}

TEST(Options, CoversAreBoxes) {
  const Options options = parse({"--covers", "-1,0,0:1mm,2,3 -inf,-inf,0:inf,inf,inf"}).options;
  ASSERT_EQ(options.covers.size(), 2U);
  EXPECT_EQ(options.covers[0].low, Vec3(-1, 0, 0));
  EXPECT_EQ(options.covers[0].high, Vec3(1e-3, 2, 3));
  EXPECT_EQ(options.covers[1].high[0], HUGE_VAL);
  for (const char* wrong : {"1,2,3", "0,0,0:1,1", "0,0,0:1,1,1,1", "0,0,0:-1,1,1", "0,0,nan:1,1,1", "0,0,0:1,1,1x", "0,0:0,1,1,1"}) {
    EXPECT_THROW(parse({"--covers", wrong}), OptionsError) << wrong;
  }
}

TEST(Options, Quantities) {
  EXPECT_EQ(parse_duration_ns("1.5s"), 1'500'000'000);
  EXPECT_EQ(parse_duration_ns("200us"), 200'000);
  EXPECT_EQ(parse_duration_ns("0"), 0);
  EXPECT_FALSE(parse_duration_ns("5"));
  EXPECT_FALSE(parse_duration_ns("1e300s"));
  EXPECT_FALSE(parse_duration_ns("nan s"));
  EXPECT_EQ(parse_whole("100_000"), 100'000);
  EXPECT_FALSE(parse_whole("1.0"));
  EXPECT_FALSE(parse_whole("_1"));
  EXPECT_EQ(parse_unit_m("mm"), 1e-3);
  EXPECT_EQ(parse_unit_m("0.3048"), 0.3048);
  EXPECT_FALSE(parse_unit_m("-1"));
  EXPECT_FALSE(parse_unit_m("inf"));
  EXPECT_TRUE(is_number("-1e-300"));
  EXPECT_FALSE(is_number("-x"));
}

TEST(NearestWord, FindsSwapsAndLeavesStrangersAlone) {
  const std::vector<std::string> words{"threads", "step", "namespace"};
  EXPECT_EQ(nearest_word("thraeds", words), "threads");
  EXPECT_EQ(nearest_word("name_space", words), "namespace");
  EXPECT_EQ(nearest_word("colour", words), "");
  const std::vector<std::string_view> names{"pallet_07", "pallet_70", "wall", "pallet_8"};
  EXPECT_EQ(nearest_words("pallet7", names, 2), (std::vector<std::string>{"pallet_07", "pallet_70"}));
}

}  // namespace
}  // namespace collided::service
