#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <regex>
#include <thread>

#include "collided/client.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/long_step.hpp"
#include "tests/view/loud_client.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using test::LoudClient;

constexpr auto kPatience = 60s;  // a busy machine is no fault of the viewer

/// A server, things that move, and `collide view`, each a process.
class Viewing : public testing::Test {
 protected:
  void start(const std::vector<std::string>& options = {}, const std::vector<std::string>& server_options = {}) {
    std::vector<std::string> server_words{COLLIDED_SERVER, "--domain",       domain, "--state-dir",
                                          folder.path(),   "--step-threads", "1"};
    server_words.insert(server_words.end(), server_options.begin(), server_options.end());
    server.emplace(server_words, folder.path(), "server");
    ASSERT_TRUE(server->says("ready:", kPatience)) << server->errors();
    publisher.emplace(std::vector<std::string>{COLLIDED_CLI, "publish", "--spheres", "200", "--side", "6", "--size",
                                               "0.03", "--round", "--bounce", "--domain", domain},
                      folder.path(), "publisher");
    std::vector<std::string> words{COLLIDED_CLI, "view", "--port", "0", "--plain", "--domain", domain};
    words.insert(words.end(), options.begin(), options.end());
    viewer.emplace(words, folder.path(), "viewer");
    ASSERT_TRUE(viewer->says("ws://", kPatience)) << viewer->errors();
    const std::string said = viewer->output();
    const std::size_t colon = said.find(':', said.find("ws://") + 5);
    port = static_cast<std::uint16_t>(std::stoul(said.substr(colon + 1)));
    host = "127.0.0.1:" + std::to_string(port);
  }
  LoudClient open(const std::string& target, const std::string& headers = {}) const {
    LoudClient client(port);
    EXPECT_TRUE(client.send(LoudClient::upgrade(target, host, headers)));
    return client;
  }
  /// The answer to GET once it holds the text; what came last where it never does.
  std::string eventually_fetched(const std::string& target, const std::string& text) const {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    for (;;) {
      const LoudClient client(port);
      client.send(LoudClient::get(target, host, "Connection: close\r\n"));
      std::string answer = client.read_until(text, 2s);
      const bool is_over = std::chrono::steady_clock::now() > until;
      if (is_over || answer.find(text) != std::string::npos) return answer;
      std::this_thread::sleep_for(20ms);
    }
  }
  static double resident_mib(int pid) {
    std::ifstream status("/proc/" + std::to_string(pid) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024;
    }
    return 0;
  }

  testing_support::ScratchFolder folder;
  const std::string domain = std::to_string(testing_support::own_domain());
  std::optional<testing_support::ChildProcess> server, publisher, viewer;
  std::uint16_t port = 0;
  std::string host;
};

TEST_F(Viewing, APageHearsOfEverything) {
  start();
  const LoudClient page = open("/live");
  const std::string heard = page.read_until("\"type\":\"status\"");
  EXPECT_LT(heard.find("\"type\":\"hello\""), heard.find("\"type\":\"contacts\""));
  EXPECT_NE(page.read_until("\"what\":\"began\"", kPatience).find("\"what\":\"began\""), std::string::npos)
      << "200 spheres in a cube meet";
  EXPECT_NE(eventually_fetched("/objects", "\"warehouse/floor\"").find("200 OK"), std::string::npos);
  page.send(LoudClient::frame(R"({"ask":"ray","id":17,"origin":[0,0,5],"direction":[0,0,-1]})"));
  EXPECT_NE(page.read_until("\"type\":\"answer\"").find("\"id\":17"), std::string::npos);
  page.send(LoudClient::frame(R"({"ask":"pair","id":18,"a":"warehouse/floor","b":"nobody"})"));
  EXPECT_NE(page.read_until("nobody").find("\"type\":\"refused\""), std::string::npos);
  page.send(LoudClient::frame(R"({"ask":"sphere","id":19,"center":[0,0,0],"radius":0.5})"));
  EXPECT_NE(page.read_until("\"id\":19").find("\"hits\":["), std::string::npos);
  // The server has 50 ms for it; on a busy machine that may be too short, and the page asks again.
  std::string nearest;
  for (int i = 0; i < 200 && nearest.find("\"other\":\"") == std::string::npos; ++i) {
    page.send(LoudClient::frame(R"({"ask":"nearest","id":20,"name":"warehouse/wall_north"})"));
    nearest = page.read_until("\"tested\":");
    ASSERT_NE(nearest.find(R"("ask":"nearest")"), std::string::npos) << nearest;
  }
  EXPECT_NE(nearest.find("\"other\":\""), std::string::npos) << nearest;
  page.send(LoudClient::frame(R"({"ask":"sweep","id":21,"radius":0.1,"from":[0,0,1],"to":[0,0,-1]})"));
  EXPECT_NE(page.read_until("\"id\":21").find("\"time_high\":"), std::string::npos);
  page.send(LoudClient::frame("drop table"));
  EXPECT_NE(page.read_until("no question").find("no question"), std::string::npos);
}

