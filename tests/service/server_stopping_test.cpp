// Whoever asks a server that is stopping hears so.
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/service/endurance/process_figures.hpp"
#include "tests/service/server_fixture.hpp"
#include "tests/service/shell_obj.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

using ServerStopping = testing_support::ServerTest;

void expect_ends_in_order(testing_support::ChildProcess& server) {
  const auto stopped = std::chrono::steady_clock::now();
  server.signal(SIGTERM);
  EXPECT_EQ(server.wait(20s), 0) << server.errors();
  EXPECT_LT(std::chrono::steady_clock::now() - stopped, 6s);
}

// A batch that would take a quarter of a minute is in work.
TEST_F(ServerStopping, DoesNotWaitForCostlyBatches) {
  testing_support::ChildProcess& server = start({"--threads", "1"});
  Client client = connect();
  ASSERT_TRUE(client.load(folder_.write("shell.obj", testing_support::shell_obj(150))));
  const std::vector<NearQuestion> middle(1'000, {.point = {50, 50, 50}});
  std::atomic<bool> is_over{false};
  std::string why;
  std::thread asking([&] {
    const Result<Answers> answers = client.ask(std::span<const NearQuestion>(middle), {.timeout = 60s});
    if (!answers) why = answers.error().message;
    is_over.store(true);
  });
  ASSERT_TRUE(test::eventually([&] { return is_over.load() || client.status()->questions_answered > 0; }));
  ASSERT_FALSE(is_over.load()) << "the batch was over at once";
  expect_ends_in_order(server);
  asking.join();
  EXPECT_NE(why.find("stopping"), std::string::npos) << why;
}

/// A sphere's surface about the origin, of 4 * rows^2 triangles.
MeshShape shell_mesh(int rows, double radius_m) {
  MeshShape mesh;
  const int columns = 2 * rows;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double polar = std::numbers::pi * row / rows;
      const double turn = 2 * std::numbers::pi * column / columns;
      mesh.vertices.push_back(
          radius_m * Vec3(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)));
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const auto a = static_cast<std::uint32_t>(row * columns + column);
      const auto b = static_cast<std::uint32_t>(row * columns + (column + 1) % columns);
      const auto down = static_cast<std::uint32_t>(columns);
      mesh.triangles.push_back({a, b, a + down});
      mesh.triangles.push_back({b, b + down, a + down});
    }
  }
  return mesh;
}

/// Two shells half a millimetre apart. To say how far takes some seconds, whoever is asked.
class ServerAmidOneQuestion : public ServerStopping {
 protected:
  static constexpr double kMiddle_m = 50;
  void load_shells(Client& client) {
    ASSERT_TRUE(client.load(folder_.write("outer.obj", testing_support::shell_obj(400)), {.name = "outer"}));
    const auto added =
        client.add({.name = "inner", .shape = {shell_mesh(85, 0.9995)}, .pose = at(kMiddle_m, kMiddle_m, kMiddle_m)});
    ASSERT_TRUE(added) << added.error().message;
  }
  /// Whether the server is at work on what was asked, before that is answered.
  bool is_at_work(const testing_support::ChildProcess& server, double before_s) {
    constexpr double kAtWork_s = 0.3;
    return test::eventually([&] { return testing_support::processor_s(server.pid()) > before_s + kAtWork_s; }, 60s);
  }
  static Result<PairAnswer> ask_pair(Client& client) { return client.pair("inner", "outer", {.timeout = 60s}); }
  static Result<WhatIfAnswers> ask_what_if(Client& client, std::chrono::nanoseconds timeout) {
    return client.what_if({.objects = {"inner"}, .poses = {at(kMiddle_m, kMiddle_m, kMiddle_m)}},
                          {.against = "outer", .with_clearance = true, .timeout = timeout});
  }
  /// Stops the server amid what is asked, and expects that it ends in order and has refused it.
  template <class Ask>
  void expect_ends_amid(const Ask& ask) {
    testing_support::ChildProcess& server = start({"--threads", "1"});
    Client client = connect();
    load_shells(client);
    const double before_s = testing_support::processor_s(server.pid());
    std::atomic<bool> is_over{false};
    std::string why;
    std::thread asking([&] {
      const auto answer = ask(client);
      if (!answer) why = answer.error().message;
      is_over.store(true);
    });
    EXPECT_TRUE(is_at_work(server, before_s));
    EXPECT_FALSE(is_over.load()) << "it was answered at once";
    expect_ends_in_order(server);
    asking.join();
    EXPECT_NE(why.find("stopping"), std::string::npos) << why;
  }
};

