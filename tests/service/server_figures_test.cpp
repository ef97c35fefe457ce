#include <nlohmann/json.hpp>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using nlohmann::json;

class ServerFigures : public testing_support::ServerTest {
 protected:
  static json figures(Client& client) {
    const Result<std::string> answer = client.command("figures", "{}");
    EXPECT_TRUE(answer) << answer.error().message;
    return answer ? json::parse(*answer) : json::object();
  }
  static json asked(const json& figures, const std::string& kind) {
    for (const json& row : figures["questions"]) {
      if (row["kind"] == kind) return row;
    }
    return {};
  }
  static std::uint64_t count(const json& durations) {
    std::uint64_t all = 0;
    for (const json& step : durations) all += step[1].get<std::uint64_t>();
    return all;
  }
};

TEST_F(ServerFigures, CountEveryQuestionAndHowLongItTook) {
  start();
  Client client = connect();
  constexpr std::uint64_t kAlone = 20;
  for (std::uint64_t i = 0; i < kAlone; ++i)
    ASSERT_TRUE(client.ask(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}}));
  const std::vector<RayQuestion> batch(2'500, {.origin = {0, 0, 5}, .direction = {0, 0, -1}});
  ASSERT_TRUE(client.ask(std::span<const RayQuestion>(batch)));
  const json now = figures(client);
  EXPECT_EQ(asked(now, "ray")["answered"], kAlone + batch.size());
  // A batch comes in samples of 1,000.
  EXPECT_EQ(count(asked(now, "ray")["durations"]), kAlone + 3);
  EXPECT_EQ(asked(now, "box")["answered"], 0);
}

TEST_F(ServerFigures, SampleWhatOtherClientsAsk) {
  start();
  Client viewer = connect();
  Client robot = connect();
  const auto sampled = [&](const std::string& arguments) {
    const Result<std::string> answer = viewer.command("sampled", arguments);
    EXPECT_TRUE(answer) << answer.error().message;
    return answer ? json::parse(*answer) : json{{"questions", json::array()}};
  };
  ASSERT_TRUE(robot.ask(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}}));
  EXPECT_TRUE(sampled("{}")["questions"].empty()) << "nobody had asked for samples before";
  const auto ask_until_sampled = [&](auto&& question) {
    json told;
    const std::string since = sampled("{}")["since"].dump();
    EXPECT_TRUE(test::eventually([&] {
      EXPECT_TRUE(viewer.ask(RayQuestion{.origin = {9, 9, 9}, .direction = {0, 0, -1}}));
      EXPECT_TRUE(robot.ask(question));
      told = sampled("{\"since\":" + since + "}");
      return !told["questions"].empty();
    }));
    return told["questions"].empty() ? json() : told["questions"][0];
  };
  const json ray = ask_until_sampled(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}});
  EXPECT_EQ(ray["kind"], "ray");
  EXPECT_EQ(ray["origin"], json({0.0, 0.0, 5.0}));
  EXPECT_FALSE(ray.contains("length")) << "it is endless";
  EXPECT_EQ(ray["answer"], "hit");
  EXPECT_EQ(ray["object"], "warehouse/shelf_3/top");
  const Result<Answer> own = robot.ask(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}});
  ASSERT_TRUE(own);
  EXPECT_EQ(ray["distance"], own->hits.at(0).distance_m);
  EXPECT_EQ(ray["at"][2], own->hits.at(0).point.z());
  EXPECT_LT(ray["ago_ns"], 60'000'000'000);
  const json ball = ask_until_sampled(SphereQuestion{.center = {100, 0, 0}, .radius_m = 0.5});
  EXPECT_EQ(ball["radius"], 0.5);
  EXPECT_EQ(ball["answer"], "miss");
  EXPECT_FALSE(ball.contains("object"));
  const json box = ask_until_sampled(BoxQuestion{.center = {0, 0, 0}, .half_m = {1, 2, 3}});
  EXPECT_EQ(box["half"], json({1.0, 2.0, 3.0}));
  EXPECT_EQ(box["orientation"], json({1.0, 0.0, 0.0, 0.0}));
}

TEST_F(ServerFigures, SayHowLongTheServerIsUp) {
  const auto began = std::chrono::steady_clock::now();
  start({"--step", "5ms"});
  Client client = connect();
  const std::int64_t first = figures(client)["up_ns"];
  const json later = figures(client);
  EXPECT_GT(first, 0);
  EXPECT_GT(later["up_ns"].get<std::int64_t>(), first);
  EXPECT_LT(std::chrono::nanoseconds(later["up_ns"].get<std::int64_t>()), std::chrono::steady_clock::now() - began);
  EXPECT_EQ(later["step_period_ns"], 5'000'000);
}

TEST_F(ServerFigures, CountStampsThatWereTakenForOthers) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "cell");
  const Publisher::Object ball = add_ball(publisher, "ball", at(4, 4, 1));
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  for (const int later_ms : {0, 20, 10, 30, 3'600'000}) {
    ASSERT_TRUE(publisher.move(ball, at(4, 4, 1 + 1e-4 * (later_ms % 100))));
    ASSERT_TRUE(publisher.flush(now + std::chrono::milliseconds(later_ms)));
  }
  ASSERT_TRUE(publisher.wait_applied(std::chrono::seconds(5)));
  EXPECT_TRUE(test::eventually([&] {
    const json stamps = figures(client)["stamps"];
    return stamps == json{{"late", 1}, {"jumped", 1}, {"missing", 0}};
  })) << figures(client)["stamps"];
}

// Two balls that meet, two that their layers keep apart.
TEST_F(ServerFigures, CountPairsAndWhatFiltersSave) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "balls");
  const json before = figures(client);
  const auto add = [&](const std::string& name, double x, std::uint32_t layer) {
    return *publisher.add(
        {.name = name, .shape = {SphereShape{.radius_m = 0.5}}, .pose = at(x, 0, 50), .layers = layer, .mask = layer});
  };
  add("a", 0, 1);
  add("b", 0.1, 2);
  const auto c = add("c", 20, 1);
  add("d", 20.1, 1);
  constexpr std::uint64_t kMoves = 5;
  for (std::uint64_t i = 0; i < kMoves; ++i) {
    move(publisher, c, at(20 + 0.01 * static_cast<double>(i), 0, 50));
    ASSERT_TRUE(publisher.wait_applied(std::chrono::seconds(5)));
  }
  const json after = figures(client);
  EXPECT_GE(after["pairs"]["filtered"].get<std::uint64_t>(), 1U);
  EXPECT_GE(after["pairs"]["candidates"].get<std::uint64_t>(), kMoves);
  EXPECT_EQ(after["poses"]["applied"].get<std::uint64_t>() - before["poses"]["applied"].get<std::uint64_t>(), kMoves);
  const std::uint64_t steps = after["steps"].get<std::uint64_t>() - before["steps"].get<std::uint64_t>();
  EXPECT_GE(steps, kMoves);
  EXPECT_EQ(count(after["step_durations"]), after["steps"].get<std::uint64_t>());
  std::uint64_t staged_ns = 0;
  for (const json& stage : after["stages"]) staged_ns += stage["ns"].get<std::uint64_t>();
  EXPECT_GT(staged_ns, 0U);
  EXPECT_LT(staged_ns, after["up_ns"].get<std::uint64_t>()) << "the stages of one thread take no longer than it lives";
}

}  // namespace
}  // namespace collided
