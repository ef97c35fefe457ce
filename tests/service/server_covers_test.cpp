// What a server says of space that its geometry does not cover.
#include <nlohmann/json.hpp>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

class ServerCovers : public testing_support::ServerTest {
 protected:
  std::string write_roof() { return folder_.write("roof.obj", "v -9 -9 6\nv 9 -9 6\nv 9 9 6\nv -9 9 6\nf 1 2 3 4\n"); }
  static json command(Client& client, const std::string& name, const json& arguments) {
    const Result<std::string> answer = client.command(name, arguments.dump());
    EXPECT_TRUE(answer) << answer.error().message;
    return answer ? json::parse(*answer) : json::object();
  }
  static Answer ask(Client& client, const Vec3& origin, const Vec3& direction, double length_m) {
    const Result<Answer> answer =
        client.ask(RayQuestion{.origin = origin, .direction = direction, .length_m = length_m});
    EXPECT_TRUE(answer) << answer.error().message;
    return answer ? *answer : Answer{};
  }
};

TEST_F(ServerCovers, AMissThatLeavesThemIsUndecidedAndSaysWhere) {
  start({"--covers", "-20,-20,-1:20,20,8 100,0,0:110,1,1"});
  Client client = connect();
  EXPECT_EQ(ask(client, {15, 15, 5}, {0, 0, 1}, 3).verdict, Verdict::miss);
  const Answer up = ask(client, {15, 15, 5}, {0, 0, 2}, 4);
  EXPECT_EQ(up.verdict, Verdict::undecided);
  EXPECT_EQ(up.reason, UndecidedReason::not_covered);
  EXPECT_TRUE(up.hits.empty());
  ASSERT_TRUE(up.uncovered);
  EXPECT_NEAR(up.uncovered->covered_m, 3, 1e-9);
  EXPECT_LT((up.uncovered->point - Vec3(15, 15, 8)).norm(), 1e-9);
  const Answer beyond = ask(client, {0, 0, 15}, {0, 0, -1}, 100);
  EXPECT_EQ(beyond.reason, UndecidedReason::not_covered);
  ASSERT_EQ(beyond.hits.size(), 1U) << "what is known to be there is told";
  EXPECT_EQ(beyond.hits[0].object.substr(0, 10), "warehouse/");
  EXPECT_EQ(ask(client, {0, 0, 5}, {0, 0, -1}, 100).verdict, Verdict::hit);
  EXPECT_EQ(command(client, "covers", json::object())["covers"],
            json({{-20, -20, -1, 20, 20, 8}, {100, 0, 0, 110, 1, 1}}));
}

TEST_F(ServerCovers, ALoadedSceneStatesThemAndTakesThemAlong) {
  start();
  Client client = connect();
  EXPECT_EQ(ask(client, {15, 15, 5}, {0, 0, 1}, 50).verdict, Verdict::miss);
  EXPECT_TRUE(command(client, "covers", json::object())["covers"].is_null());
  const json box{-30, -30, -1, 30, 30, "inf"};
  EXPECT_EQ(command(client, "load", {{"path", write_roof()}, {"covers", {box}}})["covers"], json::array({box}));
  EXPECT_EQ(ask(client, {15, 15, 5}, {0, 0, 1}, 1e300).verdict, Verdict::miss);
  EXPECT_EQ(ask(client, {15, 15, 5}, {1, 0, 0}, 50).reason, UndecidedReason::not_covered);
  for (const json& wrong : {json{{1, 2, 3}}, json{{0, 0, 0, -1, 1, 1}}, json{{0, 0, 0, 1, 1, "far"}}, json("all")}) {
    const Result<std::string> refused =
        client.command("load", json{{"path", write_roof()}, {"name", "next"}, {"covers", wrong}}.dump());
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code, ErrorCode::refused);
  }
  command(client, "clear", {{"scene", "roof"}});
  EXPECT_EQ(command(client, "covers", json::object())["covers"], json::array());
  EXPECT_EQ(ask(client, {15, 15, 5}, {0, 0, 1}, 1).reason, UndecidedReason::not_covered);
}

// The scene that stated them is gone, and so is its server: that nothing is covered outlives both.
TEST_F(ServerCovers, ACrashDoesNotMakeMoreOfTheWorldKnown) {
  testing_support::ChildProcess& first = start({}, "first");
  Client client = connect();
  command(client, "load", {{"path", write_roof()}, {"covers", {{-30, -30, -1, 30, 30, 30}}}});
  command(client, "load", {{"path", write_roof()}, {"name", "other"}, {"covers", {{50, 50, 0, 60, 60, 9}}}});
  command(client, "clear", {{"scene", "roof"}});
  const auto become_ready = [](Client& asked) {
    const auto until = std::chrono::steady_clock::now() + 15s;
    const auto is_ready = [&] {
      const Result<ServerStatus> status = asked.status();
      return status && status->state == "ready";
    };
    while (!is_ready() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(20ms);
    EXPECT_TRUE(is_ready());
  };
  first.signal(SIGKILL);
  first.wait(5s);
  testing_support::ChildProcess& second = start({}, "second");
  Client other = connect();
  become_ready(other);
  EXPECT_EQ(command(other, "covers", json::object())["covers"], json({{50, 50, 0, 60, 60, 9}}));
  EXPECT_EQ(ask(other, {15, 15, 5}, {0, 0, 1}, 1).reason, UndecidedReason::not_covered);
  EXPECT_EQ(ask(other, {55, 55, 5}, {0, 0, 1}, 1).verdict, Verdict::miss);
  command(other, "clear", {{"scene", "other"}});
  second.signal(SIGKILL);
  second.wait(5s);
  start({}, "third");
  Client third = connect();
  become_ready(third);
  EXPECT_EQ(command(third, "covers", json::object())["covers"], json::array());
}

}  // namespace
}  // namespace collided