TEST_F(ServerAmidOneQuestion, EndsAmidAPair) { expect_ends_amid(ask_pair); }

// What it had begun for a client that is gone takes no more time from others.
TEST_F(ServerAmidOneQuestion, EndsTheQuestionOfWhoHasGone) {
  testing_support::ChildProcess& server = start({"--threads", "1"});
  Client staying = connect();
  load_shells(staying);
  const auto worked_s = [&server] { return testing_support::processor_s(server.pid()); };
  const double first_s = worked_s();
  ASSERT_TRUE(ask_what_if(staying, 60s));
  const double begun_s = worked_s();
  {
    Client going = connect();
    const Result<WhatIfAnswers> answer = ask_what_if(going, 200ms);
    ASSERT_FALSE(answer) << "it was answered at once";
    EXPECT_EQ(answer.error().code, ErrorCode::timeout) << answer.error().message;
  }
  double now_s = worked_s();
  const auto is_at_rest = [&] {
    const double before_s = std::exchange(now_s, worked_s());
    return now_s < before_s + 0.1;
  };
  do { std::this_thread::sleep_for(1s); } while (!is_at_rest());
  std::printf("the whole question took the server %.2f s, for a client that went %.2f s\n", begun_s - first_s,
              now_s - begun_s);
  EXPECT_LT(now_s - begun_s, (begun_s - first_s) / 2);
}

#ifdef COLLIDED_SLOW_DISK
// The stop waits for the disk, on which an object that was added last is being written: commands of every kind that come in
// the meantime are refused, and the one that was first is done.
TEST_F(ServerStopping, CommandsThatComeTooLateAreRefusedAndNotForgotten) {
  testing_support::ChildProcess server(
      {"/usr/bin/env", "LD_PRELOAD=" COLLIDED_SLOW_DISK, "COLLIDED_FSYNC_MS=700", COLLIDED_SERVER, "--domain",
       std::to_string(domain_), "--state-dir", folder_.path()},
      folder_.path(), "slow");
  ASSERT_TRUE(server.says("ready:", 20s)) << server.errors();
  Client first = connect();
  Client second = connect();
  std::atomic<bool> is_added{false};
  std::thread adding([&] {
    const json crate{{"name", "crate"}, {"pose", {6, 0, 5, 1, 0, 0, 0}}};
    const Result<std::string> answer = first.command("add", crate.dump(), {BoxShape{.half_m = {0.2, 0.2, 0.2}}}, 10s);
    is_added.store(answer && !json::parse(*answer).contains("not_kept"));
  });
  // It is in the world before it is on the disk.
  const RayQuestion down{.origin = {6, 0, 9}, .direction = {0, 0, -1}};
  const auto until = std::chrono::steady_clock::now() + 10s;
  const auto is_there = [&] {
    const Result<Answer> answer = second.ask(down);
    return answer && !answer->hits.empty() && answer->hits[0].object == "crate";
  };
  while (!is_there() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(1ms);
  server.signal(SIGTERM);
  const std::vector<std::pair<std::string, json>> commands{
      {"add", {{"name", "late"}, {"pose", {9, 0, 5, 1, 0, 0, 0}}}},
      {"move", {{"name", "crate"}, {"pose", {6, 0, 6, 1, 0, 0, 0}}}},
      {"pair", {{"a", "crate"}, {"b", "warehouse/floor"}}},
      {"menu", json::object()},
      {"load", {{"path", "/nowhere/x.obj"}}},
      {"list", json::object()}};
  // Until the first refusal the signal may still be on its way.
  bool is_stopping = false;
  for (int i = 0; i < 400 && !is_stopping; ++i) {
    const Result<std::string> answer = second.command("list", "{}", {}, 1s);
    is_stopping = !answer && answer.error().message.find("stopping") != std::string::npos;
  }
  ASSERT_TRUE(is_stopping);
  for (const auto& [name, arguments] : commands) {
    const Shape shape = name == "add" ? Shape{SphereShape{.radius_m = 0.1}} : Shape{};
    const Result<std::string> answer = second.command(name, arguments.dump(), shape, 1s);
    ASSERT_FALSE(answer) << name;
    EXPECT_EQ(answer.error().code, ErrorCode::refused) << name << ": " << answer.error().message;
    EXPECT_NE(answer.error().message.find("the server is stopping"), std::string::npos)
        << name << ": " << answer.error().message;
  }
  adding.join();
  EXPECT_TRUE(is_added.load()) << "what was taken before is done, and kept";
  EXPECT_EQ(server.wait(10s), 0) << server.errors();
}
#endif

}  // namespace
}  // namespace collided
