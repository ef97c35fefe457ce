// Files that clients send: pieces, checksums, one commit, a process that may do nothing else, and what a crash leaves.
#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <random>

#include <nlohmann/json.hpp>

#include "tests/oracle/seed.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided::testing_support {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

class ServerUploads : public ServerTest {
 protected:
  static std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }
  /// A tent of so many triangles over each of a row of squares; more than one piece where there are many.
  static std::string tents(int count) {
    std::string text = "o tents\n";
    for (int i = 0; i < count; ++i) {
      const std::string x = std::to_string(50 + i);
      const std::string next = std::to_string(51 + i);
      text += "v " + x + " 0 0\nv " + next + " 0 0\nv " + x + ".5 1 0.25\nf -3 -2 -1\n";
    }
    return text;
  }
  static bool is_there(Client& client, double x) {
    return client.ask(RayQuestion{.origin = {x, 0.5, 5}, .direction = {0, 0, -1}, .length_m = 10})->verdict ==
           Verdict::hit;
  }
  static std::string refusal(Client& client, const std::string& command, const json& arguments) {
    const Result<std::string> answer = client.command(command, arguments.dump());
    return answer ? "done: " + *answer : answer.error().message;
  }
};

TEST_F(ServerUploads, AnUploadedSceneIsThatOfTheFile) {
  start();
  Client client = connect();
  const std::string text = tents(20'000);
  ASSERT_GT(text.size(), std::size_t{3} << 18) << "several pieces";
  const std::string path = folder_.write("named.obj", text);
  double told = 0;
  const Result<std::string> uploaded =
      client.upload(bytes_of(text), "sent.obj", R"({"name": "sent"})", 60s, [&](double fraction) { told = fraction; });
  ASSERT_TRUE(uploaded) << uploaded.error().message;
  EXPECT_EQ(json::parse(*uploaded)["triangles"], 20'000);
  EXPECT_GE(told, 0.5);
  std::mt19937_64 random = oracle::seeded(61);
  std::uniform_real_distribution<double> along(49, 20'052);
  std::vector<RayQuestion> rays(2'000);
  for (RayQuestion& ray : rays) ray = {.origin = {along(random), 0.7, 5}, .direction = {0.01, -0.1, -1}};
  const Result<Answers> sent = client.ask(rays);
  ASSERT_TRUE(client.command("clear", R"({"scene": "sent"})"));
  ASSERT_TRUE(client.command("load", json{{"path", path}, {"name", "sent"}}.dump(), {}, 60s));
  const Result<Answers> named = client.ask(rays);
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(sent->answers[i].verdict, named->answers[i].verdict);
    if (sent->answers[i].hits.empty()) continue;
    ++hits;
    ASSERT_EQ(sent->answers[i].hits[0].distance_m, named->answers[i].hits[0].distance_m);
    ASSERT_EQ(sent->answers[i].hits[0].triangle, named->answers[i].hits[0].triangle);
    ASSERT_EQ(sent->answers[i].hits[0].object, named->answers[i].hits[0].object);
  }
  EXPECT_GT(hits, 500);
}

TEST_F(ServerUploads, WhatDoesNotFitIsRefusedByName) {
  start();
  Client client = connect();
  const auto begin = [&](const json& arguments) { return refusal(client, "upload", arguments); };
  EXPECT_NE(begin({{"file", "../a.obj"}, {"bytes", 10}}).find("'../a.obj' has"), std::string::npos);
  EXPECT_NE(begin({{"file", ".obj"}, {"bytes", 10}}).find("a dot in front"), std::string::npos);
  EXPECT_NE(begin({{"file", "a.obj"}, {"bytes", 0}}).find("allowed: 1 to 1073741824"), std::string::npos);
  EXPECT_NE(begin({{"file", "a.obj"}, {"bytes", 1 << 30}, {"checksum", 1}, {"x", 1}}).find("x"), std::string::npos);
  EXPECT_NE(begin({{"file", "a.obj"}, {"bytes", (1LL << 30) + 1}}).find("Nothing was taken"), std::string::npos);
  EXPECT_NE(refusal(client, "load", {{"upload", 7}}).find("none of that number"), std::string::npos);
  EXPECT_NE(refusal(client, "piece", {{"upload", 7}, {"first", 0}}).find("none of that number"), std::string::npos);
  const Result<std::string> begun = client.command("upload", R"({"file": "a.obj", "bytes": 300000, "checksum": 5})");
  ASSERT_TRUE(begun);
  const json number = json::parse(*begun)["upload"];
  EXPECT_NE(refusal(client, "piece", {{"upload", number}, {"first", 0}}).find("a piece of 0 bytes at 0"),
            std::string::npos);
  EXPECT_NE(refusal(client, "piece", {{"upload", number}, {"frist", 0}})
                .find("unknown argument 'frist'; did you mean 'first'?"),
            std::string::npos);
  EXPECT_NE(refusal(client, "load", {{"upload", number}}).find("2 pieces of 2 are missing. Nothing was loaded"),
            std::string::npos);
  Client other = connect();
  EXPECT_NE(refusal(other, "load", {{"upload", number}}).find("none of that number"), std::string::npos)
      << "of another client";
  const Result<std::string> bad = client.upload(bytes_of("v 0 0 0\nf 1 2 3\n"), "bad.obj");
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().message, "server refused: bad.obj: line 2: vertex number 2 of 1. Nothing was loaded.");
  const Result<std::string> unknown = client.upload(bytes_of("what is this"), "thing.xyzzy");
  EXPECT_FALSE(unknown);
  EXPECT_TRUE(client.ask(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}})) << "the server serves on";
}