// While a step lasted for seconds, a page wrote that no server answers.
TEST_F(Viewing, APageIsToldThatTheServerIsBusyAndNeverThatItIsSilent) {
  ASSERT_NO_FATAL_FAILURE(start());
  Result<Client> client = Client::connect({.domain = testing_support::own_domain(), .wait = kPatience});
  ASSERT_TRUE(client) << client.error().message;
  testing_support::LongStep crowd(*client);
  const LoudClient page = open("/live");
  page.read_until("\"type\":\"status\"", kPatience);
  const std::regex lasting(R"("step_lasting":(0\.[5-9]|[1-9]))");
  std::string told;
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!std::regex_search(told, lasting) && std::chrono::steady_clock::now() < until) {
    crowd.begin();  // a page hears a status once a second, and a fast machine may be done by then
    told += page.read_until("\"type\":\"status\"", 2s) + page.read_until("}", 1s);
  }
  EXPECT_TRUE(std::regex_search(told, lasting)) << "no status reports a step that lasts";
  EXPECT_EQ(told.find("\"type\":\"silent\""), std::string::npos);
}

// The content of the flight recorder is fetched by its number, as a run, for as long as nothing newer was asked for.
TEST_F(Viewing, ThePageGetsWhatTheServerRemembers) {
  ASSERT_NO_FATAL_FAILURE(start());
  const LoudClient page = open("/live");
  page.read_until("\"what\":\"began\"", kPatience);
  for (const char* number : {"1", "2"}) {
    page.send(LoudClient::frame(R"({"ask":"memory","id":7,"seconds":30})"));
    const std::string path = std::string("memory?number=") + number;
    ASSERT_NE(page.read_until(path, kPatience).find(path), std::string::npos);
    const std::string poses = R"("kind":"poses")";
    EXPECT_NE(eventually_fetched("/" + path, poses).find(poses), std::string::npos);
  }
  const LoudClient late(port);
  late.send(LoudClient::get("/memory?number=1", host));
  EXPECT_NE(late.read_until("\r\n\r\n").find("404"), std::string::npos);
}

TEST_F(Viewing, PrometheusReadsTheSameFigures) {
  ASSERT_NO_FATAL_FAILURE(start());
  const std::string moving = "\ncollided_moving_objects 200\n";  // all that the publisher adds, one by one
  EXPECT_NE(eventually_fetched("/metrics", moving).find(moving), std::string::npos);
  const std::string up = eventually_fetched("/metrics", "collided_stage_seconds_total{stage=\"publish\"}");
  EXPECT_NE(up.find("text/plain; version=0.0.4"), std::string::npos);
  EXPECT_NE(up.find("\ncollided_up 1\n"), std::string::npos) << up;
  server.reset();
  const std::string down = eventually_fetched("/metrics", "\ncollided_up 0\n");
  EXPECT_NE(down.find("\ncollided_up 0\n"), std::string::npos) << down;
  EXPECT_EQ(down.find("collided_objects"), std::string::npos) << "what a silent server said before is not told as now";
}

TEST_F(Viewing, FoxgloveSeesTheSameWorld) {
  start();
  const LoudClient foxglove = open("/", "Sec-WebSocket-Protocol: foxglove.websocket.v1, foxglove.sdk.v1\r\n");
  const std::string greeting = foxglove.read_until("FrameTransforms");
  EXPECT_NE(greeting.find("Sec-WebSocket-Protocol: foxglove.sdk.v1"), std::string::npos);
  EXPECT_NE(greeting.find("serverInfo"), std::string::npos);
  foxglove.send(
      LoudClient::frame(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2}]})"));
  const std::string heard = foxglove.read_until("child_frame_id", kPatience);
  EXPECT_NE(heard.find("\"transforms\""), std::string::npos);
  EXPECT_NE(open("/", "Sec-WebSocket-Protocol: mqtt\r\n").read_until("\r\n\r\n").find("404"), std::string::npos);
}

