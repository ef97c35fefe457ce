#include "client/view/metrics.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

namespace collided::view {
namespace {

ServerStatus busy_status() {
  ServerStatus status;
  status.name_space = "collided";
  status.version_text = "0.2.0";
  status.state = "ready";
  status.objects = 31;
  status.publishers = {{.name = "good", .applied_sequence = 1, .silent = std::chrono::milliseconds(250), .lost = false},
                       {.name = "b\"a\\d\n{name} 1", .applied_sequence = 2, .silent = {}, .lost = true}};
  return status;
}

Figures busy_figures() {
  Figures figures;
  figures.up_ns = 2'500'000'000;
  figures.steps = 12;
  figures.step_durations = {{900, 3}, {1'001, 4}, {2'000'000, 5}, {100'000'000'000, 1}};
  figures.stages = {{"take", 1'000}, {"test", 2'000}};
  figures.questions = {{.kind = "ray", .answered = 70, .durations = {{5'000, 7}}}};
  return figures;
}

/// Every sample line by its name with labels; fails on a line that Prometheus would refuse.
std::map<std::string, double> samples(const std::string& text) {
  static const std::regex kSample(
      R"re(([a-zA-Z_:][a-zA-Z0-9_:]*(?:\{(?:[a-zA-Z_][a-zA-Z0-9_]*="(?:[^"\\\n]|\\["\\n])*",?)*\})?) (-?[0-9.e+-]+))re");
  std::map<std::string, double> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch parts;
    if (line.starts_with("# HELP ") || line.starts_with("# TYPE ")) continue;
    if (!std::regex_match(line, parts, kSample)) {
      ADD_FAILURE() << "no sample: " << line;
      continue;
    }
    EXPECT_TRUE(found.emplace(parts[1], std::stod(parts[2])).second) << "twice: " << line;
  }
  return found;
}

TEST(MetricsTest, EveryLineIsASampleWhateverNamesHold) {
  const auto found = samples(metrics_text(busy_status(), busy_figures()));
  EXPECT_EQ(found.at("collided_up"), 1);
  EXPECT_EQ(found.at("collided_objects"), 31);
  EXPECT_EQ(found.at("collided_publisher_silent_seconds{publisher=\"good\"}"), 0.25);
  EXPECT_EQ(found.at("collided_publisher_lost{publisher=\"b\\\"a\\\\d\\n{name} 1\"}"), 1);
  EXPECT_EQ(found.at("collided_up_seconds"), 2.5);
  EXPECT_EQ(found.at("collided_questions_answered_total{kind=\"ray\"}"), 70);
}

TEST(MetricsTest, BucketsHoldWhatIsAtMostTheirLength) {
  const auto found = samples(metrics_text(busy_status(), busy_figures()));
  const auto bucket = [&](const std::string& le) {
    return found.at("collided_step_duration_seconds_bucket{le=\"" + le + "\"}");
  };
  EXPECT_EQ(bucket("1e-06"), 3);
  EXPECT_EQ(bucket("2e-06"), 7);
  EXPECT_EQ(bucket("0.001024"), 7);
  EXPECT_EQ(bucket("0.002048"), 12);
  EXPECT_EQ(bucket("+Inf"), 13);
  EXPECT_EQ(found.at("collided_step_duration_seconds_count"), 13);
  EXPECT_EQ(found.at("collided_message_duration_seconds_bucket{kind=\"ray\",le=\"8e-06\"}"), 7);
}

TEST(MetricsTest, ASilentServerIsDownAndNothingElseIsSaid) {
  const auto found = samples(metrics_text({}, busy_figures()));
  EXPECT_EQ(found, (std::map<std::string, double>{{"collided_up", 0}}));
}

TEST(MetricsTest, TheDashboardAsksOnlyForWhatIsThere) {
  std::ifstream file(COLLIDED_DASHBOARD);
  const nlohmann::json dashboard = nlohmann::json::parse(file);
  EXPECT_GE(dashboard.at("panels").size(), 8U);
  std::set<std::string> known;
  for (const auto& [name, value] : samples(metrics_text(busy_status(), busy_figures())))
    known.insert(name.substr(0, name.find('{')));
  const std::string text = dashboard.dump();
  static const std::regex kName("collided_[a-z_]+");
  int asked = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), kName), end; at != end; ++at, ++asked)
    EXPECT_TRUE(known.contains(at->str())) << at->str();
  EXPECT_GT(asked, 8);
}

}  // namespace
}  // namespace collided::view
