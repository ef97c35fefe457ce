#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/oracle/seed.hpp"
#include "tests/service/server_fixture.hpp"

// The server works some of its answers out again, and says what that found and what each way of answering costs.
namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

class ServerAudit : public testing_support::ServerTest {
 protected:
  static json command(Client& client, const char* name, const json& arguments = json::object()) {
    const Result<std::string> answer = client.command(name, arguments.dump(), {}, 30s);
    EXPECT_TRUE(answer) << answer.error().message;
    return answer ? json::parse(*answer) : json::object();
  }
  /// Once the auditor has caught up.
  static json audit_when_done(Client& client) {
    json audit;
    for (int i = 0; i < 600; ++i) {
      audit = command(client, "audit");
      if (audit["audited"].get<int>() + audit["skipped"].get<int>() == audit["chosen"].get<int>()) break;
      std::this_thread::sleep_for(100ms);
    }
    return audit;
  }
  static Vec3 point(std::mt19937_64& random) {
    std::uniform_real_distribution<double> place(-6, 6);
    return {place(random), place(random), place(random)};
  }
};

TEST_F(ServerAudit, AMillionRaysAndNoneDiffers) {
  start({"--audit", "1/1000"});
  Client client = connect();
  std::mt19937_64 random = oracle::seeded(41);
  std::vector<RayQuestion> rays(100'000);
  for (int request = 0; request < 10; ++request) {
    for (RayQuestion& ray : rays) {
      ray.origin = point(random);
      ray.direction = point(random) - ray.origin;
    }
    const Result<Answers> answers = client.ask(std::span(rays), {.timeout = 60s});
    ASSERT_TRUE(answers) << answers.error().message;
  }
  // An answer is chosen once its reply has left.
  json audit;
  EXPECT_TRUE(test::eventually([&] { return (audit = audit_when_done(client))["chosen"] >= 1'000; }));
  EXPECT_EQ(audit["chosen"], 1'000);
  EXPECT_EQ(audit["audited"], 1'000) << audit;
  EXPECT_EQ(audit["differing"], 0) << audit["differences"];
  EXPECT_EQ(audit["questions"][0]["kind"], "ray");
  EXPECT_GT(audit["questions"][0]["double"], 990'000);
}

TEST_F(ServerAudit, EveryKindIsAudited) {
  start({"--audit", "1"});
  Client client = connect();
  Publisher publisher = publish(client, "mover");
  const Publisher::Object ball = add_ball(publisher, "ball", at(1, 1, 1));
  std::mt19937_64 random = oracle::seeded(42);
  for (int i = 0; i < 50; ++i) {
    const Vec3 p = point(random);
    move(publisher, ball, {.position = point(random)});
    ASSERT_TRUE(client.ask(SphereQuestion{.center = p, .radius_m = 1}));
    ASSERT_TRUE(client.ask(BoxQuestion{.center = p, .half_m = {1, 0.5, 0.2}}));
    ASSERT_TRUE(client.ask(NearQuestion{.point = p}, {.max_hits = 3}));
    ASSERT_TRUE(client.ask(NearQuestion{.point = p}, {.max_hits = 1, .error_m = 0.1}));
    ASSERT_TRUE(client.ask(RayQuestion{.origin = p, .direction = -p}, {.mode = HitMode::all}));
    audit_when_done(client);  // each round is a state of its own, and only a few are kept for auditing
  }
  json audit;
  EXPECT_TRUE(test::eventually([&] { return (audit = audit_when_done(client))["chosen"] >= 250; }));
  EXPECT_EQ(audit["chosen"], 250);
  EXPECT_EQ(audit["audited"], 250) << audit;
  EXPECT_EQ(audit["differing"], 0) << audit["differences"];
}

TEST_F(ServerAudit, AServerThatWasNotAskedToAuditsNothing) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.ask(RayQuestion{.origin = {0, 0, 4}, .direction = {0, 0, -1}}));
  const json audit = command(client, "audit");
  EXPECT_EQ(audit["every"], 0);
  EXPECT_EQ(audit["chosen"], 0);
}

TEST_F(ServerAudit, TheMenuPricesEveryKindOfQuestion) {
  start();
  Client client = connect();
  const json menu = command(client, "menu", {{"questions", 300}, {"seed", 5}});
  // Four kinds about places in five ways, the ways of a ball in three, and pairs of solids and of meshes in three.
  ASSERT_EQ(menu["rows"].size(), 4U * 5U + 3U * 3U);
  for (const json& row : menu["rows"]) {
    // The scene has few solids: pairs of them come up as seldom as they are there.
    if (row["kind"] != "pair") { EXPECT_EQ(row["asked"], 300) << row; }
    EXPECT_GT(row["judged"], 0) << row;
    if (row["method"] == "boxes only") continue;
    EXPECT_EQ(row["wrong"], 0) << row;
    EXPECT_LE(row["worst_error"], row["worst_bound"]) << row;
    if (row["method"] == "exact on doubt") { EXPECT_EQ(row["undecided"], 0) << row; }
  }
}

TEST_F(ServerAudit, AMenuEndsAtItsDeadline) {
  start();
  Client client = connect();
  const auto started = std::chrono::steady_clock::now();
  const json menu = command(client, "menu", {{"questions", 100'000}, {"seed", 5}, {"deadline_ns", 300'000'000}});
  EXPECT_LT(std::chrono::steady_clock::now() - started, 3s);
  EXPECT_TRUE(menu.value("late", false)) << menu;
  ASSERT_FALSE(menu["rows"].empty());
  EXPECT_LT(menu["rows"].back()["asked"], 100'000);
  EXPECT_FALSE(command(client, "menu", {{"questions", 10}, {"deadline_ns", 60'000'000'000}}).contains("late"));
  const json at_once = command(client, "menu", {{"questions", 10}, {"deadline_ns", 1}});
  EXPECT_TRUE(at_once.value("late", false)) << at_once;
}

// Whoever comes next would wait for it in vain: a load has its turn after a menu.
TEST_F(ServerAudit, AMenuEndsWhenItsClientHasGone) {
  start();
  Client client = connect();
  const std::string much = json{{"questions", 100'000}, {"seed", 5}}.dump();
  {
    Client gone = connect();
    EXPECT_FALSE(gone.command("menu", much, {}, 1s)) << "it takes longer than that";
  }
  const auto started = std::chrono::steady_clock::now();
  ASSERT_TRUE(client.load(folder_.write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")));
  const auto waited = std::chrono::steady_clock::now() - started;
  // The same with a client that stays takes longer than a load had to wait.
  EXPECT_LT(waited, 2s);
  EXPECT_TRUE(command(client, "menu", {{"questions", 100'000}, {"seed", 5}, {"deadline_ns", 3'000'000'000}})["late"]);
}

TEST_F(ServerAudit, TheMenuPricesYourOwnQuestions) {
  start();
  Client client = connect();
  const auto menu = [&](const char* arguments, const std::vector<double>& numbers) {
    return client.command_with_bytes("menu", arguments, std::as_bytes(std::span(numbers)), 30s);
  };
  std::vector<double> rays;
  for (int i = 0; i < 50; ++i) rays.insert(rays.end(), {0.1 * i, 0.05 * i, 4, 0.01, 0.02, -1, HUGE_VAL});
  const Result<std::string> answer = menu(R"({"of": "ray"})", rays);
  ASSERT_TRUE(answer) << answer.error().message;
  const json rows = json::parse(*answer)["rows"];
  ASSERT_EQ(rows.size(), 5U);
  for (const json& row : rows) {
    EXPECT_EQ(row["kind"], "ray");
    EXPECT_EQ(row["asked"], 50) << row;
    EXPECT_EQ(row["judged"], 50) << row;
  }
  EXPECT_EQ(rows[0]["wrong"], 0);
  const auto refusal = [&](const char* arguments, const std::vector<double>& numbers) {
    const Result<std::string> refused = menu(arguments, numbers);
    return refused ? "it was taken" : refused.error().message;
  };
  rays[8 * 7] = NAN;
  EXPECT_NE(refusal(R"({"of": "ray"})", rays).find("question 8 is no ray"), std::string::npos);
  EXPECT_NE(refusal(R"({"of": "ray"})", {1, 2, 3}).find("24 bytes of questions; 56 are needed for each ray"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"of": "near"})", {}).find("0 bytes of questions"), std::string::npos);
  EXPECT_NE(refusal(R"({"of": "sweep"})", rays).find("allowed: ray, sphere, box, near"), std::string::npos);
  EXPECT_NE(refusal(R"({"of": "near"})", std::vector<double>(4 * 10'001, 1.0)).find("10001 questions, allowed 10000"),
            std::string::npos);
}

#ifdef COLLIDED_FLUSH_DENORMALS
// A library that was built with -ffast-math has turned denormals off in the whole process: a ray through a scene of
// 1e-310 m would miss all of it.
TEST_F(ServerAudit, FloatingPointSettingsThatALibraryChangedAreSetBack) {
  servers_.push_back(std::make_unique<testing_support::ChildProcess>(
      std::vector<std::string>{"/usr/bin/env", "LD_PRELOAD=" COLLIDED_FLUSH_DENORMALS, COLLIDED_SERVER, "--domain",
                               std::to_string(domain_), "--state-dir", folder_.path()},
      folder_.path(), "server"));
  ASSERT_TRUE(servers_.back()->says("ready:", 20s)) << servers_.back()->errors();
  Client client = connect();
  Publisher publisher = publish(client, "dust");
  const double tiny = 1e-310;
  ASSERT_TRUE(publisher.add({.name = "grain", .shape = {SphereShape{.radius_m = tiny}}, .pose = at(100, 0, 0)}));
  ASSERT_TRUE(publisher.flush());
  const Result<Answer> answer =
      client.ask(SphereQuestion{.center = {100, 1.5 * tiny, 0}, .radius_m = tiny}, {.fresh = true});
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->verdict, Verdict::hit);
  const Result<Answer> summand = client.ask(SphereQuestion{.center = {100, 2.5 * tiny, 0}, .radius_m = tiny});
  ASSERT_TRUE(summand) << summand.error().message;
  EXPECT_EQ(summand->verdict, Verdict::miss);
  EXPECT_GT(command(client, "audit")["float_repairs"], 0);
}
#endif

}  // namespace
}  // namespace collided
