#include "server/service/options/options.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <unistd.h>

#include "server/service/questions/nearest_word.hpp"
#include "server/service/options/quantities.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::service {
namespace {

using Variables = std::map<std::string, std::string>;

std::optional<std::string> take_any(Options&, const Setting&, std::span<const std::string>) { return std::nullopt; }

ParsedOptions parse(const std::vector<std::string>& arguments, const Variables& variables = {},
                    const ApplyFleetSetting& fleet = take_any) {
  return parse_options(
      arguments,
      [&](const char* name) {
        const auto found = variables.find(name);
        return found == variables.end() ? nullptr : found->second.c_str();
      },
      fleet);
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
  const ParsedOptions parsed =
      parse({"a.obj", "b \"c\".ply", "--step", "2ms", "--peers", "h1,h2", "--log-json", "--fresh"});
  write(print_config(parsed));
  const ParsedOptions again = parse({"--config", path});
  EXPECT_EQ(again.options.scenes, (std::vector<std::string>{"a.obj", "b \"c\".ply"}));
  EXPECT_EQ(again.options.step_ns, 2'000'000);
  EXPECT_EQ(again.options.peers, (std::vector<std::string>{"h1", "h2"}));
  EXPECT_TRUE(again.options.log_json);
  EXPECT_TRUE(again.options.is_fresh);
  EXPECT_EQ(again.options.max_objects, 100'000U);
}

// A key of 200,000 parts ended the server: toml++ makes a table in a table of each.
TEST_F(OptionsFile, DeepKeysAreRefusedAndLongOnesCut) {
  const auto fault = [&](const std::string& text) {
    write(text);
    try {
      parse({"--config", path});
    } catch (const OptionsError& error) { return std::string(error.what()); }
    return std::string();
  };
  std::string deep = "a";
  for (int i = 0; i < 200'000; ++i) deep += ".a";
  EXPECT_EQ(fault("\n" + deep + " = 1"), path + " line 2: more than 64 dots in one word");
  EXPECT_EQ(fault("[" + deep + "]"), path + " line 1: more than 64 dots in one word");
  EXPECT_EQ(fault("x = {" + deep + " = 1}"), path + " line 1: more than 64 dots in one word");
  const std::string long_text(10'000, 'x');
  for (const std::string& text : {long_text + " = 1", "[" + long_text + "]", "[server]\n" + long_text + " = 1",
                                  "[dds]\ndomain = \"" + long_text + "\"", std::string(2 << 20, '\n')})
    EXPECT_TRUE(!fault(text).empty() && fault(text).size() < 400) << fault(text).substr(0, 500);
  EXPECT_EQ(fault("[dds]\npeers = [" + std::string(50, '\n') + "\"10.0.0.1\", \"10.0.0.2\"]\n"), "");
}

TEST(Options, NumbersAreNeverOptions) {
  try {
    parse({"--unit", "-.5"});
    FAIL();
  } catch (const OptionsError& error) { EXPECT_EQ(std::string(error.what()).substr(0, 23), "world.unit is '-.5'; al"); }
}

// Each word of the configuration lands in the one field that it is about, by flag and by variable.
TEST(Options, EverySettingSetsItsOwnFieldAndNoOther) {
  const Options plain = parse({}).options;
  struct Row {
    const char* key;
    const char* text;
    std::function<bool(const Options&)> is_set;
  };
  const Row rows[] = {
      {"server.namespace", "hall", [](const Options& o) { return o.name_space == "hall"; }},
      {"server.threads", "3", [](const Options& o) { return o.threads == 3; }},
      {"server.step_threads", "5", [](const Options& o) { return o.step_threads == 5; }},
      {"server.step", "2ms", [](const Options& o) { return o.step_ns == 2'000'000; }},
      {"server.state_dir", "/tmp/x", [](const Options& o) { return o.state_dir == "/tmp/x"; }},
      {"server.fresh", "true", [](const Options& o) { return o.is_fresh; }},
      {"world.scenes", "a.obj,b.obj",
       [](const Options& o) {
         return o.scenes == std::vector<std::string>{"a.obj", "b.obj"};
       }},
      {"world.unit", "mm", [](const Options& o) { return o.unit_m == 1e-3; }},
      {"world.up", "y", [](const Options& o) { return o.up == 'y'; }},
      {"world.mend", "2mm", [](const Options& o) { return o.mend_m == 2e-3; }},
      {"world.solid", "part*", [](const Options& o) { return o.solid == "part*"; }},
      {"world.solid_by", "winding", [](const Options& o) { return o.solid_by_winding; }},
      {"world.covers", "0,0,0:1,2,3", [](const Options& o) { return o.covers.size() == 1; }},
      {"world.max_objects", "11", [](const Options& o) { return o.max_objects == 11; }},
      {"world.max_intervals", "12", [](const Options& o) { return o.max_intervals == 12; }},
      {"world.max_contacts", "12", [](const Options& o) { return o.max_contacts == 12; }},
      {"world.forget_after", "7s", [](const Options& o) { return o.forget_after_ns == 7'000'000'000; }},
      {"world.clock_error", "3ms", [](const Options& o) { return o.clock_error_ns == 3'000'000; }},
      {"world.memory", "7s", [](const Options& o) { return o.memory_ns == 7'000'000'000; }},
      {"answer.error", "4mm", [](const Options& o) { return o.error_m == 4e-3; }},
      {"answer.audit", "1/7", [](const Options& o) { return o.audit_every == 7; }},
      {"answer.opinion", "fcl", [](const Options& o) { return o.asks_fcl; }},
      {"answer.deadline", "5ms", [](const Options& o) { return o.deadline_ns == 5'000'000; }},
      {"recorder.last", "10s", [](const Options& o) { return o.flight_recorder_ns == 10'000'000'000; }},
      {"dds.domain", "13", [](const Options& o) { return o.domain == 13; }},
      {"dds.interface", "eth7", [](const Options& o) { return o.interface == "eth7"; }},
      {"dds.keys", "keys/brain", [](const Options& o) { return o.keys == "keys/brain"; }},
      {"dds.peers", "h1,h2",
       [](const Options& o) {
         return o.peers == std::vector<std::string>{"h1", "h2"};
       }},
      {"log.level", "warn", [](const Options& o) { return o.log_level == "warn"; }},
      {"log.json", "true", [](const Options& o) { return o.log_json; }},
  };
  const auto of_fleet = std::ranges::count_if(settings(), [](const Setting& s) { return s.apply == nullptr; });
  EXPECT_EQ(std::size(rows) + of_fleet, settings().size()) << "a setting without a row here";
  for (const Row& row : rows) {
    const auto setting = std::find_if(settings().begin(), settings().end(),
                                      [&](const Setting& s) { return s.key == std::string(row.key); });
    ASSERT_NE(setting, settings().end()) << row.key;
    EXPECT_FALSE(row.is_set(plain)) << row.key;
    std::vector<ParsedOptions> given{parse({}, {{setting->variable, row.text}})};
    if (*setting->flag && *setting->value) given.push_back(parse({setting->flag, row.text}));
    for (const ParsedOptions& parsed : given) {
      for (const Row& other : rows)
        EXPECT_EQ(other.is_set(parsed.options), &other == &row) << other.key << " by " << row.key;
    }
  }
}

// tests/unit/fleet/fleet_options_test.cpp has what the fleet makes of them.
TEST(Options, TheFleetIsGivenItsSettingsAndMayRefuseThem) {
  for (const Setting& setting : settings()) {
    if (setting.apply != nullptr) continue;
    std::map<std::string, std::string> given;
    const auto note = [&](Options&, const Setting& of, std::span<const std::string> values) {
      given[of.key] = values[0];
      return std::optional<std::string>();
    };
    EXPECT_EQ(origin(parse({setting.flag, "text"}, {}, note), setting.key), "flag " + std::string(setting.flag));
    EXPECT_EQ(given.at(setting.key), "text");
    const Variables variables{{setting.variable, "word"}};
    EXPECT_EQ(origin(parse({}, variables, note), setting.key), "env " + std::string(setting.variable));
    EXPECT_EQ(given.at(setting.key), "word");
    given.erase(setting.key);
    for (const auto& [key, value] : given) EXPECT_NE(value, "word") << key;
    const auto refuse = [&](Options&, const Setting& of, std::span<const std::string>) {
      return of.key == std::string(setting.key) ? std::optional<std::string>("another") : std::nullopt;
    };
    EXPECT_THROW(parse({}, variables, refuse), OptionsError) << setting.key;
  }
}

TEST(Options, TheDefaultsAreThoseOfTheHelp) {
  const Options plain = parse({}).options;
  EXPECT_EQ(plain.deadline_ns, 0);
  EXPECT_EQ(plain.error_m, 0);
  EXPECT_EQ(plain.step_ns, 0);
  EXPECT_EQ(plain.audit_every, 0U);
  EXPECT_EQ(plain.flight_recorder_ns, 30'000'000'000);
  EXPECT_EQ(plain.max_contacts, 10'000'000U);
  EXPECT_EQ(plain.max_intervals, 64U);
  EXPECT_EQ(plain.interface, "lo");
  EXPECT_FALSE(plain.mend_m);
  EXPECT_EQ(plain.up, 0);
  EXPECT_EQ(parse({"--mend", "auto"}).options.mend_m, 0.0) << "as wide as the file shows";
  EXPECT_EQ(parse({"--audit", "1"}).options.audit_every, 1U);
  EXPECT_EQ(parse({"--flight-recorder", "off"}).options.flight_recorder_ns, 0);
}

// Both ends of what is allowed are allowed, what lies beyond is not.
TEST(Options, LimitsAreThoseThatTheRefusalNames) {
  const std::tuple<const char*, std::vector<const char*>, std::vector<const char*>> kRows[] = {
      {"--threads", {"0", "256"}, {"-1", "257"}},
      {"--step-threads", {"0", "256"}, {"-1", "257"}},
      {"--step", {"100us", "10s"}, {"99us", "11s", "0"}},
      {"--max-objects", {"1", "16000000"}, {"0", "16000001"}},
      {"--max-contacts", {"1", "100000000"}, {"0", "100000001"}},
      {"--max-intervals", {"1", "1000000"}, {"0", "1000001"}},
      {"--clock-error", {"0", "1ns", "500ms"}, {"-1ns", "501ms"}},
      {"--memory", {"off", "0", "1h"}, {"-1s", "3601s"}},
      {"--deadline", {"1ns", "none"}, {"0", "-1ms"}},
      {"--error", {"0", "1um"}, {"-1um"}},
      {"--audit", {"off", "1", "1/1", "1/9"}, {"0", "2", "1/0"}},
      {"--opinion", {"off", "fcl"}, {"bullet", ""}},
      {"--flight-recorder", {"off", "1s", "600s"}, {"999ms", "601s"}},
      {"--domain", {"0", "230"}, {"-1", "231"}},
  };
  EXPECT_FALSE(parse({"--fresh=false"}).options.is_fresh);
  EXPECT_THROW(parse({"--fresh=maybe"}), OptionsError);
  for (const auto& [flag, good, bad] : kRows) {
    for (const char* value : good) EXPECT_NO_THROW(parse({flag, value})) << flag << ' ' << value;
    for (const char* value : bad) EXPECT_THROW(parse({flag, value}), OptionsError) << flag << ' ' << value;
  }
}

TEST(Options, EverySettingRefusesNonsense) {
  for (const Setting& setting : settings()) {
    // Paths and names may be anything.
    const std::string_view key = setting.key;
    if (key == "world.scenes" || key == "world.solid" || key == "server.state_dir" || setting.apply == nullptr)
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
  for (const char* wrong :
       {"1,2,3", "0,0,0:1,1", "0,0,0:1,1,1,1", "0,0,0:-1,1,1", "0,0,nan:1,1,1", "0,0,0:1,1,1x", "0,0:0,1,1,1"}) {
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

/// By definition (Damerau 1964, each letter swapped at most once): the last letters are alike, changed, left out, put in or swapped.
std::size_t edits_by_definition(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const std::string_view a1 = a.substr(0, a.size() - 1), b1 = b.substr(0, b.size() - 1);
  std::size_t fewest = std::min({edits_by_definition(a1, b) + 1, edits_by_definition(a, b1) + 1,
                                 edits_by_definition(a1, b1) + (a.back() == b.back() ? 0 : 1)});
  const bool are_swapped = a.size() > 1 && b.size() > 1 && a.back() == b[b.size() - 2] && b.back() == a[a.size() - 2];
  if (are_swapped)
    fewest = std::min(fewest, edits_by_definition(a.substr(0, a.size() - 2), b.substr(0, b.size() - 2)) + 1);
  return fewest;
}

TEST(NearestWord, IsTheOneOfFewestEditsByDefinition) {
  std::mt19937_64 random = oracle::seeded(83);
  const auto word = [&](std::size_t least) {
    std::string letters(least + random() % 5, 'a');
    for (char& letter : letters) letter = static_cast<char>('a' + random() % 3);
    return letters;
  };
  for (int round = 0; round < 2'000; ++round) {
    const std::string typed = word(1);
    const std::vector<std::string> words{word(1), word(1), word(1)};
    std::string nearest;
    std::size_t fewest = std::max<std::size_t>(1, typed.size() / 3) + 1;
    for (const std::string& one : words) {
      const std::size_t edits = edits_by_definition(typed, one);
      if (edits >= fewest) continue;
      fewest = edits;
      nearest = one;
    }
    ASSERT_EQ(nearest_word(typed, words), nearest)
        << typed << " among " << words[0] << ", " << words[1] << ", " << words[2];
  }
}

}  // namespace
}  // namespace collided::engine::service
