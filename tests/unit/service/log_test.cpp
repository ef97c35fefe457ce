// What the server says on stderr, for people and for programs.
#include "server/service/runtime/log.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <algorithm>
#include <regex>
#include <sstream>

namespace collided::engine::service {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

TEST(ServiceLog, ForProgramsEachMessageIsOneLineOfJson) {
  testing::internal::CaptureStderr();
  const double before_s = now_s();
  const auto log = make_log("info", true);
  log->clone("other")->warn("é \"quoted\"\nsecond \xff line");
  log->debug("not said");
  const std::string said = testing::internal::GetCapturedStderr();
  ASSERT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_EQ(said.back(), '\n');
  const std::string::size_type comma = said.find(',');
  ASSERT_NE(comma, std::string::npos);
  EXPECT_EQ(said.substr(comma), ",\"level\":\"warning\",\"message\":\"é \\\"quoted\\\"\\nsecond \uFFFD line\"}\n");
  const double time_s = nlohmann::json::parse(said)["time"];
  EXPECT_GE(time_s, before_s - 1e-3);
  EXPECT_LE(time_s, now_s() + 1e-3);
}

TEST(ServiceLog, ForPeopleALineIsTimeLevelAndMessage) {
  testing::internal::CaptureStderr();
  make_log("info", false)->error("it's é");
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_TRUE(std::regex_match(said, std::regex("\\d\\d:\\d\\d:\\d\\d\\.\\d\\d\\d error: it's é\n"))) << said;
}

TEST(ServiceLog, ALevelSaysItselfAndWhatIsWorse) {
  const auto said_at = [](const std::string& level) {
    testing::internal::CaptureStderr();
    const auto log = make_log(level, true);
    log->debug("a");
    log->info("b");
    log->warn("c");
    log->error("d");
    std::string messages;
    std::istringstream lines(testing::internal::GetCapturedStderr());
    for (std::string line; std::getline(lines, line);) messages += nlohmann::json::parse(line)["message"];
    return messages;
  };
  EXPECT_EQ(said_at("debug"), "abcd");
  EXPECT_EQ(said_at("info"), "bcd");
  EXPECT_EQ(said_at("warning"), "cd");
  EXPECT_EQ(said_at("error"), "d");
}

}  // namespace
}  // namespace collided::engine::service
