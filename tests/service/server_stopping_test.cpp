// Whoever asks a server that is stopping hears so.
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
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

// Beside a server that hangs, on a machine with more to do than it can, 2 s were a minute.
TEST_F(ServerStopping, AWaitThatIsALimitIsNotStretched) {
  testing_support::ChildProcess& server = start();
  server.signal(SIGSTOP);
  std::vector<std::jthread> crowd;
  for (unsigned i = 0; i < 4 * std::max(1U, std::thread::hardware_concurrency()); ++i)
    crowd.emplace_back([](const std::stop_token& stop) {
      while (!stop.stop_requested()) {}
    });
  const auto began = std::chrono::steady_clock::now();
  const Result<Client> client = Client::connect({.domain = domain_, .wait = 500ms, .wait_is_limit = true});
  EXPECT_LT(std::chrono::steady_clock::now() - began, 5s) << "30 times as long without";
  EXPECT_FALSE(client);
  crowd.clear();
  server.signal(SIGCONT);
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

/// Two shells half a millimetre apart. To say how far takes some seconds, whoever is asked.
class ServerAmidOneQuestion : public ServerStopping {
 protected:
  void load_shells(Client& client) {
    ASSERT_TRUE(client.load(folder_.write("outer.obj", testing_support::shell_obj(600)), {.name = "outer"}));
    ASSERT_TRUE(client.load(folder_.write("inner.obj", testing_support::shell_obj(450, 0.9995)), {.name = "inner"}));
  }
};

// It ends in order, and refuses what it was amid.
TEST_F(ServerAmidOneQuestion, EndsAmidAPair) {
  testing_support::ChildProcess& server = start({"--threads", "1"});
  Client client = connect();
  load_shells(client);
  const auto worked_s = [&server] { return testing_support::processor_s(server.pid()); };
  const auto ask = [&client] { return client.pair("inner", "outer", {.timeout = 60s}); };
  const double first_s = worked_s();
  ASSERT_TRUE(ask());
  const double before_s = worked_s();
  const double whole_s = before_s - first_s;
  std::printf("the whole question takes %.2f s of a processor\n", whole_s);
  std::atomic<bool> is_over{false};
  std::string why;
  std::thread asking([&] {
    const auto answer = ask();
    if (!answer) why = answer.error().message;
    is_over.store(true);
  });
  EXPECT_TRUE(test::eventually([&] { return worked_s() > before_s + whole_s / 5; }, 60s));
  EXPECT_FALSE(is_over.load()) << "it was answered at once";
  expect_ends_in_order(server);
  asking.join();
  EXPECT_NE(why.find("stopping"), std::string::npos) << why;
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