// Slow readers, a thousand connections, noise: the viewer keeps its size and the server answers as before.
TEST_F(Viewing, HostileClientsGrowNothingAndTheServerDoesNotNotice) {
  // The recorder would remember more the longer this takes.
  start({}, {"--flight-recorder", "off"});
  Result<Client> client = Client::connect({.domain = testing_support::own_domain(), .wait = kPatience});
  ASSERT_TRUE(client) << client.error().message;
  const LoudClient page = open("/live");
  page.read_until("\"type\":\"status\"");
  std::atomic<bool> over{false};
  std::atomic<std::uint64_t> asked{0};
  std::atomic<std::uint64_t> failed{0};
  std::thread asking([&] {
    while (!over) {
      ++asked;
      if (!client->ask(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}})) ++failed;
      std::this_thread::sleep_for(2ms);
    }
  });
  const double viewer_before = resident_mib(viewer->pid());
  const double server_before = resident_mib(server->pid());
  {
    std::vector<LoudClient> crowd;
    for (int i = 0; i < 1'000; ++i) {
      crowd.emplace_back(port);
      // Some read nothing of what they asked for, some say things that are none.
      if (i % 5 == 0) crowd.back().send(LoudClient::upgrade("/live", host));
      if (i % 5 == 1) crowd.back().send(LoudClient::get("/objects", host));
      if (i % 5 == 2)
        crowd.back().send(LoudClient::upgrade("/live", host) + LoudClient::frame("{\"ask\":\"ray\"}") +
                          std::string(1'000, '\xff'));
      if (i % 5 == 3) crowd.back().send(std::string(20'000, 'G'));
    }
    std::this_thread::sleep_for(3s);  // of frames that nobody in the crowd reads
    EXPECT_LT(resident_mib(viewer->pid()) - viewer_before, 128);
    EXPECT_NE(page.read_until("\"type\":\"status\"").find("\"type\":\"status\""), std::string::npos)
        << "who was there is served";
  }
  over = true;
  asking.join();
  std::printf("viewer: %.0f MiB before, %.0f after; server: %.0f before, %.0f after; %llu rays asked meanwhile\n",
              viewer_before, resident_mib(viewer->pid()), server_before, resident_mib(server->pid()),
              static_cast<unsigned long long>(asked));
  EXPECT_GT(asked, 100U);
  EXPECT_EQ(failed, 0U);
  EXPECT_LT(resident_mib(server->pid()) - server_before, 32);
  const Result<ServerStatus> status = client->status();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, "ready");
  EXPECT_EQ(status->questions_refused, 0U);
  for (const PublisherInfo& one : status->publishers) EXPECT_FALSE(one.lost) << one.name;
  const LoudClient next(port);
  next.send(LoudClient::get("/", host));
  EXPECT_NE(next.read_until("</html>").find("200 OK"), std::string::npos) << "the next one is let in";
}

TEST_F(Viewing, ARunIsSavedIntoOneFile) {
  start({"--for", "1s"});
  EXPECT_EQ(viewer->wait(kPatience), 0) << viewer->errors();
  const std::string file = folder.path() + "/run.html";
  testing_support::ChildProcess saving(
      {COLLIDED_CLI, "view", "--save", file, "--last", "1500ms", "--plain", "--domain", domain}, folder.path(),
      "saving");
  EXPECT_EQ(saving.wait(kPatience), 0) << saving.errors();
  std::ifstream in(file, std::ios::binary);
  const std::string page((std::istreambuf_iterator<char>(in)), {});
  EXPECT_NE(page.find("id=\"run\">{"), std::string::npos);
  EXPECT_NE(page.find("\"kind\":\"poses\""), std::string::npos);
  EXPECT_NE(page.find("\"kind\":\"objects\""), std::string::npos);
  EXPECT_NE(page.find("\"surfaces\":{\""), std::string::npos) << "the warehouse has walls";
  EXPECT_EQ(page.find("src=\"view.js\""), std::string::npos) << "nothing is asked for from elsewhere";
  EXPECT_EQ(page.find("href=\"view.css\""), std::string::npos);
}

}  // namespace
}  // namespace collided
