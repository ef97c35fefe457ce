// What the server says on stderr, for people and for programs.
#include "server/service/runtime/log.hpp"

#include <gtest/gtest.h>
#include <spdlog/logger.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <algorithm>
#include <regex>
#include <sstream>

#include "server/service/runtime/dds_warnings.hpp"

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

TEST(ServiceLog, NoTextOfStrangersCommandsATerminal) {
  testing::internal::CaptureStderr();
  make_log("info", false)
      ->warn(
          "a\x1b]0;evil\x07 \x1b[31m \xC2\x9B"
          "2J \x7F b\tc\n  d é\nerror: e");
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_EQ(said.substr(said.find("a?")), "a?]0;evil? ?[31m ?2J ? b\tc\n  d é\n  error: e\n");
}

/// What DDS would have the server log.
std::string logged(const std::vector<std::pair<std::uint32_t, std::string>>& line_and_message) {
  testing::internal::CaptureStderr();
  DdsWarnings warnings(make_log("info", false));
  for (const auto& [line, message] : line_and_message) {
    dds_log_data_t data{};
    data.file = "q_receive.c";
    data.line = line;
    data.message = message.c_str();
    data.size = message.size();
    data.hdrsize = 35;  // of the header, which stands in front of the message
    warnings.take(data);
  }
  return testing::internal::GetCapturedStderr();
}

TEST(ServiceLog, AWarningOfDdsIsLoggedFromItsFirstLetterHoweverShortItIs) {
  for (const char* message : {"x", "", "malformed packet received from vendor 1.16 state parse:HEARTBEAT"})
    EXPECT_NE(logged({{1, message}}).find(std::string("warning: DDS: ") + message + '\n'), std::string::npos)
        << message;
}

TEST(ServiceLog, AFloodOfWarningsOfOneKindIsAFewLinesAndHidesNoOther) {
  std::vector<std::pair<std::uint32_t, std::string>> all(100'000, {1, "malformed" + std::string(2'000, 'x')});
  all.insert(all.begin() + 50'000, {2, "another"});
  const std::string said = logged(all);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 8 + 13 + 1) << said;
  EXPECT_LT(said.size(), 12'000U);
  EXPECT_NE(said.find("... (65536 of this kind)"), std::string::npos) << said;
  EXPECT_NE(said.find("DDS: another\n"), std::string::npos) << said;
}

}  // namespace
}  // namespace collided::engine::service
