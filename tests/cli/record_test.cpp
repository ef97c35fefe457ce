#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "idl/answers/standing.hpp"
#include "idl/described_json.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class Record : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }
};
using Replay = Record;
using Doctor = Record;

TEST_F(Record, SaysWhatWasRecordedAndWhatWasLost) {
  fake::server().recording = {.channels = {{"object", 2, 0}, {"pose", 1'201, 3}, {"probe", 0, 0}},
                              .samples = 1'203,
                              .lost = 3,
                              .unanswered = 2,
                              .bytes = 260'117,
                              .no_opening = "the server keeps no flight recorder",
                              .problem = ""};
  const Ran ran = at_terminal("record run.mcap --for 10ms");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "TOPIC   SAMPLES  LOST\nobject  2        0\npose    1 201    3\n");
  EXPECT_NE(ran.err.find("run.mcap: 1 203 samples in "), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find(", 260 kB, 3 lost\n2 questions without an answer\nwhat was in the world before is not in it: "
                         "the server keeps no flight recorder\n"),
            std::string::npos)
      << ran.err;
  EXPECT_EQ(fake::server().recorded_to, "run.mcap");
  EXPECT_EQ(collide("record run.mcap --for 10ms --json").out,
            "{\"file\":\"run.mcap\",\"topic\":\"object\",\"samples\":2,\"lost\":0}\n"
            "{\"file\":\"run.mcap\",\"topic\":\"pose\",\"samples\":1201,\"lost\":3}\n"
            "{\"file\":\"run.mcap\",\"topic\":\"probe\",\"samples\":0,\"lost\":0}\n");
}

// What regions hold and where they are is asked and written beside the topics, once there are any.
TEST_F(Record, StandingQuestionsAreWrittenAsTheyAreDrawn) {
  OutlinedStanding zone;
  zone.name = "zone";
  zone.kind = "sphere";
  zone.to = "person";
  zone.only = "robot*";
  zone.lines = {{0, 0, 0, 1, 0, 0}};
  fake::server().command = [&](const std::string& name, const nlohmann::json&, const Shape&) -> Result<std::string> {
    if (name == "get") return std::string(R"({"pose":[5,0,0,1,0,0,0]})");
    return nlohmann::json{{"standing", json_of(std::vector{zone})}}.dump();
  };
  EXPECT_EQ(collide("record run.mcap --for 10ms").code, 0);
  const auto& written = fake::server().own_messages;
  ASSERT_EQ(written.size(), 2U);
  EXPECT_EQ(written[0].first, "collided/standing");
  const nlohmann::json listed = nlohmann::json::parse(written[0].second)["standing"][0];
  EXPECT_EQ(listed["to"], "person");
  EXPECT_EQ(listed["only"], "robot*");
  EXPECT_EQ(listed["lines"], nlohmann::json::parse("[[0,0,0,1,0,0]]")) << "in its carrier's frame";
  EXPECT_EQ(written[1].first, "/fences");
  const nlohmann::json drawn = nlohmann::json::parse(written[1].second)["entities"][0];
  EXPECT_EQ(drawn["frame_id"], "world");
  EXPECT_EQ(drawn["lines"][0]["points"][1], nlohmann::json::parse(R"({"x":6.0,"y":0.0,"z":0.0})"));

  fake::reset();
  fake::server().command = [](const std::string&, const nlohmann::json&, const Shape&) -> Result<std::string> {
    return std::string(R"({"standing":[]})");
  };
  EXPECT_EQ(collide("record run.mcap --for 10ms").code, 0);
  EXPECT_TRUE(fake::server().own_messages.empty());
}

TEST_F(Record, AFullDiskEndsIt) {
  fake::server().recording.problem = "run.mcap: No space left on device";
  fake::server().recording_error = Error{ErrorCode::refused, "recording stopped: run.mcap: No space left on device",
                                         "what was written before can be read: 7 samples"};
  const Ran ran = collide("record run.mcap");
  EXPECT_EQ(ran.code, 5);
  EXPECT_EQ(ran.err,
            "error: recording stopped: run.mcap: No space left on device\n       what was written before can be read: "
            "7 samples\n");
}

TEST_F(Record, TheLastSecondsAreFetched) {
  EXPECT_EQ(at_terminal("record crash.mcap --last 30s").out, "crash.mcap: the last 30 s, 1.2 MB\n");
  EXPECT_EQ(fake::server().fetched, std::chrono::seconds(30));
  EXPECT_EQ(collide("record a.mcap --last 30s --for 1s").code, 2);
  EXPECT_EQ(collide("record").code, 2);
}

TEST_F(Record, ASnapshotSaysWhatItDoesNotHold) {
  fake::server().listed_standing.resize(2);
  const Ran ran = at_terminal("snapshot now.cscene");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "wrote now.cscene: 25 parts, 1 object, 300 triangles, 2.3 MB (world 38)\n"
            "  not carried over: 48 velocities\n"
            "  not carried over: 2 standing questions\n");
  EXPECT_EQ(fake::server().recorded_to, "now.cscene");
  EXPECT_EQ(collide("snapshot now.cscene --fields file,not_carried_over").out,
            "now.cscene\t[\"48 velocities\",\"2 standing questions\"]\n");
  EXPECT_EQ(collide("snapshot now.glb").code, 2);
  EXPECT_EQ(collide("snapshot").code, 2);
}