TEST_F(ServerUploads, OnlySoManyAreUnderWay) {
  start();
  Client client = connect();
  int begun = 0;
  for (int i = 0; i < 12; ++i)
    begun += client.command("upload", R"({"file": "a.obj", "bytes": 10, "checksum": 5})") ? 1 : 0;
  EXPECT_EQ(begun, 8);
}

// The sender's file is gone and the sender too; the server has what it needs.
TEST_F(ServerUploads, ACrashAndAStopLoseNone) {
  ChildProcess& first = start({}, "first");
  {
    Client client = connect();
    ASSERT_TRUE(client.upload(bytes_of(tents(3)), "kept.obj"));
    ASSERT_TRUE(client.upload(bytes_of("v 80 0 0\nv 81 0 0\nv 80 1 0\nf 1 2 3\n"), "cleared.obj"));
    ASSERT_TRUE(client.command("clear", R"({"scene": "cleared"})"));
    EXPECT_TRUE(is_there(client, 50.5));
  }
  first.signal(SIGKILL);
  first.wait(5s);
  ChildProcess& second = start({}, "second");
  {
    Client client = connect();
    const auto until = std::chrono::steady_clock::now() + 15s;
    while (std::chrono::steady_clock::now() < until && !(client.status() && client.status()->state == "ready"))
      std::this_thread::sleep_for(20ms);
    EXPECT_TRUE(is_there(client, 50.5));
    EXPECT_FALSE(is_there(client, 80.2));
  }
  second.signal(SIGTERM);
  EXPECT_EQ(second.wait(10s), 0);
  ChildProcess& third = start({}, "third");
  {
    Client client = connect();
    EXPECT_TRUE(test::eventually([&] { return is_there(client, 50.5); }, 15s)) << "a stop loses none either";
  }
  third.signal(SIGTERM);
  EXPECT_EQ(third.wait(10s), 0);
  start({"--fresh"}, "fourth");
  Client client = connect();
  EXPECT_FALSE(is_there(client, 50.5));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
    EXPECT_NE(entry.path().filename(), "kept.obj") << "what nothing needs is removed";
}

// Another scene has taken its name at one start: it is told as missing, and is there once the name is free again.
TEST_F(ServerUploads, WhatCannotBeLoadedAtOneStartIsKeptForTheNext) {
  start({}, "first");
  {
    Client client = connect();
    ASSERT_TRUE(client.upload(bytes_of(tents(3)), "hall.obj"));
  }
  const auto kill = [&] {
    servers_.back()->signal(SIGKILL);
    servers_.back()->wait(5s);
  };
  const auto state_is = [](Client& client, const std::string& state) {
    return test::eventually([&] { return client.status() && client.status()->state == state; }, 15s);
  };
  kill();
  start({folder_.write("hall.obj", "v 80 0 0\nv 81 0 0\nv 80 1 0\nf 1 2 3\n")}, "second");
  {
    Client client = connect();
    const auto losses = [&] { return json::parse(*client.command("accept_loss", R"({"show": true})"))["losses"]; };
    ASSERT_TRUE(test::eventually([&] { return !losses().empty(); }, 15s));
    EXPECT_NE(losses()[0].get<std::string>().find("is loaded already"), std::string::npos) << losses();
    EXPECT_FALSE(is_there(client, 50.5));
  }
  kill();
  start({}, "third");
  Client client = connect();
  ASSERT_TRUE(state_is(client, "ready"));
  EXPECT_TRUE(is_there(client, 50.5));
}

}  // namespace
}  // namespace collided::testing_support