TEST_F(Replay, SaysWhatWasPublished) {
  ReplayReport report;
  report.samples = 18'412;
  report.standing = 2;
  report.warnings = {"scene 'hall' was loaded then and is not now"};
  fake::server().replays = {report};
  const Ran ran = at_terminal("replay run.mcap --rate 0.5");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "replayed 18 412 samples, 2 standing questions made again\n");
  EXPECT_EQ(ran.err, "warning: scene 'hall' was loaded then and is not now\n");
  EXPECT_EQ(fake::server().replayed_with.rate, 0.5);
  EXPECT_FALSE(fake::server().replayed_with.ask);
}

TEST_F(Replay, EqualAnswersAreAYesAndOthersANo) {
  ReplayReport report;
  report.samples = 18'412;
  report.commands = 2;
  report.questions = report.equal = 7'004;
  fake::server().replays = {report};
  const Ran equal = at_terminal("replay run.mcap --ask");
  EXPECT_EQ(equal.code, 0);
  EXPECT_EQ(equal.out, "replayed 18 412 samples and 2 commands, 7 004 questions: 7 004 equal\n");
  report.equal = 7'003;
  report.differences = {"version 9, ray 0: then hit crate 3.8, now miss"};
  fake::server().replays = {report};
  const Ran other = at_terminal("replay run.mcap --ask");
  EXPECT_EQ(other.code, 1);
  EXPECT_EQ(other.out,
            "replayed 18 412 samples and 2 commands, 7 004 questions: 7 003 equal\n  version 9, ray 0: then hit crate "
            "3.8, now miss\n");
  EXPECT_EQ(
      collide("replay run.mcap --ask --json --fields questions,equal,differences").out,
      "{\"questions\":7004,\"equal\":7003,\"differences\":[\"version 9, ray 0: then hit crate 3.8, now miss\"]}\n");
}

TEST_F(Replay, NothingComparedIsUndecided) {
  ReplayReport report;
  report.not_compared = 12;
  report.why_not_compared = {"12 asked of a state that the recording does not describe"};
  fake::server().replays = {report};
  const Ran ran = at_terminal("replay run.mcap --ask");
  EXPECT_EQ(ran.code, 3);
  EXPECT_EQ(ran.out,
            "replayed 0 samples, 0 questions: 0 equal\n  not compared: 12 asked of a state that the recording does not "
            "describe\n");
}

TEST_F(Replay, LoopsUntilItIsStopped) {
  ReplayReport once, last;
  once.samples = 1;
  last.samples = 2;
  last.stopped = true;
  fake::server().replays = {once, once, last};
  const Ran ran = collide("replay run.mcap --loop --fields samples");
  EXPECT_EQ(ran.code, 130);
  EXPECT_EQ(ran.out, "1\n1\n2\n");
}

TEST_F(Replay, PausedItWaitsForALine) {
  fake::server().replays = {ReplayReport{}};
  const Ran ran = collide("replay run.mcap --start-paused",
                          {.out_is_terminal = false, .err_is_terminal = false, .in = "\n", .environment = {}});
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.err, "paused; Enter begins\n");
}

TEST_F(Replay, WhatMakesNoSenseIsRefused) {
  EXPECT_EQ(collide("replay").code, 2);
  EXPECT_EQ(collide("replay run.mcap --ask --rate 2").code, 2);
  EXPECT_EQ(collide("replay run.mcap --rate nan").code, 2);
  const Ran ran = collide("replay poses.csv");
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err, "error: replay: poses.csv: is no MCAP file. Nothing was replayed\n");
}

TEST_F(Doctor, EachLineHasItsRemedy) {
  fake::server().findings = {{Health::ok, "server", "server found in 12 ms (pid 4711)", ""},
                             {Health::warn, "buffer", "receive buffer up to 212992 B; bursts above 1774 poses may drop",
                              "sysctl -w net.core.rmem_max=8388608"}};
  const Ran ran = at_terminal("doctor");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "ok    server found in 12 ms (pid 4711)\n"
            "warn  receive buffer up to 212992 B; bursts above 1774 poses may drop\n"
            "        sysctl -w net.core.rmem_max=8388608\n");
  EXPECT_EQ(collide("doctor --json --fields health,about").out,
            "{\"health\":\"ok\",\"about\":\"server\"}\n{\"health\":\"warn\",\"about\":\"buffer\"}\n");
}

TEST_F(Doctor, AFailureIsANoAndNoServerIsNoServer) {
  fake::server().findings = {{Health::fail, "server",
                              "2 servers share namespace 'collided' (pid 4711, 5120): answers may differ",
                              "stop all but one"}};
  EXPECT_EQ(collide("doctor").code, 1);
  fake::server().findings = {
      {Health::fail, "interface", "this machine has no interface 'eth7'", "--interface one of: lo"},
      {Health::fail, "server", "no collided answered in 2 s on domain 0, namespace 'collided'", "start a server"}};
  EXPECT_EQ(collide("doctor").code, 4);
}

}  // namespace
}  // namespace collided
